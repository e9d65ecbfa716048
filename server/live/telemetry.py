"""A ring of the last rows of every channel; every reader has its own cursor into it."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slidetune.robot.arm.arm import flange_positions
from slidetune.robot.fields.units import sliding
from slidetune.robot.kernels.workspace import RECORD
from slidetune.robot.loop.closed_loop import ClosedLoop

Array = np.ndarray

ROWS = 65536
"""Rows that the ring holds (*ours*): a minute at 1 kHz, as long as the plots of the page show."""
LAG = 4096
"""Rows that a reader may be behind before it is skipped ahead (*ours*)."""

HEADER_FIELDS = (
    ("revision", "I", "", "Revision of the experiment that made these rows."),
    ("rows", "I", "", "How many rows follow."),
    ("columns", "I", "", "How many columns: as many as hello has channels."),
    ("dropped", "I", "", "Rows left out before the first one, because this client was too slow."),
    ("time", "d", "s", "Simulated time of the first row."),
    ("period", "d", "s", "Simulated time between two rows."),
)
"""What stands before the rows of a frame, in order: name, ``struct`` code, unit and meaning."""
HEADER = struct.Struct("<" + "".join(code for _, code, _, _ in HEADER_FIELDS))

SHARED = (("q_d", "rad"), ("v_d", "rad/s"))
OWN = (("e", "rad"), ("de", "rad/s"), ("tau", "N·m"), ("S", "rad/s"), ("f", "N·m"))
AXES = ("x", "y", "z")

_GROUP = {name: index for index, name in enumerate(RECORD)}


@dataclass(frozen=True)
class Channel:
    """One column of telemetry."""

    name: str
    group: str
    joint: int | str
    lane: str
    unit: str


@dataclass(frozen=True)
class KeptRows:
    """Rows one after another, whose time runs forward.

    Attributes:
        columns: what each column is.
        time: simulated time in [s]. Shape (n,).
        revision: revision of the experiment that made each row. Shape (n,).
        values: the columns' values, in their units, of single precision. Shape (n, columns).
        frozen: which lanes stood still, bit ``i`` being lane ``i``'s. Shape (n,).
    """

    columns: tuple[Channel, ...]
    time: Array
    revision: Array
    values: Array
    frozen: Array


def channels(lanes: list[str], joints: int, slides: Sequence[bool] = ()) -> list[Channel]:
    """Return the columns of a row, in order: what all share, then each lane's own.

    Args:
        lanes: names of the lanes.
        joints: how many joints the arm has.
        slides: whether each of them slides; none does by default.
    """
    kinds = slides or (False,) * joints

    def each(group: str, unit: str, lane: str = "") -> list[Channel]:
        prefix = f"{lane}/" if lane else ""
        return [
            Channel(f"{prefix}{group}{j}", group, j, lane, sliding(unit) if slides else unit)
            for j, slides in enumerate(kinds, 1)
        ]

    def axes(group: str, lane: str = "") -> list[Channel]:
        prefix = f"{lane}/" if lane else ""
        return [Channel(f"{prefix}{group}_{axis}", group, axis, lane, "m") for axis in AXES]

    columns = [channel for group, unit in SHARED for channel in each(group, unit)]
    columns += axes("flange_d")
    for lane in lanes:
        columns += [channel for group, unit in OWN for channel in each(group, unit, lane)]
        columns += each("weights", "N·m", lane) + axes("flange", lane)
    return columns


def rows_of(loop: ClosedLoop, first: int, last: int) -> Array:
    """Return the telemetry of the steps ``first`` to ``last - 1``. Shape (n, columns)."""
    index = np.arange(first, last) % loop.rows
    places = loop.packed.places
    records = [lane.record[index] for lane in loop.lanes.values()]
    desired = records[0][:, _GROUP["q_d"]], records[0][:, _GROUP["v_d"]]
    blocks: list[Array] = [*desired, flange_positions(desired[0], places)]
    for record in records:
        q = record[:, _GROUP["q"]]
        blocks += [desired[0] - q, desired[1] - record[:, _GROUP["v"]]]
        blocks += [record[:, _GROUP[name]] for name in ("tau", "S", "f", "weights")]
        blocks.append(flange_positions(q, places))
    return np.hstack(blocks)


def frozen_rows(loop: ClosedLoop, time: float, count: int) -> Array | int:
    """Return which lanes stand still, by row: bit ``i`` is lane ``i``'s. Shape (count,), or 0.

    Args:
        loop: the lanes, after the last of these rows.
        time: time of the first in [s].
        count: how many there are.
    """
    found: Array | int = 0
    for place, lane in enumerate(loop.lanes.values()):
        if lane.freeze is not None:
            # The row of the freeze itself is the last that the lane made.
            after = time + loop.period * np.arange(count) > lane.freeze.time + loop.period / 2
            found = found | (after.astype(np.uint8) << place)
    return found


class Telemetry:
    """Rows written by one thread and read by others.

    The writer fills rows before it raises ``written``, and a reader never asks for the oldest part
    of the ring, so that no lock is needed.

    Attributes:
        columns: the channels, in order.
        written: how many rows have been written in all.
    """

    def __init__(
        self, lanes: list[str], joints: int, rows: int = ROWS, slides: Sequence[bool] = ()
    ) -> None:
        """Make room for ``rows`` rows; the other arguments are those of ``channels``."""
        self.columns = channels(lanes, joints, slides)
        self.written = 0
        self._rows = rows
        self._data = np.zeros((rows, len(self.columns)), dtype=np.float32)
        self._time = np.zeros(rows)
        self._period = np.zeros(rows)
        self._revision = np.zeros(rows, dtype=np.int64)
        self._frozen = np.zeros(rows, dtype=np.uint8)

    def write(
        self, block: Array, time: float, period: float, revision: int, frozen: Array | int = 0
    ) -> None:
        """Append rows.

        Args:
            block: rows. Shape (n, columns).
            time: time of the first in [s].
            period: time between rows in [s].
            revision: revision of the experiment that made them.
            frozen: which lanes stood still; see ``frozen_rows``.
        """
        count = len(block)
        index = (self.written + np.arange(count)) % self._rows
        limit = np.finfo(np.float32).max
        self._data[index] = np.clip(block, -limit, limit)
        self._time[index] = time + period * np.arange(count)
        self._period[index] = period
        self._revision[index] = revision
        self._frozen[index] = frozen
        self.written += count

    def frame(self, cursor: int) -> tuple[bytes, int] | None:
        """Return the next frame for a reader, and its new cursor; ``None`` if there is none.

        A frame holds one revision and one period, and time runs forward in it. A reader that is
        more than ``LAG`` rows behind is skipped ahead; the frame says how many rows it missed.
        """
        written = self.written
        if cursor >= written:
            return None
        dropped = max(0, written - LAG - cursor)
        first = cursor + dropped
        index = np.arange(first, written) % self._rows
        breaks = (
            (np.diff(self._revision[index]) != 0)
            | (np.diff(self._period[index]) != 0.0)
            | (np.diff(self._time[index]) <= 0.0)
        )
        count = int(np.argmax(breaks)) + 1 if breaks.any() else len(index)
        index = index[:count]
        head = HEADER.pack(
            int(self._revision[index[0]]) & 0xFFFFFFFF,
            count,
            len(self.columns),
            dropped,
            float(self._time[index[0]]),
            float(self._period[index[0]]),
        )
        return head + self._data[index].T.tobytes(), first + count

    def last(self, seconds: float) -> KeptRows:
        """Return the newest rows, as far back as time runs forward and they are kept.

        Args:
            seconds: simulated time in [s] that they cover at most.
        """
        written = self.written
        # Without the oldest part: the writer may fill it meanwhile.
        oldest = max(0, written - self._rows + LAG)
        index = np.arange(oldest, written) % self._rows
        time = self._time[index]
        jumps = np.flatnonzero(np.diff(time) <= 0.0)
        begin = int(jumps[-1]) + 1 if len(jumps) else 0
        if written:
            earliest = time[-1] - seconds - self._period[index[-1]] / 2
            begin += int(np.searchsorted(time[begin:], earliest))
        index = index[begin:]
        revision, values, frozen = self._revision[index], self._data[index], self._frozen[index]
        # A writer that made more rows than that meanwhile has overwritten the first of these.
        lost = max(0, self.written - self._rows + LAG - oldest - begin)
        return KeptRows(
            tuple(self.columns), time[begin + lost :], revision[lost:], values[lost:], frozen[lost:]
        )
