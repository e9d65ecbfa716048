"""A recording of an arm: what stands in a file, as angles, velocities and torques of its joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from slidetune.robot.arm.chain import turned_axis
from slidetune.robot.arm.known import KnownArm
from slidetune.robot.recordings.csv_file import CsvFile
from slidetune.robot.recordings.headers import ANGLE, CURRENT, TORQUE, VELOCITY
from slidetune.robot.recordings.limits import FEWEST_ROWS, MCAP_MAGIC, beginning_of
from slidetune.robot.recordings.matching import DESIRED, MEASURED, Layout, Slot, match
from slidetune.robot.recordings.mcap_file import McapFile
from slidetune.robot.recordings.refused import RecordingError
from slidetune.robot.recordings.stamps import clock_of, seconds_of
from slidetune.robot.recordings.turns import TURN, turns_said, whole_turns

Array = np.ndarray

_PLURAL = {ANGLE: "angles", VELOCITY: "velocities", TORQUE: "torques", CURRENT: "currents"}
_FASTEST_LOOKING = 4.0 * np.pi
"""Angle in [rad] beyond which values look like degrees (*ours*): two turns either way."""


@dataclass(frozen=True)
class Wanted:
    """How a file is to be read, where its headers don't say it.

    Attributes:
        mapping: column by what it holds: ``time``, ``joint``, ``joint.velocity``, ``joint.torque``,
            ``joint.current``, ``joint.desired``; a joint is its name or its number from 1.
        source: topic of an MCAP file, or what stands before the names of the columns that count.
        angles: unit of angles without one, ``deg`` or ``rad``; per s of velocities without one.
        time: unit of a time without one: s, ms, us or ns.
    """

    mapping: Mapping[str, str] = field(default_factory=dict)
    source: str | None = None
    angles: str = ""
    time: str = ""


@dataclass(frozen=True)
class Recording:
    """What a file says of an arm, in SI units.

    Attributes:
        name: of the file.
        time: time in [s] from the first row on, rising. Shape (m,).
        q: angles in [rad], or [m] where a joint slides. Shape (m, n).
        measured: whether ``q`` was measured; else it is what was asked for.
        v: velocities in [rad/s], or ``None``. Shape (m, n).
        tau: torques in [N m], or ``None``. Shape (m, n).
        current: currents in [A], or ``None``. Shape (m, n).
        q_d: angles asked for in [rad], of the turn of the measured ones, or ``None``. Shape (m, n).
        v_d: velocities asked for in [rad/s], or ``None``. Shape (m, n).
        remarks: what was assumed and what was left out, in words.
    """

    name: str
    time: Array
    q: Array
    measured: bool
    v: Array | None = None
    tau: Array | None = None
    current: Array | None = None
    q_d: Array | None = None
    v_d: Array | None = None
    remarks: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Time from the first row to the last in [s]."""
        return float(self.time[-1])

    @property
    def period(self) -> float:
        """Usual time between two rows in [s]."""
        return float(np.median(np.diff(self.time)))


def columns_of(path: Path, source: str | None = None) -> tuple[str, ...]:
    """Return the headers of a file, so that somebody may say what they mean.

    Raises:
        RecordingError: if it can't be read.
    """
    try:
        return _opened(path, source).names
    except RecordingError as error:
        raise error.within(path.name) from error


def read_recording(path: Path, arm: KnownArm, wanted: Wanted | None = None) -> Recording:
    """Read a recording of an arm from CSV or MCAP.

    Args:
        path: a file of at most 200 MB and a million rows.
        arm: whose joints the columns are.
        wanted: what its headers don't say.

    Raises:
        RecordingError: naming row, column, value and the way out.
    """
    try:
        return _read(path, arm, wanted or Wanted())
    except RecordingError as error:
        raise error.within(path.name) from error


def _opened(path: Path, source: str | None) -> CsvFile | McapFile:
    if beginning_of(path).startswith(MCAP_MAGIC):
        return McapFile(path, source)
    return CsvFile(path)


def _read(path: Path, arm: KnownArm, wanted: Wanted) -> Recording:
    file = _opened(path, wanted.source)
    joints = list(arm.model.names)[1:]
    slides = [_slides(arm, joint) for joint in range(arm.joints)]
    clock = clock_of(file.names, wanted.mapping, wanted.time)
    source = wanted.source if isinstance(file, CsvFile) else None
    layout = match(file.names, joints, slides, wanted.mapping, source, wanted.angles)
    parts = [*clock.columns, *(c for columns in layout.columns.values() for c in columns)]
    values, rows = file.read(parts)
    remarks = list(layout.remarks)
    if isinstance(file, McapFile) and file.skipped:
        remarks.append(f"{file.skipped} messages without all joints are left out")
    if len(values) < FEWEST_ROWS:
        raise RecordingError(f"has {len(values)} rows, at least {FEWEST_ROWS} are needed")
    clocked, width = values[:, : len(clock.columns)], arm.joints
    _check_finite(clocked, rows, [file.names[c] for c in clock.columns])
    time, _, more = seconds_of(clock, clocked, rows)
    blocks = _blocks(values[:, len(clock.columns) :], layout, width)
    found = _kept(blocks, layout, rows, file.names, remarks)
    remarks += _units_said(layout, found, wanted.angles)
    measured = MEASURED in found
    for slot in (DESIRED, MEASURED):
        if slot in found:
            prefix = "the desired angle of " if slot == DESIRED else ""
            named = [f"{prefix}{joint}" for joint in joints]
            found[slot] = _unwound(found[slot], slides, named, remarks)
    if measured and DESIRED in found:
        turns = whole_turns(found[DESIRED] - found[MEASURED], ~np.array(slides))
        found[DESIRED] = found[DESIRED] - TURN * turns
        remarks += turns_said(turns, joints, "the desired angle", "the measured one")
    q = found[MEASURED if measured else DESIRED]
    if not measured:
        remarks.append("no measured angles: those that were asked for are taken")
    if not wanted.angles:
        _look_like_degrees(q, slides, remarks)
    return Recording(
        name=path.name,
        time=time,
        q=q,
        measured=measured,
        v=found.get((VELOCITY, False)),
        tau=found.get((TORQUE, False)),
        current=found.get((CURRENT, False)),
        q_d=found.get(DESIRED),
        v_d=found.get((VELOCITY, True)),
        remarks=(*remarks, *more),
    )


def _slides(arm: KnownArm, joint: int) -> bool:
    found = turned_axis(arm.model, joint + 1)
    return found is not None and bool(found[1])


def _blocks(values: Array, layout: Layout, joints: int) -> dict[Slot, Array]:
    """Return the columns of each quantity, in SI units."""
    pieces = np.split(values, len(layout.columns), axis=1)
    return {
        slot: piece * np.array(layout.factors[slot])
        for slot, piece in zip(layout.columns, pieces, strict=True)
        if piece.shape[1] == joints
    }


def _kept(
    blocks: dict[Slot, Array],
    layout: Layout,
    rows: Array,
    names: tuple[str, ...],
    remarks: list[str],
) -> dict[Slot, Array]:
    """Leave out what is empty throughout; refuse what is empty here and there."""
    kept = {}
    for slot, block in blocks.items():
        headers = [names[column] for column in layout.columns[slot]]
        if slot != MEASURED and np.isnan(block).all(axis=0).any():
            if (~np.isnan(block)).any() or slot[1]:
                remarks.append(f"{slot[0]} is left out: columns of it are empty")
            continue
        _check_finite(block, rows, headers)
        kept[slot] = block
    if MEASURED not in kept and DESIRED not in kept:
        raise RecordingError("has no angles: all of their cells are empty")
    return kept


def _units_said(layout: Layout, found: Mapping[Slot, Array], angles: str) -> list[str]:
    """Say which units were taken where headers have none, but for those that were asked for."""
    taken: dict[str, dict[str, None]] = {}
    for slot, units in layout.assumed.items():
        asked = {angles} if slot in (MEASURED, DESIRED) else set()
        if slot in found and not set(units) <= asked:
            taken.setdefault(_PLURAL[slot[0]], {}).update(dict.fromkeys(units))
    if not taken:
        return []
    said = ", ".join(f"{what} as {' or '.join(units)}" for what, units in taken.items())
    return [f"taken where no unit is given: {said}"]


def _check_finite(block: Array, rows: Array, headers: list[str]) -> None:
    wrong = np.argwhere(~np.isfinite(block))
    if len(wrong):
        row, column = (int(place) for place in wrong[0])
        value = block[row, column]
        said = "is empty or NaN" if np.isnan(value) else "is infinite"
        more = f", as are {len(wrong) - 1} more cells" if len(wrong) > 1 else ""
        raise RecordingError(
            f"{said}{more}: fill it in, take out the row, or cut the recording before it",
            row=int(rows[row]),
            column=headers[column],
            value=str(float(value)),
        )


def _unwound(q: Array, slides: list[bool], joints: list[str], remarks: list[str]) -> Array:
    """Take out jumps by a turn, which are no motion."""
    jumps = np.abs(np.diff(q, axis=0)) > np.pi
    for joint, sliding in enumerate(slides):
        if not sliding and jumps[:, joint].any():
            q = q.copy()
            q[:, joint] = np.unwrap(q[:, joint])
            count = int(jumps[:, joint].sum())
            often = "once" if count == 1 else f"{count} times"
            remarks.append(f"{joints[joint]} jumps by a turn {often}: taken as one motion")
    return q


def _look_like_degrees(q: Array, slides: list[bool], remarks: list[str]) -> None:
    turning = ~np.array(slides)
    if turning.any() and np.abs(q[:, turning]).max() > _FASTEST_LOOKING:
        most = float(np.abs(q[:, turning]).max())
        remarks.append(
            f"angles reach {most:.4g} rad, more than two turns: if they are degrees, write "
            "q1 [deg] in the header or give their unit"
        )
