"""Which of the searched gains counted, and which way each figure goes with it."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
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
    """Return each searched number's share, the greatest first; ``None`` where nobody can tell.

    Args:
        experiment: of the search.
        tuning: what it was told.
        trials: those made so far.

    Returns:
        By name of the dimension, 1 in all: PED-ANOVA (Watanabe, Bansal and Hutter, 2023), which
        compares where the best tenth of the trials lie with where all lie.
    """
    space = search_space(experiment, tuning)
    costs = {one.outcome.cost for one in trials}
    if len(trials) < FEWEST or len(space) < 2 or len(costs) < 2:
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


def correlations(
    experiment: Experiment, tuning: Tuning, trials: Sequence[Trial]
) -> dict[str, dict[str, float | None]] | None:
    """Return how each figure's rank goes with that of each searched number; ``None`` of too few.

    Args:
        experiment: of the search.
        tuning: what it was told.
        trials: those made so far. Of a search that follows the good ones it says how these lie; of
            ``sobol`` it holds over the whole ranges.

    Returns:
        By name of the dimension and of the figure: Spearman's coefficient, -1 to 1, over the trials
        that came to their end; ``None`` where a figure is the same in all.
    """
    ended = [one for one in trials if None not in one.outcome.figures.values()]
    if len(ended) < FEWEST:
        return None
    names = list(ended[0].outcome.figures)
    figures = _ranks([[one.outcome.figures[name] for name in names] for one in ended])
    space = search_space(experiment, tuning)
    values = _ranks([[one.values[dimension.name] for dimension in space] for one in ended])
    return {
        dimension.name: {
            name: _correlation(values[:, place], figures[:, column])
            for column, name in enumerate(names)
        }
        for place, dimension in enumerate(space)
    }


def _ranks(rows: Sequence[Sequence[float | None]]) -> np.ndarray:
    from scipy.stats import rankdata  # slow to import, and only some studies ask

    return np.asarray(rankdata(np.array(rows, dtype=float), axis=0))


def _correlation(one: np.ndarray, other: np.ndarray) -> float | None:
    spread = float(np.std(one) * np.std(other))
    return float(np.mean((one - one.mean()) * (other - other.mean())) / spread) if spread else None
