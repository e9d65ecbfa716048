"""Logs that the owner has brought: kept as long as the server runs, in a folder of their own."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from slidetune.robot.errors import FieldError, InvalidExperimentError, SlidetuneError
from slidetune.server.compute.workers import BusyError
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.limits import MAX_LOGS, TooManyLogsError

MOST_SHOWN = 2
"""Most logs beside the lanes (*ours*): more can't be told apart."""
_AT_ONCE = 2
"""Most processes that read or fit at once (*ours*)."""


class UnknownLogError(SlidetuneError, KeyError):
    """No log has that number."""

    def __str__(self) -> str:
        """Return the text itself (KeyError would quote it)."""
        return str(self.args[0])


@dataclass(frozen=True)
class Log:
    """One log.

    Attributes:
        number: by which it is asked for.
        name: of the file.
        arm: the arm whose joints its columns are.
        rows: how many it has.
        duration: from the first row to the last in [s].
        rate: rows a second in [Hz].
        holds: what it has columns of.
        remarks: what was assumed, in words.
        shown: whether it is shown beside the lanes.
        shift: what is added to its time in [s]; ``None``: found by cross-correlation.
    """

    number: int
    name: str
    arm: str
    rows: int
    duration: float
    rate: float
    holds: tuple[str, ...]
    remarks: tuple[str, ...]
    shown: bool = False
    shift: float | None = None


class LogStore:
    """All logs. The event loop alone changes it; reading and fitting happen in other threads.

    Attributes:
        changes: counts what viewers have not seen yet: another number says that there is news.
    """

    def __init__(self) -> None:
        """Begin with none."""
        self.changes = 0
        self._logs: dict[int, Log] = {}
        self._curves: dict[int, bytes] = {}
        self._last = 0
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self.working = ConcurrencyLimit(
            _AT_ONCE,
            lambda: BusyError(f"{_AT_ONCE} logs are being read or fitted: try again in a moment"),
        )

    def close(self) -> None:
        """Forget all of them."""
        if self._folder is not None:
            self._folder.cleanup()
        self._folder = None

    def documents(self) -> list[dict[str, Any]]:
        """Return all of them as plain values, the oldest first."""
        return [asdict(log) for log in self._logs.values()]

    def get(self, number: int) -> Log:
        """Return a log.

        Raises:
            UnknownLogError: if there is none of that number.
        """
        if number not in self._logs:
            known = ", ".join(map(str, self._logs)) or "none"
            raise UnknownLogError(f"no log has the number {number}; there are: {known}")
        return self._logs[number]

    def of_arm(self, number: int, arm: str) -> Log:
        """Return a log of an arm.

        Raises:
            UnknownLogError: if there is none of that number.
            InvalidExperimentError: if it is of another arm.
        """
        log = self.get(number)
        if log.arm != arm:
            text = f"is a log of the arm {log.arm}, and the live experiment is about {arm}"
            raise InvalidExperimentError([FieldError("number", text, number)])
        return log

    def refuse_if_full(self) -> None:
        """Refuse one log more than there may be, before it is read.

        Raises:
            TooManyLogsError: if there are as many as may be.
        """
        if len(self._logs) >= MAX_LOGS:
            raise TooManyLogsError(f"at most {MAX_LOGS} logs are kept: remove one first")

    def next_number(self) -> int:
        """Return a number that no log has had."""
        self._last += 1
        return self._last

    def add(self, number: int, arm: str, summary: Mapping[str, Any]) -> Log:
        """Keep what was read.

        Raises:
            TooManyLogsError: if there are as many as may be; what was read is dropped.
        """
        try:
            self.refuse_if_full()
        except TooManyLogsError:
            self.archive(number).unlink(missing_ok=True)
            raise
        parts = {"holds": tuple(summary["holds"]), "remarks": tuple(summary["remarks"])}
        log = Log(number=number, arm=arm, **{**summary, **parts})
        self._logs[number] = log
        self.changes += 1
        return log

    def change(self, number: int, **changes: Any) -> Log:
        """Show a log, hide it, or shift it.

        Raises:
            UnknownLogError: if there is none of that number.
            InvalidExperimentError: if as many are shown as may be.
        """
        log = replace(self.get(number), **changes)
        others = [one for one in self._logs.values() if one.shown and one.arm == log.arm]
        if log.shown and len([one for one in others if one.number != number]) >= MOST_SHOWN:
            names = " and ".join(one.name for one in others)
            text = f"at most {MOST_SHOWN} logs are shown beside the lanes: hide {names} first"
            raise InvalidExperimentError([FieldError("shown", text, True)])
        if log != self._logs[number]:
            self._logs[number] = log
            self.changes += 1
        return log

    def remove(self, number: int) -> None:
        """Forget a log.

        Raises:
            UnknownLogError: if there is none of that number.
        """
        self.get(number)
        del self._logs[number]
        self._curves.pop(number, None)
        self.archive(number).unlink(missing_ok=True)
        self.changes += 1

    def curves(self, number: int) -> bytes | None:
        """Return the curves that the owner last asked for.

        Raises:
            UnknownLogError: if there is no log of that number.
        """
        self.get(number)
        return self._curves.get(number)

    def keep_curves(self, number: int, message: bytes) -> None:
        """Keep curves for those who watch, unless the log is gone meanwhile."""
        if number in self._logs:
            self._curves[number] = message
            self.changes += 1

    def archive(self, number: int) -> Path:
        """Return where the numbers of a log stand."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="slidetune-logs-")
        return Path(self._folder.name) / f"{number}.npz"
