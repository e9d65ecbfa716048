"""How a lane does where the world is not what it was taken for: many draws, and the worst found."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.response import only_lane
from slidetune.robot.study.draws import QUANTITIES, check_ranges, placed, unit_draw, values_at
from slidetune.robot.study.outcome import Outcome, outcome_and_curves
from slidetune.robot.study.samplers import BATCH, sampler
from slidetune.robot.study.tuning import no_goal, unfounded_draws

Array = np.ndarray

TASK = 4
"""Draws that one task makes (*ours*): 50 ms of runs or more."""
MOST_CORNERS = 16
"""Corners that such a search begins with at most (*ours*)."""
KEPT = ("figures", "ratios")
"""What a draw's outcome keeps by name."""
QUANTILES = {"p5": 0.05, "median": 0.5, "p95": 0.95, "worst": 1.0}


@dataclass(frozen=True)
class Draw:
    """One draw and what came of it.

    Attributes:
        index: which draw, from 0; of a search for the worst which trial.
        share: where it lies within the range of each of ``QUANTITIES``, 0 to 1.
        values: what each uncertain quantity was, by name.
        outcome: what came of it.
        curves: how its response went; see ``curves_of``. ``None`` without a run.
    """

    index: int
    share: tuple[float, ...]
    values: dict[str, float]
    outcome: Outcome
    curves: Array | None = field(default=None, repr=False, compare=False)

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values, without the curves."""
        told = asdict(replace(self, curves=None))
        del told["curves"]
        return told


Made = tuple[Outcome, Array | None]


def at_places(
    experiment: Experiment,
    lane: str,
    places: Sequence[tuple[float, ...]],
    stop: Array | None = None,
) -> list[Made]:
    """Return outcomes and curves of a lane at places within the ranges: one task of a study.

    A pure function, so that doing it twice harms nobody.

    Args:
        experiment: whose ranges count.
        lane: which lane.
        places: see ``placed``.
        stop: once another thread has set it, the runs stop.
    """
    return [
        outcome_and_curves(placed(experiment, np.array(place)), lane, stop=stop) for place in places
    ]


def _check(experiment: Experiment, lane: str, count: int) -> None:
    experiment.lane(lane)
    if refused := unfounded_draws(experiment, max(count, 1)):
        raise InvalidExperimentError(refused)
    check_ranges(experiment)


def _draw(experiment: Experiment, index: int, place: tuple[float, ...], made: Made) -> Draw:
    return Draw(index, place, values_at(experiment.uncertainty, np.array(place)), *made)


def robustness(
    experiment: Experiment, lane: str, count: int, executor: Executor, first: int = 0
) -> Iterator[Draw]:
    """Run a lane at that many draws; yield them in their order.

    Args:
        experiment: whose ranges count.
        lane: which lane.
        count: how many draws there are.
        executor: where the runs are made.
        first: the draw to begin with; those before it are known.

    Raises:
        InvalidExperimentError: if there is no such lane, nothing is uncertain, or a range leads
            out of a field's bounds.
    """
    _check(experiment, lane, count)
    alone = only_lane(experiment, lane)
    seed = experiment.uncertainty.seed
    places = [tuple(unit_draw(seed, index).tolist()) for index in range(count)]

    def draws() -> Iterator[Draw]:
        starts = range(first, count, TASK)
        tasks = [
            executor.submit(at_places, alone, lane, places[start : start + TASK])
            for start in starts
        ]
        try:
            for start, task in zip(starts, tasks, strict=True):
                for index, made in enumerate(task.result(), start):
                    yield _draw(experiment, index, places[index], made)
        finally:
            for task in tasks:
                task.cancel()

    return draws()


def worst_case(
    experiment: Experiment,
    lane: str,
    trials: int,
    executor: Executor,
    seed: int = 1,
    known: Sequence[Draw] = (),
) -> Iterator[Draw]:
    """Search for the worst place within the uncertain ranges; yield what was tried.

    First corners of the box that the ranges are, where it often is, then by CMA-ES. The worst that
    it yields is the worst found: no proof that there is none worse.

    Args:
        experiment: whose ranges count.
        lane: which lane.
        trials: how many places are tried.
        executor: where the runs are made.
        seed: the same one gives the same places.
        known: places of an earlier search with these same arguments, from its first on; they are
            not run again.

    Raises:
        InvalidExperimentError: if there is no such lane, no goal to miss, nothing uncertain, or a
            range that leads out of a field's bounds.
    """
    _check(experiment, lane, trials)
    if not experiment.goals:
        raise InvalidExperimentError([no_goal()])
    alone, uncertain = only_lane(experiment, lane), experiment.uncertainty.uncertain
    study = optuna.create_study(direction="maximize", sampler=sampler("cmaes", seed))
    for corner in _corners(uncertain, min(MOST_CORNERS, trials // 2), seed):
        study.enqueue_trial(corner)
    ranges: dict[str, BaseDistribution] = {name: FloatDistribution(0.0, 1.0) for name in uncertain}

    def places() -> Iterator[Draw]:
        for first in range(0, trials, BATCH):
            asked = [study.ask(ranges) for _ in range(min(BATCH, trials - first))]
            chosen = [
                tuple(float(trial.params.get(name, 0.5)) for name in QUANTITIES) for trial in asked
            ]
            stored = known[first : first + len(chosen)]
            tasks = [
                executor.submit(at_places, alone, lane, [place]) for place in chosen[len(stored) :]
            ]
            try:
                new = [
                    _draw(experiment, index, chosen[index - first], task.result()[0])
                    for index, task in enumerate(tasks, first + len(stored))
                ]
            finally:
                for task in tasks:
                    task.cancel()
            for trial, one in zip(asked, [*stored, *new], strict=True):
                study.tell(trial, one.outcome.cost)
            yield from new

    return places()


def _corners(names: Sequence[str], count: int, seed: int) -> list[dict[str, float]]:
    """Return corners of a box: all of them, or as many drawn ones where there are more."""
    total = 2 ** len(names)
    if total <= count:
        chosen = np.arange(total)
    else:
        chosen = np.random.default_rng(seed).choice(total, count, replace=False)
    return [
        {name: float(number >> place & 1) for place, name in enumerate(names)}
        for number in chosen.tolist()
    ]


def quantiles(draws: Sequence[Draw]) -> dict[str, dict[str, dict[str, float | None]]]:
    """Return quantiles over the draws: of ``figures`` and of the goals' ``ratios``, by name.

    A draw that came to no end counts as worse than any: where the quantile is one, it is ``None``.
    """
    return {kind: _quantiles([getattr(one.outcome, kind) for one in draws]) for kind in KEPT}


def _quantiles(rows: Sequence[dict[str, float | None]]) -> dict[str, dict[str, float | None]]:
    found = {}
    for name in rows[0] if rows else {}:
        ends = np.sort([np.inf if row[name] is None else row[name] for row in rows])
        found[name] = {label: _at(ends, share) for label, share in QUANTILES.items()}
    return found


def _at(ordered: Array, share: float) -> float | None:
    """Return the least value that so large a share doesn't exceed."""
    value = float(ordered[max(0, int(np.ceil(share * len(ordered))) - 1)])
    return value if np.isfinite(value) else None
