"""Nothing is paced by the clock on the wall, which people and networks set forward and back."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WALL_CLOCK = re.compile(
    r"\btime\.(time|time_ns|localtime|gmtime|ctime)\(|\bdatetime\b"
    r"|^from time import .*\b(time|time_ns|localtime|gmtime)\b",
    re.MULTILINE,
)
TELLS_THE_TIME = {"server/state/edit_history.py", "server/studies/store.py"}
"""What says when something was done, to be read by people; nothing waits for it."""


def test_only_what_people_read_takes_the_time_of_day() -> None:
    users = {
        path.relative_to(ROOT).as_posix()
        for package in ("robot", "server")
        for path in (ROOT / package).rglob("*.py")
        if WALL_CLOCK.search(path.read_text(encoding="utf-8"))
    }
    assert users == TELLS_THE_TIME
