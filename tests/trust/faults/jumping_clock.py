"""The server with a clock on the wall that jumps: by as much as a file says, in seconds.

Run it like the server: ``python -m tests.trust.faults.jumping_clock serve``. The real clock of a
machine isn't ours to turn, so every way in which Python tells the time of day is turned in this
process.
"""

from __future__ import annotations

import os
import time
from pathlib import Path

VARIABLE = "SLIDETUNE_TEST_CLOCK"
"""Environment variable that names the file."""
DAY = 86400.0


def _jump() -> float:
    try:
        return float(Path(os.environ[VARIABLE]).read_text() or 0.0)
    except (OSError, ValueError):
        return 0.0


def turn_clock() -> None:
    """Let the time of day jump; must come before anything else takes hold of it."""
    seconds, nanoseconds = time.time, time.time_ns
    time.time = lambda: seconds() + _jump()
    time.time_ns = lambda: nanoseconds() + int(_jump() * 1e9)


if __name__ == "__main__":
    turn_clock()
    from slidetune.server.cli import main

    main()
