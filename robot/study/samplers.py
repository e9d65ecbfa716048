"""How the next numbers of a search are chosen: Optuna's samplers, without its remarks."""

from __future__ import annotations

import warnings

import optuna
from optuna.samplers import BaseSampler, CmaEsSampler, NSGAIISampler, QMCSampler, TPESampler

optuna.logging.set_verbosity(optuna.logging.WARNING)

BATCH = 8
"""Trials that are asked for at once (*ours*): enough for the cores of a desk."""
POPULATION = 24
"""Of NSGA-II (*ours*)."""


def sampler(name: str, seed: int) -> BaseSampler:
    """Return a sampler.

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
