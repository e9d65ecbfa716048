"""Robustness: the draws are those of any other study, and its summary is theirs."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.study.draws import drawn, placed
from slidetune.robot.study.outcome import Outcome, outcome
from slidetune.robot.study.robustness import Draw, quantiles, robustness, worst_case

LANE = "NFTSM"


def uncertain() -> Experiment:
    patch: dict[str, Any] = {
        "simulation": {"horizon": 0.5},
        "goals": {"near": {"kind": "figure", "figure": "max_error", "bound": 0.01}},
        "uncertainty": {"payload": [0.0, 4.0], "inertia": [0.8, 1.2]},
    }
    return load_preset("paper").patched(patch)


def test_every_draw_is_the_run_of_its_experiment_in_order() -> None:
    experiment = uncertain()
    found = []
    for workers in (1, 3):
        with ThreadPoolExecutor(workers) as pool:
            found.append(list(robustness(experiment, LANE, 11, pool)))
    assert found[0] == found[1]
    for index, draw in enumerate(found[0]):
        assert draw.index == index
        assert draw.outcome == outcome(drawn(experiment, index), LANE)
        assert set(draw.values) == {"payload", "inertia"}


def test_quantiles_are_those_that_the_share_keeps_to() -> None:
    values = np.random.default_rng(2).random(40)
    draws = [
        Draw(index, (), {}, Outcome(value, value, True, {"g": value}, {"mae": value}))
        for index, value in enumerate(values.tolist())
    ]
    found = quantiles(draws)["figures"]["mae"]
    for name, share in (("p5", 0.05), ("median", 0.5), ("p95", 0.95), ("worst", 1.0)):
        bound = found[name]
        assert bound is not None
        assert np.mean(values <= bound) >= share
        assert np.mean(values < bound) < share
    failed = Draw(40, (), {}, Outcome(3.0, None, False, {"g": None}, {"mae": None}, 0.1))
    worse = quantiles([*draws, failed])["ratios"]["g"]
    assert worse["worst"] is None
    assert worse["median"] is not None


def test_the_worst_found_is_at_least_as_bad_as_the_corner_that_is_the_worst() -> None:
    experiment = uncertain()
    with ThreadPoolExecutor(2) as pool:
        tried = list(worst_case(experiment, LANE, 48, pool, seed=3))
        again = list(worst_case(experiment, LANE, 48, pool, seed=3))
    assert tried == again
    assert [one.index for one in tried] == list(range(48))
    worst = max(tried, key=lambda one: one.outcome.cost)
    assert outcome(placed(experiment, np.array(worst.share)), LANE) == worst.outcome
    corners = [
        outcome(placed(experiment, np.array([m, i, *[0.5] * 6])), LANE).cost
        for m in (0.0, 1.0)
        for i in (0.0, 1.0)
    ]
    assert worst.outcome.cost > max(corners) - 0.02


def test_the_worst_by_no_goal_is_refused() -> None:
    aimless = uncertain().patched({"goals": {"near": None}})
    with ThreadPoolExecutor(1) as pool:
        assert len(list(robustness(aimless, LANE, 2, pool))) == 2
        with pytest.raises(InvalidExperimentError, match="set a goal first"):
            worst_case(aimless, LANE, 4, pool)


def test_nothing_uncertain_is_refused_before_it_runs() -> None:
    with ThreadPoolExecutor(1) as pool:
        for study in (robustness, worst_case):
            with pytest.raises(InvalidExperimentError, match="give a quantity"):
                study(load_preset("paper"), LANE, 5, pool)
            with pytest.raises(InvalidExperimentError, match="no lane is named X"):
                study(uncertain(), "X", 5, pool)
