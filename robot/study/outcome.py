"""What a study keeps of one run: how it kept to its goals, and its figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.figures import FIGURES, STUDIED
from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.loop.verdict import judge_goals
from slidetune.robot.study.curves import curves_of
from slidetune.robot.study.draws import drawn

Array = np.ndarray

FAILED = 2.0
"""Cost from which on a run left its bounds or was refused (*ours*)."""
SPECTRAL = "high_frequency_torque"
"""Figure that takes a tenth of the time of a run; no study tells it but for a goal."""
NOMINAL = -1
"""Index of the experiment as it is, of which nothing is drawn."""


@dataclass(frozen=True)
class Outcome:
    """One run, summed up.

    Attributes:
        cost: what a search makes small; see ``cost_of``.
        score: largest ratio of the goals that count; see ``Verdict``.
        kept: whether every hard goal held.
        ratios: of each goal, by name.
        figures: the figures of ``STUDIED`` by name.
        diverged_at: when it left its bounds in [s], or ``None``.
        refused: why there was no run, or an empty text.
    """

    cost: float
    score: float | None
    kept: bool
    ratios: dict[str, float | None]
    figures: dict[str, float | None]
    diverged_at: float | None = None
    refused: str = ""

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return asdict(self)


def cost_of(hard: float, soft: float, anything_soft: bool) -> float:
    r"""Return what a search makes small: first the hard goals, then the soft ones.

    .. math:: \frac{s}{1 + s} \text{ where all hard goals hold, else } 1 + \frac{h}{1 + h}

    Order is all that counts, so that it has bounds: it is below 1 where the hard goals hold, and
    below ``FAILED`` where a run came to its end.

    Args:
        hard: largest hard ratio, 0 without one.
        soft: largest soft ratio, 0 without one.
        anything_soft: whether there is a soft goal; without one the hard ones are made small.
    """
    if hard > 1.0:
        return 1.0 + hard / (1.0 + hard)
    smaller = soft if anything_soft else hard
    return smaller / (1.0 + smaller)


def outcome(
    experiment: Experiment, lane: str, index: int = NOMINAL, stop: Array | None = None
) -> Outcome:
    """Run one lane of one draw, without an estimate of its error.

    Args:
        experiment: what to run.
        lane: which lane.
        index: which draw, from 0, or ``NOMINAL``.
        stop: once another thread has set it, the run stops; see ``simulate``.

    Raises:
        CancelledError: if ``stop`` was set.
    """
    made = _run(experiment, lane, index, stop)
    return made if isinstance(made, Outcome) else _judged(experiment, made)


def outcome_and_curves(
    experiment: Experiment, lane: str, stop: Array | None = None
) -> tuple[Outcome, Array | None]:
    """Run one lane; return its curves too, ``None`` where the run was refused.

    Raises:
        CancelledError: if ``stop`` was set.
    """
    made = _run(experiment, lane, NOMINAL, stop)
    if isinstance(made, Outcome):
        return made, None
    return _judged(experiment, made), curves_of(made)


def _run(experiment: Experiment, lane: str, index: int, stop: Array | None) -> LaneRun | Outcome:
    """Return a run, or what is told of one that was refused."""
    try:
        variant = only_lane(experiment, lane)
        variant = variant if index == NOMINAL else drawn(variant, index)
        return simulate(variant, stop=stop, estimate=False).lanes[lane]
    except InvalidExperimentError as error:
        return _refused(experiment, error)


def _refused(experiment: Experiment, error: InvalidExperimentError) -> Outcome:
    ratios: dict[str, float | None] = dict.fromkeys(experiment.goals)
    return Outcome(FAILED + 1.0, None, False, ratios, dict.fromkeys(STUDIED), None, str(error))


def _judged(experiment: Experiment, run: LaneRun) -> Outcome:
    goals = experiment.goals
    if run.freeze is not None:
        # The later the better, so that a search finds its way out.
        lasted = min(run.freeze.time / experiment.simulation.horizon, 1.0)
        cost, when = FAILED + 1.0 - lasted, run.freeze.time
        return Outcome(cost, None, False, dict.fromkeys(goals), dict.fromkeys(STUDIED), when)
    if not any(getattr(goal, "figure", "") == SPECTRAL for goal in goals.values()):
        run = replace(run, high_frequency=np.inf)  # above which there is no spectrum to take
    metrics = run.metrics
    verdict = judge_goals(goals, run, metrics)
    figures = {name: FIGURES[name].overall(getattr(metrics, name)) for name in STUDIED}
    if verdict.hard is None or verdict.soft is None:
        return Outcome(FAILED, None, False, verdict.ratios, figures)
    soft = any(goal.priority == "soft" for goal in goals.values())
    cost = cost_of(verdict.hard, verdict.soft, soft)
    return Outcome(cost, verdict.score, verdict.kept, verdict.ratios, figures)


def outcomes(
    experiment: Experiment,
    lane: str,
    patches: Sequence[Mapping[str, Any]],
    draws: Sequence[int] = (NOMINAL,),
    stop: Array | None = None,
) -> list[list[Outcome]]:
    """Return the outcomes of several variants at several draws: one task of a study.

    A pure function, so that doing it twice harms nobody. All variants meet the same draws.

    Args:
        experiment: where to start from.
        lane: which lane.
        patches: the variants; see ``Experiment.patched``.
        draws: indices of draws.
        stop: once another thread has set it, the runs stop.

    Returns:
        One list a variant, with one outcome a draw.
    """
    found = []
    for patch in patches:
        try:
            variant = experiment.patched(patch)
        except InvalidExperimentError as error:
            found.append([_refused(experiment, error)] * len(draws))
            continue
        found.append([outcome(variant, lane, index, stop) for index in draws])
    return found
