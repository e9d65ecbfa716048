"""Which of the searched gains counted, and which way each figure goes with it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import ndtr

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.search_space import Dimension, search_space
from slidetune.robot.study.tune import Trial
from slidetune.robot.study.tuning import Tuning

Array = np.ndarray

FEWEST = 24
"""Trials that it takes to tell (*ours*)."""
BEST = 0.1
"""Share of the trials whose place is compared with that of all (*published*)."""
GRID = 50
"""Points of a range that densities are compared at (*ours*, as many as Optuna's)."""
NARROWEST = 0.5 / 1.64
"""Least width of a kernel in steps of the grid (*ours*, Optuna's): 90 % of it at its own point."""


def importance(
    experiment: Experiment, tuning: Tuning, trials: Sequence[Trial]
) -> dict[str, float] | None:
    """Return each searched number's share, the greatest first; ``None`` where nobody can tell.

    Args:
        experiment: of the search.
        tuning: what it was told.
        trials: those made so far; one that was given up counts by what it costs at least.

    Returns:
        By name of the dimension, 1 in all: PED-ANOVA (Watanabe, Bansal and Hutter, 2023), which
        compares where the best tenth of the trials lie with where all lie. The figures are those of
        Optuna's evaluator, which takes seconds for thousands of trials.
    """
    space = search_space(experiment, tuning)
    costs = np.array([one.outcome.cost for one in trials])
    if len(trials) < FEWEST or len(space) < 2 or np.ptp(costs) == 0.0:
        return None
    best = costs <= np.quantile(costs, BEST, method="inverted_cdf")
    found = {one.name: 0.0 for one in space}
    for one in space:
        if one.low < one.high:
            places = _places(one, np.array([trial.values[one.name] for trial in trials]))
            top, whole = _density(places[best]), _density(places)
            found[one.name] = float(whole @ (top / whole - 1.0) ** 2)
    total = sum(found.values()) or 1.0
    order = sorted(found, key=lambda name: found[name], reverse=True)
    return {name: found[name] / total for name in order}


def _places(dimension: Dimension, values: Array) -> Array:
    """Return at which of the ``GRID`` points of its range each value lies, halves at the lower."""
    ends = np.array([dimension.low, dimension.high])
    if dimension.logarithmic:
        # The present gains may lie outside of the range, whatever their sign.
        values, ends = np.log(np.clip(values, *ends)), np.log(ends)
    steps = (values - ends[0]) / (ends[1] - ends[0]) * (GRID - 1)
    places: Array = np.clip(np.ceil(steps - 0.5), 0, GRID - 1).astype(int)
    return places


def _density(places: Array) -> Array:
    r"""Return a Parzen estimate of how probable each point of the grid is. Shape (GRID,).

    A normal kernel at every place, cut off at the ends of the grid, and one as wide as the grid in
    its middle; their width is that of Scott (1992),
    :math:`1.059\,\min(\sigma, \mathrm{IQR}/1.34)\,n^{-1/5}`.
    """
    count, ordered = len(places), np.sort(places)
    spread = np.sqrt(np.sum((places - places.mean()) ** 2) / max(1, count - 1))
    middle = ordered[min(3 * count // 4, count - 1)] - ordered[max(count // 4, 1) - 1]
    width = 1.059 * min(middle / 1.34, spread) * count**-0.2
    centers = np.append(np.arange(GRID), 0.5 * (GRID - 1))
    widths = np.append(np.full(GRID, max(width, NARROWEST)), GRID)
    weights = np.append(np.bincount(places, minlength=GRID), 1) / (count + 1)
    edges = ndtr((np.arange(GRID + 1)[:, None] - 0.5 - centers) / widths)
    kernels = np.diff(edges, axis=0) / (edges[-1] - edges[0])
    density: Array = kernels @ weights + 1e-12
    return density


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
    # What was given up has no draw that counts: its figures are those of another one.
    ended = [one for one in trials if not one.beaten and None not in one.outcome.figures.values()]
    if len(ended) < FEWEST:
        return None
    gains = [one.name for one in search_space(experiment, tuning)]
    figures = list(ended[0].outcome.figures)
    columns = [np.array([one.values[name] for one in ended]) for name in gains]
    columns += [np.array([one.outcome.figures[name] for one in ended]) for name in figures]
    ranks = np.array([_ranks(column) for column in columns])
    norms = np.linalg.norm(ranks, axis=1)
    ranks /= np.where(norms > 0.0, norms, 1.0)[:, None]
    table, alike = ranks[: len(gains)] @ ranks[len(gains) :].T, norms == 0.0
    return {
        gain: {
            figure: None if alike[row] or alike[len(gains) + column] else float(table[row, column])
            for column, figure in enumerate(figures)
        }
        for row, gain in enumerate(gains)
    }


def _ranks(values: Array) -> Array:
    """Return each value's rank above the middle one; equal ones share the mean of theirs."""
    _, places, counts = np.unique(values, return_inverse=True, return_counts=True)
    ranks: Array = (np.cumsum(counts) - 0.5 * (counts + len(values)))[places]
    return ranks
