"""Search for gains: Optuna asks, this tells, an executor runs.

Trials are asked for in batches of a fixed size and told in their order, so that a seed gives the
same trials on one thread, on two, or on a cluster.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.response import only_lane
from slidetune.robot.study.judgement import is_beaten, judged, summary
from slidetune.robot.study.outcome import FAILED, NOMINAL, Outcome, outcomes
from slidetune.robot.study.race import draws_a_task, race
from slidetune.robot.study.samplers import BATCH, sampler
from slidetune.robot.study.search_space import Dimension, patch_of, search_space
from slidetune.robot.study.tuning import Tuning, check_tuning

FAR = 1e12
"""Ratio that counts for a goal which can't be told, times the run's cost (*ours*)."""


@dataclass(frozen=True)
class Trial:
    """One set of gains that was tried.

    Attributes:
        number: which one, from 0; the first is the present one.
        values: what was searched, by name of the dimension.
        patch: the merge patch that makes it so.
        outcome: that of the draw which counts.
        draws: how many draws it met, the share that diverged and that which kept the hard goals.
        beaten: whether it was given up before it met all draws.
    """

    number: int
    values: dict[str, float]
    patch: dict[str, Any] = field(repr=False)
    outcome: Outcome
    draws: dict[str, Any]
    beaten: bool = False

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return asdict(self)


def tune(
    experiment: Experiment, tuning: Tuning, executor: Executor, known: Sequence[Trial] = ()
) -> Iterator[Trial]:
    """Search for gains; yield every trial in its order.

    Whoever has seen enough stops asking: what is under way is cancelled.

    Args:
        experiment: whose goals count.
        tuning: what to search, and how.
        executor: where the runs are made.
        known: trials of an earlier search with these same arguments, from its first on; they are
            not run again, and the others are those that it would have gone on with.

    Raises:
        InvalidExperimentError: before anything runs; see ``check_tuning`` and ``search_space``.
    """
    check_tuning(experiment, tuning)
    space = search_space(experiment, tuning)
    alone = only_lane(experiment, tuning.lane)
    return _Search(alone, tuning, space, executor).trials(known)


def best_of(trials: Sequence[Trial]) -> Trial | None:
    """Return the trial of the least cost that met all draws; the earlier one of equals."""
    whole = [trial for trial in trials if not trial.beaten]
    return min(whole, key=lambda trial: (trial.outcome.cost, trial.number), default=None)


def pareto_front(trials: Sequence[Trial], goals: Sequence[str]) -> list[Trial]:
    """Return the trials that no other beats in every one of some goals, all hard ones kept.

    Args:
        trials: those to choose from.
        goals: names of the goals whose ratios are compared.
    """
    able = [trial for trial in trials if trial.outcome.kept and not trial.beaten]
    columns = [[trial.outcome.ratios[name] for trial in able] for name in goals]
    table = np.array(columns, dtype=float).reshape(len(goals), len(able))  # None becomes NaN
    # Whoever beats another comes before it in this order: the first that is left is unbeaten.
    order, unbeaten = np.lexsort(table[::-1]), list[int]()
    left = order[~np.isnan(table[:, order]).any(axis=0)]
    while len(left):
        first, left = int(left[0]), left[1:]
        unbeaten.append(first)
        own, others = table[:, first, None], table[:, left]
        beaten = np.all(own <= others, axis=0) & np.any(own < others, axis=0)
        left = left[~beaten]
    return [able[place] for place in sorted(unbeaten)]


class _Search:
    """Optuna's study, and what has been told to it."""

    def __init__(
        self, experiment: Experiment, tuning: Tuning, space: list[Dimension], executor: Executor
    ) -> None:
        self._experiment, self._tuning, self._space = experiment, tuning, space
        self._executor, self._best = executor, float("inf")
        goals = experiment.goals
        self._soft = [name for name, goal in goals.items() if goal.priority == "soft"]
        self._several = tuning.sampler == "nsga2"
        self._draws = tuple(range(tuning.draws)) or (NOMINAL,)
        self._size = draws_a_task(experiment)
        self._study = optuna.create_study(
            directions=["minimize"] * (len(self._soft) if self._several else 1),
            sampler=sampler(tuning.sampler, tuning.seed),
        )
        self._study.enqueue_trial({one.name: one.begin for one in space})
        self._range: dict[str, BaseDistribution] = {
            one.name: FloatDistribution(one.low, one.high, log=one.logarithmic) for one in space
        }

    def trials(self, known: Sequence[Trial]) -> Iterator[Trial]:
        """Yield trial after trial, batch by batch."""
        stored = {trial.number: trial for trial in known}
        for first in range(0, self._tuning.trials, BATCH):
            count = min(BATCH, self._tuning.trials - first)
            asked = [self._study.ask(self._range) for _ in range(count)]
            values = [
                {one.name: one.rounded(trial.params[one.name]) for one in self._space}
                for trial in asked
            ]
            if not first:  # the lane as it is, even where that lies outside of the ranges
                values[0] = {one.name: one.present for one in self._space}
            batch = self._batch(first, values, stored)
            for trial, made in zip(asked, batch, strict=True):
                self._tell(trial, made)
            for made in batch:
                if not made.beaten:
                    self._best = min(self._best, made.outcome.cost)
                if made.number not in stored:
                    yield made

    def _batch(
        self, first: int, values: Sequence[dict[str, float]], stored: dict[int, Trial]
    ) -> list[Trial]:
        """Make the trials of a batch."""
        numbers = [first + place for place in range(len(values)) if first + place not in stored]
        patches = {
            number: patch_of(self._tuning.lane, self._space, values[number - first])
            for number in numbers
        }

        def submit(number: int, draws: Sequence[int]) -> Future[list[list[Outcome]]]:
            variant, lane = [patches[number]], self._tuning.lane
            return self._executor.submit(outcomes, self._experiment, lane, variant, draws)

        met = race(numbers, self._draws, self._size, submit, self._is_beaten)
        made = {
            number: self._trial(number, values[number - first], patches[number], met[number])
            for number in numbers
        }
        places = range(first, first + len(values))
        return [made[number] if number in made else stored[number] for number in places]

    def _is_beaten(self, met: Sequence[Outcome]) -> bool:
        costs, count = [one.cost for one in met], len(self._draws)
        # An even cover is to tell of all trials, not of the best.
        raced = not self._several and self._tuning.sampler != "sobol"
        return raced and is_beaten(costs, count, self._tuning.judged_by, self._best)

    def _trial(
        self, number: int, values: dict[str, float], patch: dict[str, Any], met: list[Outcome]
    ) -> Trial:
        count = len(self._draws)
        return Trial(
            number=number,
            values=values,
            patch=patch,
            outcome=judged(met, count, self._tuning.judged_by),
            draws=summary(met),
            beaten=len(met) < count,
        )

    def _tell(self, trial: optuna.Trial, made: Trial) -> None:
        outcome = made.outcome
        if not self._several:
            self._study.tell(trial, outcome.cost)
            return
        failed, worst = outcome.cost >= FAILED, FAR * outcome.cost
        ratios = {
            name: worst if failed or ratio is None else ratio
            for name, ratio in outcome.ratios.items()
        }
        for name in ratios.keys() - set(self._soft):
            trial.set_constraint(name, ratios[name] - 1.0)
        self._study.tell(trial, [ratios[name] for name in self._soft])
