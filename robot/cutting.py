"""Makes a step in parts where its own error is too great."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

import numpy as np

from robot.workspace import CAPPED, CUT, ERRORS, OVER, TALLY, WRONG

Array = np.ndarray
Attempt = Callable[[float, float, float], int]

LIVE_HALVINGS = 3
"""How often the live session halves a step at most (*ours*): it has to keep its pace."""
RUN_HALVINGS = 10
"""How often a whole run halves a step at most (*ours*)."""
RUN_PARTS = 20
"""Parts that the rows of a whole run may have on average (*ours*)."""


class Cutting:
    """How far steps may be cut, and how much of that is left.

    Attributes:
        deepest: how often one step may be halved.
        left: how many parts the rows may still have together, beyond one each.
        tolerance: how many times its tolerance the error of a step may be.
    """

    def __init__(
        self, deepest: int = LIVE_HALVINGS, left: float = inf, tolerance: float = 1.0
    ) -> None:
        """Set all three."""
        self.deepest, self.left, self.tolerance = deepest, left, tolerance

    @classmethod
    def of_whole_run(cls, rows: int, tolerance: float = 1.0) -> Cutting:
        """Return what a run of so many rows may take (*ours*)."""
        return cls(RUN_HALVINGS, RUN_PARTS * rows, tolerance)


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
        if cutting.deepest <= 0:
            return part(t, h, 0)
        bad = part(t, 0.5 * h, cutting.deepest - 1)
        bad = bad or part(t + 0.5 * h, 0.5 * h, cutting.deepest - 1)
        if errors[OVER] > 1.0:
            tally[CAPPED] += 1.0
        return bad

    return cut
