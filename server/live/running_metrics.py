"""Figures of a lane that grow with every tick: since a moment, and over the last ten seconds."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from math import ceil
from typing import Any

import numpy as np

from slidetune.robot.loop.metrics import follow_torque, unturned
from slidetune.server.live.telemetry import Channel

Array = np.ndarray

RECENT = 10.0
"""Length of the recent window in [s] of simulated time (*ours*)."""
SPAN = 0.1
"""By so much at most the recent window is longer in [s]: it is kept in spans (*ours*)."""
_ROUNDING = 1e-9
"""What rounding may do to a time in parts of a period or a span."""


def _none() -> Array:
    """Return nothing yet: what comes first says how many joints there are."""
    return np.zeros(())


@dataclass
class Sums:
    """What a span of rows adds up to; spans that follow each other can be joined.

    A row stands for the time until the next one, so that each counts by its own period: rows of
    another step or control rate may follow.

    Attributes:
        time: what the rows stand for in [s].
        last: what the last of them stands for in [s]; the rest is between the first and the last.
        jump: way of all joints' torque from the row before in [N m]: only a longer span has it
            inside.
        error: absolute error by time in [rad s]. Shape (n,).
        max_error: greatest absolute error in [rad]. Shape (n,).
        max_velocity_error: greatest absolute velocity error in [rad/s]. Shape (n,).
        variation: way of all joints' torque from the first row to the last in [N m].
        reversals: of each joint's torque, each counted at the row that shows it. Shape (n,).
        peak_torque: greatest absolute torque in [N m]. Shape (n,).
        squared_torque: squared torque by time in [(N m)^2 s]. Shape (n,).
        squared_distance: squared distance of the flange by time in [m^2 s].
        max_distance: greatest distance of the flange in [m].
    """

    time: float = 0.0
    last: float = 0.0
    jump: float = 0.0
    error: Array = field(default_factory=_none)
    max_error: Array = field(default_factory=_none)
    max_velocity_error: Array = field(default_factory=_none)
    variation: float = 0.0
    reversals: Array = field(default_factory=_none)
    peak_torque: Array = field(default_factory=_none)
    squared_torque: Array = field(default_factory=_none)
    squared_distance: float = 0.0
    max_distance: float = 0.0

    def join(self, other: Sums) -> None:
        """Take in the span that follows."""
        if self.time:
            self.variation += other.jump
        else:
            self.jump = other.jump
        self.time += other.time
        self.last = other.last
        self.error = self.error + other.error
        self.max_error = np.maximum(self.max_error, other.max_error)
        self.max_velocity_error = np.maximum(self.max_velocity_error, other.max_velocity_error)
        self.variation += other.variation
        self.reversals = self.reversals + other.reversals
        self.peak_torque = np.maximum(self.peak_torque, other.peak_torque)
        self.squared_torque = self.squared_torque + other.squared_torque
        self.squared_distance += other.squared_distance
        self.max_distance = max(self.max_distance, other.max_distance)

    def document(self) -> dict[str, Any] | None:
        """Return the figures as plain JSON values, ``None`` before the first row."""
        if not self.time:
            return None
        between = self.time - self.last
        return {
            "mae": (self.error / self.time).tolist(),
            "max_error": self.max_error.tolist(),
            "max_velocity_error": self.max_velocity_error.tolist(),
            "chattering": self.variation / between if between > 0.0 else 0.0,
            "switches": (self.reversals / (between or np.inf)).tolist(),
            "peak_torque": self.peak_torque.tolist(),
            "flange_rms": float(np.sqrt(self.squared_distance / self.time)),
            "flange_max": self.max_distance,
            "rms_torque": np.sqrt(self.squared_torque / self.time).tolist(),
        }


class RunningMetrics:
    """The figures of one lane while it runs.

    Attributes:
        total: what has added up since ``time``.
        time: since when that counts in [s].
        reason: why it counts since then; see ``server.contract.live_messages.Since``.
    """

    def __init__(
        self, columns: list[Channel], lane: str, time: float = 0.0, reason: str = "reset"
    ) -> None:
        """Begin with nothing at ``time`` [s]; the other arguments are those of ``find``."""
        self.find(columns, lane)
        self.restart(time, reason)

    def find(self, columns: list[Channel], lane: str) -> None:
        """Find the columns of the lane, where they are others or it has another name."""
        self._columns = {
            group: [i for i, c in enumerate(columns) if c.group == group and c.lane == owner]
            for group, owner in (
                ("e", lane),
                ("de", lane),
                ("tau", lane),
                ("flange", lane),
                ("flange_d", ""),
            )
        }

    def restart(self, time: float, reason: str) -> None:
        """Forget everything, as after a reset; the arguments are those of ``restart_total``."""
        self.restart_total(time, reason)
        self._spans: deque[tuple[int, Sums]] = deque()
        self._torque: Array | None = None
        self._turns = unturned(len(self._columns["e"]))

    def restart_total(self, time: float, reason: str) -> None:
        """Let the total count anew; the last ten seconds are what they are.

        Args:
            time: since when, in [s].
            reason: why.
        """
        self.total, self.time, self.reason = Sums(), time, reason

    def add(self, rows: Array, time: float, period: float) -> None:
        """Take rows in.

        Args:
            rows: telemetry. Shape (n, columns).
            time: time of the first in [s].
            period: time between rows in [s].
        """
        begin = 0
        while begin < len(rows):
            span = int((time + begin * period) / SPAN + _ROUNDING)
            end = max(begin + 1, ceil(((span + 1) * SPAN - time) / period - _ROUNDING))
            self._join(span, self._sums(rows[begin:end], period))
            begin = end
        past = time + len(rows) * period - RECENT
        while (self._spans[0][0] + 1 - _ROUNDING) * SPAN <= past:
            self._spans.popleft()

    def _join(self, span: int, sums: Sums) -> None:
        self.total.join(sums)
        if self._spans and self._spans[-1][0] == span:
            self._spans[-1][1].join(sums)
        else:
            self._spans.append((span, sums))

    def _sums(self, rows: Array, period: float) -> Sums:
        error, torque = np.abs(rows[:, self._columns["e"]]), rows[:, self._columns["tau"]]
        gap = rows[:, self._columns["flange"]] - rows[:, self._columns["flange_d"]]
        squares = np.einsum("ij,ij->i", gap, gap)
        jump = 0.0 if self._torque is None else float(np.abs(torque[0] - self._torque).sum())
        self._torque = torque[-1].copy()
        way, reversals = np.zeros((2, torque.shape[1]))
        follow_torque(torque, self._turns, way, reversals)
        return Sums(
            time=len(rows) * period,
            last=period,
            jump=jump,
            error=error.sum(axis=0) * period,
            max_error=error.max(axis=0),
            max_velocity_error=np.abs(rows[:, self._columns["de"]]).max(axis=0),
            variation=float(way.sum()),
            reversals=reversals,
            peak_torque=np.abs(torque).max(axis=0),
            squared_torque=np.einsum("ij,ij->j", torque, torque) * period,
            squared_distance=float(squares.sum()) * period,
            max_distance=float(np.sqrt(squares.max())),
        )

    def document(self) -> dict[str, Any]:
        """Return ``total``, since when it counts, and ``recent`` as plain JSON values."""
        recent = Sums()
        for _, sums in tuple(self._spans):
            recent.join(sums)
        return {
            "since": {"time": self.time, "reason": self.reason},
            "total": self.total.document(),
            "recent": recent.document(),
        }
