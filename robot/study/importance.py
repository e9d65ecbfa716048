"""Which of the searched gains counted, and which way each figure goes with it."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution
from optuna.importance import PedAnovaImportanceEvaluator
from optuna.storages import InMemoryStorage
from optuna.trial import FrozenTrial, TrialState

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.search_space import search_space
from slidetune.robot.study.tune import Trial
from slidetune.robot.study.tuning import Tuning

Array = np.ndarray

FEWEST = 24
"""Trials that it takes to tell (*ours*)."""
RIDGE = 1e-3
"""By how much a fit of the trials' order is kept from what few of them say, a trial (*ours*)."""


class _Told(InMemoryStorage):
    """Trials that a study has without taking them over one by one, which is most of the time."""

    def __init__(self, trials: list[FrozenTrial]) -> None:
        super().__init__()
        self._told = trials

    def get_all_trials(self, *_: object, **__: object) -> list[FrozenTrial]:
        """Return all, whatever is asked for: each has come to its end."""
        return self._told


def importance(
    experiment: Experiment, tuning: Tuning, trials: Sequence[Trial]
) -> dict[str, float] | None:
    """Return each searched number's share, the greatest first; ``None`` where nobody can tell.

    Args:
        experiment: of the search.
        tuning: what it was told.
        trials: those made so far; one that was given up counts by what it costs at least.

    Returns:
        By name of the dimension, 1 in all. Of ``cmaes``, whose trials wander all together, how much
        worse the order of the trials is told without it: see ``_without``. Of the others PED-ANOVA
        (Watanabe, Bansal and Hutter, 2023), which compares where the best tenth of the trials lie
        with where all lie.
    """
    space = search_space(experiment, tuning)
    costs = {one.outcome.cost for one in trials}
    if len(trials) < FEWEST or len(space) < 2 or len(costs) < 2:
        return None
    ranges: dict[str, BaseDistribution] = {
        one.name: FloatDistribution(one.low, one.high, log=one.logarithmic) for one in space
    }
    # Four digits may lie a rounding outside of a range that has more, the present gains anywhere.
    values = [
        {one.name: min(max(trial.values[one.name], one.low), one.high) for one in space}
        for trial in trials
    ]
    if tuning.sampler == "cmaes":
        shares = np.array([[one.share(value[one.name]) for one in space] for value in values])
        lost = _without(shares, np.array([one.outcome.cost for one in trials]))
        return _in_order({one.name: each for one, each in zip(space, lost.tolist(), strict=True)})
    told = [
        FrozenTrial(
            number=place,
            trial_id=place,
            state=TrialState.COMPLETE,
            value=one.outcome.cost,
            datetime_start=None,
            datetime_complete=None,
            params=params,
            distributions=ranges,
            user_attrs={},
            system_attrs={},
            intermediate_values={},
        )
        for place, (params, one) in enumerate(zip(values, trials, strict=True))
    ]
    study = optuna.create_study(storage=_Told(told))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        evaluator = PedAnovaImportanceEvaluator()
        found = optuna.importance.get_param_importances(study, evaluator=evaluator)
    return _in_order(found)


def _in_order(found: Mapping[str, float]) -> dict[str, float]:
    total = sum(found.values()) or 1.0
    names = sorted(found, key=lambda name: found[name], reverse=True)
    return {name: float(found[name]) / total for name in names}


def _without(places: Array, costs: Array) -> Array:
    r"""Return how much less of the order of some trials is told without each number.

    .. math:: r \approx a + \sum_i (b_i u_i + c_i u_i^2)

    by least squares, r the ranks of the costs; what counts of a number is by how much the sum of
    squares grows without its two terms. So two numbers that went the same way share what they tell.

    Args:
        places: of each trial and number within its range, 0 to 1. Shape (n, m).
        costs: of the trials. Shape (n,).

    Returns:
        Shape (m,), not negative.
    """
    from scipy.stats import rankdata  # slow to import, and only some studies ask

    columns = np.stack([places, places**2], axis=2)
    columns -= columns.mean(axis=0)
    ranks = rankdata(costs)
    ranks -= ranks.mean()
    ridge = RIDGE * len(ranks)

    def left(kept: Array) -> float:
        table = kept.reshape(len(ranks), -1)
        table = table / np.maximum(table.std(axis=0), 1e-12)
        weights = np.linalg.solve(table.T @ table + ridge * np.eye(table.shape[1]), table.T @ ranks)
        # With the ridge in the sum it can only grow without a term.
        residual = ranks - table @ weights
        return float(residual @ residual + ridge * weights @ weights)

    whole = left(columns)
    parts = [left(np.delete(columns, one, axis=1)) for one in range(columns.shape[1])]
    return np.maximum(np.array(parts) - whole, 0.0)


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
        that came to their end and met all draws; ``None`` where one of both is the same in all.
    """
    from scipy.stats import spearmanr  # slow to import, and only some studies ask

    # What was given up has no draw that counts: its figures are those of another one.
    ended = [one for one in trials if not one.beaten and None not in one.outcome.figures.values()]
    if len(ended) < FEWEST:
        return None
    gains = [one.name for one in search_space(experiment, tuning)]
    figures = list(ended[0].outcome.figures)
    rows = [
        [*(one.values[gain] for gain in gains), *(one.outcome.figures[name] for name in figures)]
        for one in ended
    ]
    with np.errstate(divide="ignore", invalid="ignore"):  # NaN of what is the same in all
        table = spearmanr(np.array(rows, dtype=float)).statistic[: len(gains), len(gains) :]
    return {
        gain: {
            figure: None if np.isnan(share) else float(share)
            for figure, share in zip(figures, row, strict=True)
        }
        for gain, row in zip(gains, table, strict=True)
    }
