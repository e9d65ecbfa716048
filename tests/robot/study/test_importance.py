"""How much each gain counted, and which way: as Optuna and SciPy tell it one by one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import optuna
import pytest
from optuna.distributions import BaseDistribution, FloatDistribution
from optuna.importance import PedAnovaImportanceEvaluator
from scipy.stats import spearmanr

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.study.importance import correlations, importance
from slidetune.robot.study.outcome import Outcome
from slidetune.robot.study.search_space import search_space
from slidetune.robot.study.tune import Trial
from slidetune.robot.study.tuning import Tuning

LANE = "RBFNN-NFTSM"
GAINS: dict[str, Any] = {
    "nu": {"low": 0.1, "high": 30.0},
    "k1": {"low": 50.0, "high": 90.0},
    "c": {"low": 1.0, "high": 20.0},
}
WANTED = Tuning(lane=LANE, gains=GAINS, sampler="tpe")
EVOLUTION = WANTED.model_copy(update={"sampler": "cmaes"})


def experiment() -> Experiment:
    goals = {"near": {"kind": "figure", "figure": "mae", "bound": 0.01}}
    return load_preset("paper").patched({"goals": goals})


def trials(count: int, digits: int) -> list[Trial]:
    """Return trials at drawn places, whose figures go with one gain; with ties where they can."""
    random, space = np.random.default_rng(count), search_space(experiment(), WANTED)
    found = []
    for number in range(count):
        values = {one.name: float(random.uniform(one.low, one.high)) for one in space}
        if not number:
            values["nu"] = 90.0  # the present gains may lie outside of the range
        cost = round(abs(np.log(values["nu"])) / 5.0 + 0.1 * float(random.random()), digits)
        figures: dict[str, float | None] = {"mae": cost, "chattering": values["c"], "same": 1.0}
        found.append(Trial(number, values, {}, Outcome(cost, cost, True, {}, figures), {}))
    return found


def by_optuna(made: list[Trial]) -> dict[str, float]:
    space = search_space(experiment(), WANTED)
    ranges: dict[str, BaseDistribution] = {
        one.name: FloatDistribution(one.low, one.high, log=one.logarithmic) for one in space
    }
    study = optuna.create_study()
    for one in made:
        params = {d.name: min(max(one.values[d.name], d.low), d.high) for d in space}
        study.add_trial(
            optuna.trial.create_trial(params=params, distributions=ranges, value=one.outcome.cost)
        )
    found = PedAnovaImportanceEvaluator().evaluate(study)
    return {name: share / sum(found.values()) for name, share in found.items()}


@pytest.mark.parametrize("digits", [1, 12])
@pytest.mark.parametrize("count", [24, 100, 500])
@pytest.mark.filterwarnings("ignore::optuna.exceptions.ExperimentalWarning")
def test_importance_is_what_optunas_evaluator_tells(count: int, digits: int) -> None:
    made = trials(count, digits)
    found = importance(experiment(), WANTED, made)
    assert found is not None
    assert found == pytest.approx(by_optuna(made), rel=1e-9)
    assert list(found.values()) == sorted(found.values(), reverse=True)
    assert next(iter(found)) == "nu"


@pytest.mark.parametrize("digits", [1, 12])
@pytest.mark.parametrize("count", [24, 100, 500])
def test_importance_of_an_evolution_is_that_of_the_gain_which_the_cost_goes_with(
    count: int, digits: int
) -> None:
    found = importance(experiment(), EVOLUTION, trials(count, digits))
    assert found is not None
    assert list(found) == sorted(found, key=lambda name: -found[name])
    assert found["nu"] > 0.8
    assert sum(found.values()) == pytest.approx(1.0)


def test_a_gain_that_only_wanders_with_one_that_acts_does_not_count() -> None:
    made, random = trials(200, 12), np.random.default_rng(3)
    nu, c = (
        next(one for one in search_space(experiment(), WANTED) if one.name == name)
        for name in ("nu", "c")
    )
    for number, one in enumerate(made[1:], 1):  # both narrow down, as the steps of a search do
        one.values["c"] = c.at(0.5 * number / 200 + 0.02 * float(random.random()))
        one.values["nu"] = nu.at(1.0 - 0.5 * number / 200 - 0.2 * float(random.random()))
    costs = [one.values["nu"] for one in made]
    told = [
        replace(one, outcome=replace(one.outcome, cost=cost))
        for one, cost in zip(made, costs, strict=True)
    ]
    found = importance(experiment(), EVOLUTION, told)
    assert found is not None
    assert found["nu"] > 0.9


@pytest.mark.parametrize("digits", [1, 12])
@pytest.mark.parametrize("count", [24, 500])
def test_correlations_are_those_of_scipy_with_equal_values_and_without(
    count: int, digits: int
) -> None:
    made = trials(count, digits)
    found = correlations(experiment(), WANTED, made)
    assert found is not None
    for gain in GAINS:
        values = [one.values[gain] for one in made]
        for figure in ("mae", "chattering"):
            told = [one.outcome.figures[figure] for one in made]
            expected = spearmanr(values, told).statistic
            assert found[gain][figure] == pytest.approx(expected, abs=1e-12)
        assert found[gain]["same"] is None


def test_too_few_trials_or_equal_ones_tell_nothing() -> None:
    assert importance(experiment(), WANTED, trials(23, 12)) is None
    assert correlations(experiment(), WANTED, trials(23, 12)) is None
    assert importance(experiment(), WANTED, []) is None
    equal = trials(24, 12)[:1] * 30
    assert importance(experiment(), WANTED, equal) is None
