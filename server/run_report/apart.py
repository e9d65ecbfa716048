"""A recording made in a process of its own: Viser's part of it is slow, and all in Python."""

from __future__ import annotations

from base64 import b64decode

from slidetune.robot.errors import SlidetuneError
from slidetune.server.compute.apart import LostProcessError, ask_apart
from slidetune.server.run_report.child import asked_of
from slidetune.server.run_report.recording import Film

_MODULE = "slidetune.server.run_report.child"
_LIMIT = 120.0
"""Longest time that one may take in [s] (*ours*): most of the usual three are imports."""


class RecordingError(SlidetuneError, RuntimeError):
    """No recording could be made."""


def record_apart(film: Film) -> bytes:
    """Return what ``record`` returns, without keeping other threads of this process waiting.

    Args:
        film: what to record.

    Raises:
        RecordingError: if the process ended without a recording, or took too long.
    """
    try:
        answer: str = ask_apart(_MODULE, asked_of(film), _LIMIT)
    except LostProcessError as error:
        raise RecordingError(f"what records the replay {error.text}") from error
    return b64decode(answer)
