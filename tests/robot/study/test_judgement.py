"""What a search makes small: of a run, and of many draws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slidetune.robot.goals.section import FigureGoal, Goal, ResponseGoal
from slidetune.robot.study.judgement import (
    ENDED,
    LOUDER,
    WORSE,
    Present,
    counting,
    is_beaten,
    judged,
    missed,
    weighed,
)
from slidetune.robot.study.outcome import FAILED, Outcome

GOALS: dict[str, Goal] = {"settled": ResponseGoal(), "quiet": FigureGoal(priority="hard")}


@pytest.mark.parametrize("judged_by", ["worst", "p95"])
@pytest.mark.parametrize("count", [1, 5, 20, 50, 200])
def test_the_draw_that_counts_is_the_quantile(judged_by: str, count: int) -> None:
    random = np.random.default_rng(count)
    costs = random.random(count)
    met = [Outcome(cost, cost, True, {}, {}) for cost in costs.tolist()]
    found = judged(met, count, judged_by).cost
    share = np.mean(costs <= found)
    assert share == 1.0 if judged_by == "worst" else share >= 0.95
    assert np.sum(costs < found) < counting(count, judged_by)
    for best in (0.5 * found, found, found + 1e-9, 2.0):
        # The race is decided as the whole would be, and never against the order.
        assert is_beaten(costs, count, judged_by, best) == (found >= best)


def met(error: float, hard: float = 0.5, soft: float = 0.5, chattering: float = 1.0) -> Outcome:
    ratios: dict[str, float | None] = {"quiet": hard, "settled": soft}
    return Outcome(0.5, 0.5, hard <= 1.0, ratios, {"mae": error, "chattering": chattering})


def test_a_search_looks_at_chattering_hard_goals_soft_ones_and_the_mean_error_in_this_order() -> (
    None
):
    goals, present = GOALS, Present(missed=3, chattering=2.0)
    ordered = [
        met(0.001, chattering=2.0),
        met(0.002, hard=1.0, soft=0.1),
        met(0.001, soft=1.001),
        met(0.002, soft=1.009),  # missed by as many whole per cents
        met(0.001, soft=1.011),
        met(0.001, soft=900.0),
        met(0.001, hard=1.001, soft=0.1),
        met(0.002, hard=1.009, soft=0.1),
        met(0.001, hard=1.025),
        met(0.001, hard=1.035),  # more than the present gains
        met(0.001, hard=50.0),
        met(0.001, chattering=2.001),
        met(0.001, chattering=200.0),
        replace(met(0.001), cost=FAILED),
    ]
    costs = [weighed(one, goals, present).cost for one in ordered]
    assert costs == sorted(costs)
    assert len(set(costs)) == len(costs)
    assert [sum(cost < limit for cost in costs) for limit in (WORSE, LOUDER, ENDED)] == [9, 11, 13]
    free = weighed(ordered[-2], goals, Present())
    assert free.cost == costs[0]
    assert [missed(one, goals, "hard") for one in ordered[5:10]] == [0, 1, 1, 3, 4]
