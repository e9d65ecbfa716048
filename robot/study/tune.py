"""Search for gains: something chooses them, an executor runs them, this judges.

The present gains come first, alone: all others are compared with them. Those are chosen in batches
of a fixed size and told in their order, so that a seed gives the same trials on one thread, on two,
or on a cluster.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.response import only_lane
from slidetune.robot.study.judgement import (
    ENDED,
    LOUDER,
    Present,
    is_beaten,
    judged,
    looks,
    missed,
    summary,
    weighed,
)
from slidetune.robot.study.outcome import NOMINAL, Outcome, outcomes
from slidetune.robot.study.race import draws_a_task, race
from slidetune.robot.study.samplers import BATCH, chooser
from slidetune.robot.study.search_space import Dimension, patch_of, search_space
from slidetune.robot.study.tuning import Tuning, check_tuning

FAR = 1e12
"""Ratio that counts for a goal which can't be told, times the run's cost (*ours*)."""
QUIET = "/chattering"
"""Name that the bound on chattering has beside the goals, none of which can be called so."""


@dataclass(frozen=True)
class Trial:
    """One set of gains that was tried.

    Attributes:
        number: which one, from 0; the first is the present one.
        values: what was searched, by name of the dimension.
        patch: the merge patch that makes it so.
        outcome: that of the draw which counts; its cost is what ``weighed`` tells.
        draws: how many draws it met, the share that diverged and that which kept the hard goals.
        beaten: whether it was given up before it met all draws.
        louder: whether it chatters more than it may at the draw which counts.
        hardest: of the present gains all draws, those that cost most first; of a trial that was
            given up those that cost as much as the best. The next trials meet them first.
        present: of the present gains, which are the first trial: how they do at each draw.
    """

    number: int
    values: dict[str, float]
    patch: dict[str, Any] = field(repr=False)
    outcome: Outcome
    draws: dict[str, Any]
    beaten: bool = False
    louder: bool = False
    hardest: list[int] = field(default_factory=list, repr=False)
    present: list[Present] = field(default_factory=list, repr=False)

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

    None of them chatters more than it may.

    Args:
        trials: those to choose from.
        goals: names of the goals whose ratios are compared.
    """
    able = [one for one in trials if one.outcome.kept and not (one.beaten or one.louder)]
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
    """What chooses, what was found, and which draws come first."""

    def __init__(
        self, experiment: Experiment, tuning: Tuning, space: list[Dimension], executor: Executor
    ) -> None:
        self._experiment, self._tuning, self._space = experiment, tuning, space
        self._executor, self._best = executor, float("inf")
        goals = experiment.goals
        self._soft = [name for name, goal in goals.items() if goal.priority == "soft"]
        self._several = tuning.sampler == "nsga2"
        # An even cover is to tell of all trials, not of the best.
        self._raced = not self._several and tuning.sampler != "sobol"
        self._order = list(range(tuning.draws)) or [NOMINAL]
        self._present = dict.fromkeys(self._order, Present())
        self._size = draws_a_task(experiment)
        count = len(self._soft) if self._several else 1
        self._chooser = chooser(tuning.sampler, tuning.seed, space, count)

    def trials(self, known: Sequence[Trial]) -> Iterator[Trial]:
        """Yield trial after trial, batch by batch; the first batch is the lane as it is."""
        stored, total = {trial.number: trial for trial in known}, self._tuning.trials
        for first in (0, *range(1, total, BATCH)):
            count = min(BATCH, total - first) if first else 1
            asked = self._chooser.ask(count)
            # The lane is as it is even where that lies outside of the ranges.
            values = [
                {
                    one.name: one.rounded(each[one.name]) if first else one.present
                    for one in self._space
                }
                for each in asked
            ]
            batch = self._batch(first, values, stored)
            told = [self._told(made.outcome) for made in batch]
            self._chooser.tell([costs for costs, _ in told], [excess for _, excess in told])
            for made in batch:
                self._learn(made)
                if made.number not in stored:
                    yield made

    def _learn(self, made: Trial) -> None:
        """Take what the next batch is judged by from a trial."""
        if not made.beaten:
            self._best = min(self._best, made.outcome.cost)
        hardest = dict.fromkeys(made.hardest)
        self._order = [*hardest, *(index for index in self._order if index not in hardest)]
        if made.present:
            self._present = dict(zip(sorted(self._order), made.present, strict=True))

    def _batch(
        self, first: int, values: Sequence[dict[str, float]], stored: dict[int, Trial]
    ) -> list[Trial]:
        """Make the trials of a batch."""
        numbers = [first + place for place in range(len(values)) if first + place not in stored]
        lane = self._tuning.lane
        patches = {
            number: patch_of(lane, self._space, values[number - first]) for number in numbers
        }

        def submit(number: int, draws: Sequence[int]) -> Future[list[list[Outcome]]]:
            variant = [patches[number]]
            return self._executor.submit(outcomes, self._experiment, lane, variant, draws)

        count, order = len(self._order), self._order
        asked = looks(count, self._tuning.judged_by) if self._raced else [count]
        met = race(numbers, order, asked, self._size, submit, self._is_beaten)
        made = {
            number: self._trial(number, values[number - first], patches[number], met[number])
            for number in numbers
        }
        places = range(first, first + len(values))
        return [made[number] if number in made else stored[number] for number in places]

    def _weighed(self, met: Sequence[Outcome]) -> dict[int, Outcome]:
        """Return outcomes by their draws, with the cost that counts."""
        goals = self._experiment.goals
        return {
            index: weighed(one, goals, self._present[index])
            for index, one in zip(self._order, met, strict=False)
        }

    def _is_beaten(self, met: Sequence[Outcome]) -> bool:
        costs = [one.cost for one in self._weighed(met).values()]
        return self._raced and is_beaten(
            costs, len(self._order), self._tuning.judged_by, self._best
        )

    def _trial(
        self, number: int, values: dict[str, float], patch: dict[str, Any], met: list[Outcome]
    ) -> Trial:
        count, by_draw = len(self._order), self._weighed(met)
        outcome, beaten = (
            judged(list(by_draw.values()), count, self._tuning.judged_by),
            len(met) < count,
        )
        hardest, present = list[int](), list[Present]()
        if number == 0:
            hardest = sorted(by_draw, key=lambda index: (-by_draw[index].cost, index))
            present = [self._kept(by_draw[index]) for index in sorted(by_draw)]
        elif beaten:
            hardest = [index for index, one in by_draw.items() if one.cost >= self._best]
        louder = LOUDER <= outcome.cost < ENDED
        return Trial(number, values, patch, outcome, summary(met), beaten, louder, hardest, present)

    def _kept(self, outcome: Outcome) -> Present:
        """Return what no trial may do worse than the present gains at a draw."""
        if outcome.cost >= ENDED:
            return Present()
        quiet = outcome.figures["chattering"] if self._tuning.quiet else None
        return Present(missed(outcome, self._experiment.goals, "hard"), quiet)

    def _told(self, outcome: Outcome) -> tuple[list[float], dict[str, float]]:
        """Return what is made small, and what must not be above 0."""
        if not self._several:
            return [outcome.cost], {}
        failed, worst = outcome.cost >= ENDED, FAR * outcome.cost
        ratios = {
            name: worst if failed or ratio is None else ratio
            for name, ratio in outcome.ratios.items()
        }
        excess = {name: ratios[name] - 1.0 for name in ratios.keys() - set(self._soft)}
        if self._tuning.quiet:
            excess[QUIET] = max(outcome.cost - LOUDER, 0.0)
        return [ratios[name] for name in self._soft], excess
