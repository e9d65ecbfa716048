"""Work that a process of its own does once: whatever becomes of it, the server goes on."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any

GIVES_WAY = 10
"""By so much such a process is nicer than the server (*ours*)."""
_LINES = 10
"""Most lines that are told of what a lost process said last (*ours*)."""


class LostProcessError(Exception):
    """A process that ended, or was ended, without an answer.

    Attributes:
        text: what became of it, to stand after what it did.
        lines: what it said last.
    """

    def __init__(self, text: str, lines: str = "") -> None:
        """Keep both."""
        super().__init__(text)
        self.text, self.lines = text, lines


def ask_apart(module: str, asked: object, limit: float) -> Any:
    """Ask a module that answers once, in a process of its own; see ``answer_once``.

    Args:
        module: its whole name.
        asked: the question, as plain JSON values.
        limit: time after which the process is ended in [s].

    Returns:
        The answer, as plain JSON values.

    Raises:
        LostProcessError: if there is none.
    """
    paths = os.pathsep.join(path for path in sys.path if path)
    with subprocess.Popen(
        [sys.executable, "-m", module],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": paths},
        start_new_session=True,  # an interrupt of the server's terminal is not meant for it
    ) as process:
        try:
            answer, said = process.communicate(json.dumps(asked).encode(), limit)
        except BaseException as error:
            process.kill()
            if not isinstance(error, subprocess.TimeoutExpired):
                raise
            raise LostProcessError(
                f"did not come back within {limit:g} s, and was ended"
            ) from error
    try:
        return json.loads(answer)
    except ValueError as error:
        lines = said.decode(errors="replace").strip().splitlines()[-_LINES:]
        raise LostProcessError(_end_of(process.returncode), "\n".join(lines)) from error


def answer_once(answer: Callable[[Any], object]) -> None:
    """Answer the one question that a process is asked: JSON in, JSON out.

    It gives way to the live session all the while.
    """
    with suppress(OSError):
        os.nice(GIVES_WAY)
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what is printed meanwhile is no answer
    answers.write(json.dumps(answer(json.load(sys.stdin))))
    answers.flush()


def _end_of(code: int) -> str:
    if code >= 0:
        return f"ended the process with exit status {code}"
    try:
        return f"ended the process by {signal.Signals(-code).name}"
    except ValueError:
        return f"ended the process by signal {-code}"
