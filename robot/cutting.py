"""Makes a step in parts where its own error is too great."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

import numpy as np

from robot.workspace import CAPPED, CUT, ERRORS, OVER, TALLY, WRONG

Array = np.ndarray
Attempt = Callable[[float, float, float], int]

HALVINGS = 10
"""How often one step is halved at most (*ours*): down to a thousandth of it."""
RUN_PARTS = 40
"""Parts that the rows of a whole run may have on average (*ours*)."""
LIVE_PARTS = 3.0
"""Parts that the rows of a live session may have on average (*ours*): it has to keep its pace."""
LIVE_BURST = 600.0
"""Parts that a live session may spend at once (*ours*): some 3 ms."""


class Cutting:
    """How far a lane's steps may be cut, and how much of that is left: a token bucket.

    Attributes:
        halvings: how often one step may be halved.
        left: how many parts the rows may still have together, beyond one each.
        refill: by how many parts that grows with every row, up to ``LIVE_BURST``.
        tolerance: how many times its tolerance the error of a step may be.
    """

    def __init__(
        self,
        halvings: int = HALVINGS,
        left: float = LIVE_BURST,
        refill: float = LIVE_PARTS,
        tolerance: float = 1.0,
    ) -> None:
        """Set all four; by default as a live session has them."""
        self.halvings, self.left, self.refill = halvings, left, refill
        self.tolerance = tolerance
        self._filled = 0.0

    @classmethod
    def of_whole_run(cls, rows: int, tolerance: float = 1.0) -> Cutting:
        """Return what a run of so many rows may take (*ours*)."""
        return cls(left=RUN_PARTS * rows, refill=0.0, tolerance=tolerance)

    def fill(self, t: float, h: float) -> None:
        """Add what the rows of length ``h`` until ``t`` are worth."""
        if self.refill > 0.0:
            rows = max(0.0, (t - self._filled) / h)
            self.left = min(LIVE_BURST, self.left + self.refill * rows)
        self._filled = t


def cutter(attempt: Attempt, h: float, cutting: Cutting, work: Array) -> Callable[[float], int]:
    """Return what makes a refused step in parts, each as long as its own error allows.

    Args:
        attempt: makes a step from the current state: ``(t, h, tolerance) -> 0, joint or REFUSED``.
        h: length of a whole step in [s].
        cutting: how far it may go.
        work: the lane's workspace, whose TALLY counts.
    """
    tally, errors = work[TALLY], work[ERRORS]

    def part(t: float, h: float, halvings: int) -> int:
        cutting.left -= 1.0
        last = halvings <= 0 or cutting.left < 0.0
        bad = attempt(t, h, inf if last else cutting.tolerance)
        if last:
            errors[OVER] = max(errors[OVER], errors[WRONG])
            return bad
        if not bad:
            return 0
        return part(t, 0.5 * h, halvings - 1) or part(t + 0.5 * h, 0.5 * h, halvings - 1)

    def cut(t: float) -> int:
        tally[CUT] += 1.0
        errors[OVER] = 0.0
        cutting.fill(t, h)
        if cutting.halvings <= 0:
            return part(t, h, 0)
        bad = part(t, 0.5 * h, cutting.halvings - 1)
        bad = bad or part(t + 0.5 * h, 0.5 * h, cutting.halvings - 1)
        if errors[OVER] > 1.0:
            tally[CAPPED] += 1.0
        return bad

    return cut
