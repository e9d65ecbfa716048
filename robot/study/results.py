"""What a study shows so far, as plain JSON values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.curves import bands
from slidetune.robot.study.importance import correlations, importance
from slidetune.robot.study.robustness import Draw, quantiles
from slidetune.robot.study.study import Entry, Study
from slidetune.robot.study.sweep import Axis, Point
from slidetune.robot.study.tune import Trial, best_of, pareto_front
from slidetune.robot.study.tuning import Tuning

Document = dict[str, Any]


def result_of(study: Study, entries: Sequence[Entry]) -> Document:
    """Return what some entries of a study show, its first ones.

    Of a search: the trial of the present gains, the best one, the numbers of those on the Pareto
    front and how much each gain counts. Of draws: quantiles, the shares that diverged and that kept
    the hard goals. Of a search for the worst: the worst found. Of a sweep: its axes.
    """
    if isinstance(study.wanted, Tuning):
        trials = [one for one in entries if isinstance(one, Trial)]
        return tuning_result(study.experiment, study.wanted, trials)
    draws = [one for one in entries if isinstance(one, Draw)]
    if study.kind == "robustness":
        return robustness_result(draws)
    if study.kind == "worst":
        return worst_result(draws)
    return {"axes": [{"field": one.field, "values": list(one.values)} for one in axes_of(study)]}


def tuning_result(experiment: Experiment, tuning: Tuning, trials: Sequence[Trial]) -> Document:
    """Return what a search came to."""
    best = best_of(trials)
    soft = [name for name, goal in experiment.goals.items() if goal.priority == "soft"]
    front = pareto_front(trials, soft) if len(soft) > 1 else []
    return {
        "present": trials[0].document() if trials else None,
        "best": None if best is None else best.document(),
        "front": [trial.number for trial in front],
        "importance": importance(experiment, tuning, trials),
        "correlations": correlations(experiment, tuning, trials),
    }


def robustness_result(draws: Sequence[Draw]) -> Document:
    """Return quantiles over draws, and the shares that diverged and that kept the hard goals."""
    count = max(len(draws), 1)
    return {
        "quantiles": quantiles(draws),
        "diverged": sum(one.outcome.diverged_at is not None for one in draws) / count,
        "kept": sum(one.outcome.kept for one in draws) / count,
    }


def worst_result(draws: Sequence[Draw]) -> Document:
    """Return the worst draw that was found."""
    worst = max(draws, key=lambda one: one.outcome.cost, default=None)
    return {"worst_found": None if worst is None else worst.document()}


def bands_of(study: Study, curves: Sequence[np.ndarray | None]) -> Document:
    """Return the bands that the responses of draws lie within; refused draws are left out."""
    known = [one for one in curves if one is not None]
    return {**bands(known, study.experiment.simulation.horizon), "draws": len(known)}


def table_of(entries: Sequence[Entry], axes: Sequence[Axis] = ()) -> dict[str, list[Any]]:
    """Return entries as columns: what was set, figures, ratios, cost, and when it diverged.

    Args:
        entries: of one study.
        axes: those of a sweep.
    """
    names = [one.field for one in axes]
    columns: dict[str, list[Any]] = {}
    for place, one in enumerate(entries):
        row: dict[str, Any] = {"number": place}
        if isinstance(one, Point):
            row |= dict(zip(names, one.values, strict=True))
        else:
            row |= one.values
        if isinstance(one, Trial):
            row |= {f"share {name}": one.draws[name] for name in ("diverged", "kept")}
            row |= {"draws": one.draws["draws"], "beaten": one.beaten}
        made = one.outcome
        row |= made.figures | {f"ratio of {name}": ratio for name, ratio in made.ratios.items()}
        told = ("cost", "score", "kept", "diverged_at", "refused")
        row |= {name: getattr(made, name) for name in told}
        for name, value in row.items():
            columns.setdefault(name, []).append(value)
    return columns


def axes_of(study: Study) -> list[Axis]:
    """Return the axes of a sweep; no other study has any."""
    values = getattr(study.wanted, "values", None)
    return values() if values is not None else []
