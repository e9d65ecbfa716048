"""Makes a step in parts where its own error is too great."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

import numpy as np

from slidetune.robot.integrator.implicit_step import STUCK
from slidetune.robot.kernels.workspace import CAPPED, CUT, ERRORS, OVER, RESIGNED, TALLY, WRONG

Array = np.ndarray
Settle = Callable[[float, float], None]
Step = Callable[[float, int, int], int]
"""``step(t, number, row)``: time [s], number of the step, row to record; 0 or 1 + bad joint."""

NO_ROW = -1
"""Row of a step that is only part of one: nothing is recorded."""

HALVINGS = 10
"""How often one step is halved at most (*ours*): down to a thousandth of it."""
RUN_PARTS = 40
"""Parts that the rows of a whole run may have on average (*ours*)."""
LIVE_PARTS = 3.0
"""Parts that the rows of a live session may have on average (*ours*): it has to keep its pace."""
LIVE_BURST = 600.0
"""Parts that a live session may spend at once (*ours*): some 3 ms."""
RUN_STUCK = 0.5
"""Attempts a row, on average, whose equation may not be solved (*ours*): each takes about 1 ms."""
LIVE_STUCK = 0.02
"""The same of a live session (*ours*)."""


class Cutting:
    """How far a lane's steps may be cut, and how much of that is left: a token bucket.

    Attributes:
        halvings: how often one step may be halved.
        left: how many parts the rows may still have together, beyond one each.
        refill: by how many parts that grows with every row, up to ``LIVE_BURST``.
        tolerance: how many times its tolerance the error of a step may be.
        stuck: how many attempts may still fail to be solved; it grows with every row of a live
            session as well. Then a step that isn't solved is not cut any more, and counted.
    """

    def __init__(
        self,
        halvings: int = HALVINGS,
        left: float = LIVE_BURST,
        refill: float = LIVE_PARTS,
        tolerance: float = 1.0,
        stuck: float = LIVE_STUCK * LIVE_BURST,
    ) -> None:
        """Set all five; by default as a live session has them."""
        self.halvings, self.left, self.refill = halvings, left, refill
        self.tolerance, self.stuck = tolerance, stuck
        self._filled = 0.0

    @classmethod
    def of_whole_run(cls, rows: int, tolerance: float = 1.0) -> Cutting:
        """Return what a run of so many rows may take (*ours*)."""
        parts, stuck = RUN_PARTS * rows, RUN_STUCK * rows
        return cls(left=parts, refill=0.0, tolerance=tolerance, stuck=stuck)

    @property
    def buckets(self) -> tuple[float, float, float]:
        """What is left of parts and of failed attempts, and until when they are filled in [s]."""
        return self.left, self.stuck, self._filled

    @buckets.setter
    def buckets(self, buckets: tuple[float, float, float]) -> None:
        self.left, self.stuck, self._filled = buckets

    def fill(self, t: float, h: float) -> None:
        """Add what the rows of length ``h`` until ``t`` are worth."""
        if self.refill > 0.0:
            rows = max(0.0, (t - self._filled) / h)
            self.left = min(LIVE_BURST, self.left + self.refill * rows)
            self.stuck = min(LIVE_STUCK * LIVE_BURST, self.stuck + LIVE_STUCK * rows)
        self._filled = t


class Parts:
    """Makes a refused step in parts, each as long as its own error allows."""

    def __init__(self, settle: Settle, attempt: Step, h: float, cutting: Cutting, work: Array):
        """Bind what makes a part.

        Args:
            settle: sets length and tolerance of what follows: ``(h, tolerance)``.
            attempt: makes a step from the current state: ``(t, number, row) -> 0, joint,
                REFUSED or STUCK``.
            h: length of a whole step in [s].
            cutting: how far it may go.
            work: the lane's workspace, whose TALLY counts.
        """
        self._settle, self._attempt, self._h, self._cutting = settle, attempt, h, cutting
        self._tally, self._errors = work[TALLY], work[ERRORS]
        settle(h, cutting.tolerance)

    def make(self, t: float, row: int) -> int:
        """Make the step from ``t`` that is recorded in ``row``; return 0 or 1 + bad joint."""
        h, cutting = self._h, self._cutting
        self._tally[CUT] += 1.0
        self._errors[OVER] = 0.0
        cutting.fill(t, h)
        if cutting.halvings <= 0:
            bad = self._part(t, row, h, 0)
        else:
            bad = self._halves(t, row, h, cutting.halvings)
        if self._errors[OVER] > 1.0:
            self._tally[CAPPED] += 1.0
        self._settle(h, cutting.tolerance)
        self._errors[RESIGNED] = 0.0
        return bad

    def _halves(self, t: float, row: int, h: float, halvings: int) -> int:
        half = 0.5 * h
        # The first part says what torque the row begins with.
        bad = self._part(t, row, half, halvings - 1)
        return bad or self._part(t + half, NO_ROW, half, halvings - 1)

    def _part(self, t: float, row: int, h: float, halvings: int) -> int:
        self._cutting.left -= 1.0
        last = halvings <= 0 or self._cutting.left < 0.0
        self._settle(h, inf if last else self._cutting.tolerance)
        self._errors[RESIGNED] = 1.0 if self._cutting.stuck <= 0.0 else 0.0
        bad = self._attempt(t, 0, row)
        if bad == STUCK:
            self._cutting.stuck -= 1.0
        if last:
            self._errors[OVER] = max(self._errors[OVER], self._errors[WRONG])
            return bad
        return self._halves(t, row, h, halvings) if bad else 0
