"""One set of gains at many draws: the draw that counts, and when the rest of them need no run.

Of n costs in order the one that counts is the k-th: the last one for the worst case, the one at or
below which 95 % of the draws are for ``p95``. As soon as more than n - k draws cost as much as the
best set of gains, this one can't be better, whatever the others say.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

from slidetune.robot.study.outcome import Outcome

CHUNK = 8
"""Draws between two looks at whether a set of gains is still in the race (*ours*)."""


def counting(count: int, judged_by: str) -> int:
    """Return k: how many of ``count`` draws the one that counts is not below."""
    return count if judged_by == "worst" else max(1, ceil(0.95 * count))


def is_beaten(costs: Sequence[float], count: int, judged_by: str, best: float) -> bool:
    """Tell whether some of the draws already show that gains aren't better than the best.

    Args:
        costs: of the draws that were made.
        count: how many draws there are.
        judged_by: ``worst`` or ``p95``.
        best: cost of the best set of gains that met all draws.
    """
    allowed = count - counting(count, judged_by)
    return sum(cost >= best for cost in costs) > allowed


def judged(outcomes: Sequence[Outcome], count: int, judged_by: str) -> Outcome:
    """Return the outcome that counts: that of the draw which is the k-th in order of cost.

    Of a set of gains that was beaten before all draws were made it is one that it is not better
    than: as many draws are above it as may be above the one that counts.

    Args:
        outcomes: of the draws that were made, in their order.
        count: how many draws there are.
        judged_by: ``worst`` or ``p95``.
    """
    above = count - counting(count, judged_by)
    order = sorted(outcomes, key=lambda one: one.cost, reverse=True)
    return order[min(above, len(order) - 1)]


def summary(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Return how many draws there were, what share diverged, and what share kept the hard goals."""
    count = max(len(outcomes), 1)
    return {
        "draws": len(outcomes),
        "diverged": sum(one.diverged_at is not None for one in outcomes) / count,
        "kept": sum(one.kept for one in outcomes) / count,
    }
