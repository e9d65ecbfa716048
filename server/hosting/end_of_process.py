"""The end that an init system or a container asks for."""

from __future__ import annotations

import signal
import sys
from types import FrameType


def end_on_sigterm() -> None:
    """Make SIGTERM end the process with 0, from now on and after the server has shut down.

    The kernel keeps a signal without a handler from a container's first process: it would go on
    until it is killed. Elsewhere its end would count as a failure.
    """
    signal.signal(signal.SIGTERM, _end)


def _end(number: int, frame: FrameType | None) -> None:
    sys.exit(0)
