"""How the next numbers of a search are chosen: by CMA-ES, or by one of Optuna's samplers."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import optuna
from cmaes import CMA
from optuna.distributions import BaseDistribution, FloatDistribution
from optuna.samplers import BaseSampler, CmaEsSampler, NSGAIISampler, QMCSampler, TPESampler

from slidetune.robot.study.search_space import Dimension

optuna.logging.set_verbosity(optuna.logging.WARNING)

Array = np.ndarray

BATCH = 8
"""Trials that are asked for at once (*ours*): enough for the cores of a desk."""
POPULATION = 24
"""Of NSGA-II (*ours*)."""
SPREAD = 1.0 / 6.0
"""Standard deviation with which CMA-ES begins around the present values, of a range (*ours*)."""


def sampler(name: str, seed: int) -> BaseSampler:
    """Return a sampler of Optuna's.

    Args:
        name: ``tpe``, ``cmaes``, ``nsga2`` or ``sobol``.
        seed: the same one chooses the same numbers after the same results.
    """
    if name == "cmaes":
        return CmaEsSampler(seed=seed, warn_independent_sampling=False)
    if name == "nsga2":
        return NSGAIISampler(population_size=POPULATION, seed=seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        if name == "sobol":
            return QMCSampler(qmc_type="sobol", scramble=True, seed=seed)
        return TPESampler(seed=seed, n_startup_trials=2 * BATCH, multivariate=True)


class Chooser(Protocol):
    """Chooses what is tried next, after what it was told of all that was tried before."""

    def ask(self, count: int) -> list[dict[str, float]]:
        """Return that many sets of values by name; the first set ever is where it begins.

        Args:
            count: how many; 1 where it begins, then ``BATCH``, less only at the end.
        """

    def tell(self, costs: Sequence[Sequence[float]], excess: Sequence[dict[str, float]]) -> None:
        """Say what came of the sets that it was asked for last, in their order.

        Args:
            costs: what is made small of each: one number, or several.
            excess: what must not be above 0, by name; only where several are made small.
        """


def chooser(name: str, seed: int, space: Sequence[Dimension], several: int = 1) -> Chooser:
    """Return what chooses the values that a search tries.

    Args:
        name: ``cmaes``, ``tpe``, ``nsga2`` or ``sobol``.
        seed: the same one chooses the same values after the same results.
        space: what is searched.
        several: how many numbers are made small.
    """
    return Evolution(seed, space) if name == "cmaes" else Asked(name, seed, space, several)


class Evolution:
    """CMA-ES around the present values; a generation is a batch.

    It is the ``cmaes`` that Optuna has too; but Optuna's generations are of another size, and it
    writes down the whole state with every trial.
    """

    def __init__(self, seed: int, space: Sequence[Dimension]) -> None:
        """Begin where the present values are."""
        self._space = space
        mean = [one.share(one.begin) for one in space]
        if len(mean) < 2:
            mean.append(0.5)  # it takes two numbers or more: nobody looks at this one
        bounds = np.tile([0.0, 1.0], (len(mean), 1))
        self._evolution = CMA(
            np.array(mean), SPREAD, bounds=bounds, seed=seed, population_size=BATCH
        )
        self._places: list[Array] | None = None

    def ask(self, count: int) -> list[dict[str, float]]:
        """Draw places around the mean."""
        if self._places is None:
            self._places = []
            return [{one.name: one.begin for one in self._space}]
        self._places = [self._evolution.ask() for _ in range(count)]
        return [
            {one.name: one.at(float(share)) for one, share in zip(self._space, place, strict=False)}
            for place in self._places
        ]

    def tell(self, costs: Sequence[Sequence[float]], excess: Sequence[dict[str, float]]) -> None:
        """Take a generation; where it begins, and one that the end cuts short, are none."""
        if self._places and len(costs) == BATCH:
            one_each = (first for first, *_ in costs)
            self._evolution.tell(list(zip(self._places, one_each, strict=True)))


class Asked:
    """One of Optuna's samplers."""

    def __init__(self, name: str, seed: int, space: Sequence[Dimension], several: int) -> None:
        """Begin a study, with the present values as its first trial."""
        self._study = optuna.create_study(
            directions=["minimize"] * several, sampler=sampler(name, seed)
        )
        self._study.enqueue_trial({one.name: one.begin for one in space})
        self._ranges: dict[str, BaseDistribution] = {
            one.name: FloatDistribution(one.low, one.high, log=one.logarithmic) for one in space
        }
        self._trials: list[optuna.Trial] = []

    def ask(self, count: int) -> list[dict[str, float]]:
        """Ask the study."""
        self._trials = [self._study.ask(self._ranges) for _ in range(count)]
        return [dict(trial.params) for trial in self._trials]

    def tell(self, costs: Sequence[Sequence[float]], excess: Sequence[dict[str, float]]) -> None:
        """Tell the study."""
        for trial, made, limits in zip(self._trials, costs, excess, strict=True):
            for name, value in limits.items():
                trial.set_constraint(name, value)
            self._study.tell(trial, list(made))
