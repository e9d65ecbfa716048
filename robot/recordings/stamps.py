"""The time of every row: which column, which unit, rising."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from slidetune.robot.recordings.matching import TIME, column_named
from slidetune.robot.recordings.refused import RecordingError, listed, quoted
from slidetune.robot.recordings.units import UNITS, factor_of, split_unit

Array = np.ndarray

_NAMES = ("time", "t", "timestamp", "__time", "stamp", "seconds", "sec", "secs", "elapsed")
"""Headers of a column of time, the surest first."""
_PARTS = ("header.stamp.sec", "header.stamp.nanosec"), ("sec", "nanosec"), ("secs", "nsecs")
_EPOCHS = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3), (1e8, 1.0))
"""Least stamp since 1970 in ns, us, ms and s, and the factor to s: those of 1973 and later."""
SLOWEST = 0.5
"""Longest step in [s] that is believed of a time without a unit (*ours*): slower looks like ms."""
_UNEVEN = 0.2
"""Share by which steps may differ and still count as even (*ours*)."""
GAP = 10.0
"""So many times the usual step is a gap (*ours*)."""


@dataclass(frozen=True)
class Clock:
    """The column, or the two columns, of time.

    Attributes:
        columns: numbers of the columns: one, or whole seconds and nanoseconds.
        factor: what makes seconds of the first, or ``None`` where its header has no unit.
        name: its header.
    """

    columns: tuple[int, ...]
    factor: float | None
    name: str


def clock_of(names: Sequence[str], mapping: Mapping[str, str], unit: str = "") -> Clock:
    """Find the column of time.

    Args:
        names: headers of the file.
        mapping: may name it under ``time``.
        unit: unit of a time whose header has none: s, ms, us or ns.

    Raises:
        RecordingError: if there is none or its unit is unknown.
    """
    if unit and factor_of(unit, "time") is None:
        raise RecordingError(f"time may be in s, ms, us or ns, got {quoted(unit)}")
    given = next((header for key, header in mapping.items() if key.lower() == TIME), None)
    if given is not None:
        return _clock(column_named(given, names), names, unit)
    plain = [name.strip().lower().split("/")[-1] for name in names]
    for first, second in _PARTS:
        if first in plain and second in plain:
            return Clock((plain.index(first), plain.index(second)), 1.0, first)
    bare = [split_unit(name).name for name in plain]
    for wanted in _NAMES:
        found = [column for column, name in enumerate(bare) if name == wanted]
        if found:
            return _clock(found[0], names, unit)
    raise RecordingError(
        f"no column is called time: there are {listed(list(names))}. Call it time [s], or map it: "
        "time=COLUMN",
        names=tuple(names),
    )


def _clock(column: int, names: Sequence[str], unit: str) -> Clock:
    written = split_unit(names[column]).unit or unit
    factor = factor_of(written, "time") if written else None
    if written and factor is None:
        raise RecordingError(
            f"its unit {quoted(written)} is none of time: {', '.join(UNITS['time'])}",
            column=names[column],
        )
    return Clock((column,), factor, names[column])


def seconds_of(clock: Clock, values: Array, rows: Array) -> tuple[Array, float, list[str]]:
    """Return the time of every row.

    Args:
        clock: where it stands.
        values: what stands there. Shape (n, 1 or 2).
        rows: number of each row in the file. Shape (n,).

    Returns:
        Time in [s] from the first row on, shape (n,); the first row's own time in [s]; remarks.

    Raises:
        RecordingError: if it falls, stands still, or has no unit and may be anything.
    """
    remarks: list[str] = []
    stamps = values[:, 0]
    parted = len(clock.columns) == 2
    _check_rising(stamps - stamps[0] + 1e-9 * values[:, 1] if parted else stamps, clock, rows)
    factor = clock.factor
    if factor is None:
        factor = _guessed(stamps, clock, rows)
        if factor != 1.0:
            unit = {1e-9: "ns", 1e-6: "us", 1e-3: "ms"}[factor]
            remarks.append(f"the time without a unit is taken as {unit} since 1970")
    # From the first row on: a stamp of today in seconds has 0.2 us left in a float.
    time = (stamps - stamps[0]) * factor
    if parted:
        time = time + 1e-9 * (values[:, 1] - values[0, 1])
    steps = np.diff(time)
    if not (steps > 0.0).all():
        _check_rising(time, clock, rows)
    remarks += _unevenness(time, steps, rows)
    return time, float(stamps[0] * factor), remarks


def _check_rising(stamps: Array, clock: Clock, rows: Array) -> None:
    wrong = np.flatnonzero(~(np.diff(stamps) > 0.0))
    if len(wrong):
        at = int(wrong[0])
        before, after = stamps[at], stamps[at + 1]
        what = "stands still" if before == after else "falls"
        raise RecordingError(
            f"time {what}: {after:.17g} after {before:.17g} in row {rows[at]}, "
            f"{len(wrong)} times in all. Take out the rows that are there twice, or cut the "
            "recording where it begins anew",
            row=int(rows[at + 1]),
            column=clock.name,
            value=f"{after:.17g}",
        )


def _guessed(stamps: Array, clock: Clock, rows: Array) -> float:
    for least, factor in _EPOCHS:
        if stamps[0] >= least:
            return factor
    usual = float(np.median(np.diff(stamps)))
    if usual > SLOWEST:
        raise RecordingError(
            f"its header has no unit, and its steps of {usual:g} may be s or ms: write "
            "time [s] or time [ms], or say the unit of time",
            row=int(rows[1]),
            column=clock.name,
            value=f"{stamps[1]:g}",
        )
    return 1.0


def _unevenness(time: Array, steps: Array, rows: Array) -> list[str]:
    usual, longest = float(np.median(steps)), float(steps.max())
    if longest > GAP * usual:
        at = int(np.argmax(steps))
        return [
            f"a gap of {longest:.3g} s before row {rows[at + 1]} ({time[at]:.3g} s), where steps "
            f"are {usual:.3g} s"
        ]
    if max(longest - usual, usual - float(steps.min())) > _UNEVEN * usual:
        return [
            f"rows are uneven: {1e3 * steps.min():.3g} to {1e3 * longest:.3g} ms apart, usually "
            f"{1e3 * usual:.3g} ms"
        ]
    return []
