"""Which of the searched gains counted: the share of the good trials that each one explains."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import optuna
from optuna.distributions import BaseDistribution, FloatDistribution
from optuna.importance import PedAnovaImportanceEvaluator

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.search_space import search_space
from slidetune.robot.study.tune import Trial
from slidetune.robot.study.tuning import Tuning

FEWEST = 24
"""Trials that it takes to tell (*ours*)."""


def importance(
    experiment: Experiment, tuning: Tuning, trials: Sequence[Trial]
) -> dict[str, float] | None:
    """Return each searched number's share, the greatest first; ``None`` of too few trials.

    Args:
        experiment: of the search.
        tuning: what it was told.
        trials: those made so far.

    Returns:
        By name of the dimension, 1 in all: PED-ANOVA (Watanabe, Bansal and Hutter, 2023), which
        compares where the best tenth of the trials lie with where all lie.
    """
    space = search_space(experiment, tuning)
    if len(trials) < FEWEST or len(space) < 2:
        return None
    ranges: dict[str, BaseDistribution] = {
        one.name: FloatDistribution(one.low, one.high, log=one.logarithmic) for one in space
    }
    study = optuna.create_study()
    # Four digits may lie a rounding outside of a range that has more.
    values = [
        {one.name: min(max(trial.values[one.name], one.low), one.high) for one in space}
        for trial in trials
    ]
    study.add_trials(
        [
            optuna.trial.create_trial(params=params, distributions=ranges, value=one.outcome.cost)
            for params, one in zip(values, trials, strict=True)
        ]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        evaluator = PedAnovaImportanceEvaluator()
        found = optuna.importance.get_param_importances(study, evaluator=evaluator)
    total = sum(found.values()) or 1.0
    return {name: float(share) / total for name, share in found.items()}
