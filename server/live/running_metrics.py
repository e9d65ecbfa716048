"""Figures of a lane that grow with every tick: since a moment, and over the last ten seconds."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.server.live.telemetry import Channel

Array = np.ndarray

RECENT = 10
"""Length of the recent window in whole seconds of simulated time (*ours*)."""


def _six() -> Array:
    return np.zeros(JOINTS)


@dataclass
class Sums:
    """What a span of rows adds up to; spans that follow each other can be joined.

    Attributes:
        rows: how many.
        lead: time from the row before the span to its first in [s].
        jump: way of all joints' torque from there in [N m]: only a longer span has it inside.
        duration: time from the first row to the last in [s].
        variation: way of all joints' torque from the first row to the last in [N m].
    """

    rows: int = 0
    lead: float = 0.0
    jump: float = 0.0
    duration: float = 0.0
    error: Array = field(default_factory=_six)
    max_error: Array = field(default_factory=_six)
    max_velocity_error: Array = field(default_factory=_six)
    variation: float = 0.0
    peak_torque: Array = field(default_factory=_six)
    distance: float = 0.0
    max_distance: float = 0.0

    def join(self, other: Sums) -> None:
        """Take in the span that follows."""
        if self.rows == 0:
            self.lead, self.jump = other.lead, other.jump
        else:
            self.duration += other.lead
            self.variation += other.jump
        self.rows += other.rows
        self.duration += other.duration
        self.error += other.error
        self.max_error = np.maximum(self.max_error, other.max_error)
        self.max_velocity_error = np.maximum(self.max_velocity_error, other.max_velocity_error)
        self.variation += other.variation
        self.peak_torque = np.maximum(self.peak_torque, other.peak_torque)
        self.distance += other.distance
        self.max_distance = max(self.max_distance, other.max_distance)

    def document(self) -> dict[str, Any] | None:
        """Return the figures as plain JSON values, ``None`` before the first row."""
        if self.rows == 0:
            return None
        return {
            "mae": (self.error / self.rows).tolist(),
            "max_error": self.max_error.tolist(),
            "max_velocity_error": self.max_velocity_error.tolist(),
            "chattering": self.variation / self.duration if self.rows > 1 else 0.0,
            "peak_torque": self.peak_torque.tolist(),
            "flange_rms": float(np.sqrt(self.distance / self.rows)),
            "flange_max": self.max_distance,
        }


class RunningMetrics:
    """The figures of one lane while it runs.

    Attributes:
        total: what has added up since ``time``.
        time: since when that counts in [s].
        reason: why it counts since then; see ``server.contract.Since``.
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
        self._seconds: deque[tuple[int, Sums]] = deque()
        self._torque: Array | None = None

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
        sums = self._sums(rows, period)
        self.total.join(sums)
        second = int(time)
        if self._seconds and self._seconds[-1][0] == second:
            self._seconds[-1][1].join(sums)
        else:
            self._seconds.append((second, sums))
            while self._seconds[0][0] <= second - RECENT:
                self._seconds.popleft()

    def _sums(self, rows: Array, period: float) -> Sums:
        error, torque = np.abs(rows[:, self._columns["e"]]), rows[:, self._columns["tau"]]
        gap = rows[:, self._columns["flange"]] - rows[:, self._columns["flange_d"]]
        squares = np.einsum("ij,ij->i", gap, gap)
        jump = 0.0 if self._torque is None else float(np.abs(torque[0] - self._torque).sum())
        self._torque = torque[-1].copy()
        return Sums(
            rows=len(rows),
            lead=period,
            jump=jump,
            duration=(len(rows) - 1) * period,
            error=error.sum(axis=0),
            max_error=error.max(axis=0),
            max_velocity_error=np.abs(rows[:, self._columns["de"]]).max(axis=0),
            variation=float(np.abs(np.diff(torque, axis=0)).sum()),
            peak_torque=np.abs(torque).max(axis=0),
            distance=float(squares.sum()),
            max_distance=float(np.sqrt(squares.max())),
        )

    def document(self) -> dict[str, Any]:
        """Return ``total``, since when it counts, and ``recent`` as plain JSON values."""
        recent = Sums()
        for _, sums in tuple(self._seconds):
            recent.join(sums)
        return {
            "since": {"time": self.time, "reason": self.reason},
            "total": self.total.document(),
            "recent": recent.document(),
        }
