"""What a search makes small: of one run, and of one set of gains at many draws.

Of n costs in order the one that counts is the k-th: the last one for the worst case, the one at or
below which 95 % of the draws are for ``p95``. As soon as more than n - k draws cost as much as the
best set of gains, this one can't be better, whatever the others say.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

import numpy as np

from slidetune.robot.goals.section import Goal, Priority
from slidetune.robot.study.outcome import FAILED, Outcome

WORSE, LOUDER, ENDED = 2.0, 2.5, FAILED + 1.0
"""Costs from which on gains miss a hard goal by more than the present ones, chatter more than they
may, and from which on nothing is to be told: the run left its bounds, or was refused (*ours*)."""
MEANS = ("mae", "chattering")
"""Figures whose means over the draws are told."""
PERCENT = 0.01
"""Of a bound: goals are missed by so many of these, whole ones (*ours*)."""


@dataclass(frozen=True)
class Present:
    """What the present gains do at a draw, which others must not do worse.

    Attributes:
        missed: by how many per cents they miss the worst hard goal; ``None`` where any may.
        chattering: how they chatter in [N m/s]; ``None`` where any may.
    """

    missed: int | None = None
    chattering: float | None = None


def weighed(outcome: Outcome, goals: Mapping[str, Goal], present: Present) -> Outcome:
    r"""Return an outcome whose cost is what a search makes small.

    In this order: an end before the horizon, and its earliness; chattering, where it is more than
    it may be; by how many whole per cents the worst hard goal is missed, first where that is more
    than the present gains miss it by, then where it is missed at all; the soft ones likewise; and
    where that is the same, as where all goals are met, the mean error :math:`\bar e`. So a bound
    that no gains can keep, or that any keep, doesn't end a search.

    .. math:: 3 + \ldots, \quad 2.5 + \tfrac12 b(x / x_0), \quad 2 + \tfrac12 b(n - n_0), \quad
        1 + b(n + b(\bar e)), \quad b(n_{soft} + b(\bar e)) \quad
        \text{with } b(x) = \frac{x}{1 + x}

    Args:
        outcome: of a run.
        goals: which of them are hard.
        present: what it must not be worse than.
    """
    if outcome.cost >= FAILED:
        return replace(outcome, cost=outcome.cost + ENDED - FAILED)
    hard, soft = (missed(outcome, goals, priority) for priority in ("hard", "soft"))
    chattering, error = (outcome.figures[name] or 0.0 for name in ("chattering", "mae"))
    most = present.chattering
    if most is not None and chattering > most:
        cost = LOUDER + 0.5 * _bounded(chattering / most if most else np.inf)
    elif present.missed is not None and hard > present.missed:
        cost = WORSE + 0.5 * _bounded(hard - present.missed)
    elif hard:
        cost = 1.0 + _bounded(hard + _bounded(error))
    else:
        cost = _bounded(soft + _bounded(error))
    return replace(outcome, cost=cost)


def missed(outcome: Outcome, goals: Mapping[str, Goal], priority: Priority) -> int:
    """Return by how many per cents, of a run that came to its end, the worst goal is missed."""
    ratios = (outcome.ratios[name] for name in goals if goals[name].priority == priority)
    return max([0, *(ceil(((ratio or 0.0) - 1.0) / PERCENT) for ratio in ratios)])


def _bounded(value: float) -> float:
    """Return something that grows with a value from 0 up to 1."""
    return float(value / (1.0 + value)) if value < np.inf else 1.0


def looks(count: int, judged_by: str) -> list[int]:
    """Return after how many draws it is asked whether a set of gains is beaten.

    First as soon as it can be, then after twice as many each time, and after all of them.
    """
    found = [count - counting(count, judged_by) + 1]
    while found[-1] < count:
        found.append(min(2 * found[-1], count))
    return found


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
    """Return how many draws there were, what share diverged, what share kept the hard goals.

    And ``means``: mean error and chattering over these draws, ``None`` where one has none.
    """
    count = max(len(outcomes), 1)
    return {
        "means": {name: _mean([one.figures.get(name) for one in outcomes]) for name in MEANS},
        "draws": len(outcomes),
        "diverged": sum(one.diverged_at is not None for one in outcomes) / count,
        "kept": sum(one.kept for one in outcomes) / count,
    }


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known and len(known) == len(values) else None
