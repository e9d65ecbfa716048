"""The figures that a step quotes, in a form that can be measured beside them while it runs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.lessons.claim import METRICS, Bound, Claim, Metric
from slidetune.robot.lessons.lesson import LoadedLesson
from slidetune.robot.loop.figures import Reduction
from slidetune.robot.loop.response import only_lane

QUOTED = re.compile(r"\{([a-z][a-z0-9_]*)\}")
_OF_JOINTS: dict[Reduction, str] = {
    "mean": ", mean of the joints",
    "greatest": ", greatest of the joints",
    "none": "",
}
_BEFORE: dict[Bound, str] = {"about": "", "at_least": "> ", "at_most": "< "}


@dataclass(frozen=True)
class Figure:
    """One quoted figure, and how to measure it in the live session.

    Attributes:
        label: what it is, such as ``chattering of tanh``.
        window: over which time, such as ``1 to 10 s``; empty where it belongs to no time.
        quoted: the number as texts quote it, without its unit.
        unit: of the number, and in which what is measured is shown.
        factor: from SI units to that.
        metric: what is measured.
        lane: where.
        joint: 1 to 6, ``None`` for all of them.
        reduced: what all of them become: ``mean``, ``greatest``, ``none`` of what has no joint.
        since: begin of the window in [s].
        until: its end in [s].
        at: the instant of ``error_at`` in [s].
        layer: within which S counts as reached in [rad/s], by joint.
        high_frequency: above which torque counts as chattering in [Hz].
    """

    label: str
    window: str
    quoted: str
    unit: str
    factor: float
    metric: Metric
    lane: str
    joint: int | None
    reduced: Reduction
    since: float
    until: float
    at: float | None
    layer: tuple[float, ...]
    high_frequency: float


def figures(loaded: LoadedLesson, texts: str, index: int) -> list[Figure]:
    """Return the figures that texts quote and that a step's experiment shows.

    A figure of an earlier step counts as long as its lane runs as it did there.

    Args:
        loaded: the lesson.
        texts: with placeholders.
        index: the step whose experiment is live, from 0.
    """
    quoted = dict.fromkeys(QUOTED.findall(texts))
    claims = {claim.name: (claim, step) for claim, step in _claims(loaded)}
    found = [claims[name] for name in quoted if name in claims]
    return [
        _figure(claim, loaded.experiments[step], loaded.lesson.steps[step].seconds)
        for claim, step in found
        if METRICS[claim.metric].label
        and not claim.than
        and _alike(loaded.experiments[step], loaded.experiments[index], claim.lane)
    ]


def _claims(loaded: LoadedLesson) -> Iterator[tuple[Claim, int]]:
    for index, step in enumerate(loaded.lesson.steps):
        yield from ((claim, index) for claim in step.claims)


def _alike(one: Experiment, other: Experiment, lane: str) -> bool:
    if lane not in other.lanes:
        return False
    documents: list[Mapping[str, object]] = [
        only_lane(each, lane).document() for each in (one, other)
    ]
    told = {"title", "description"}
    return all(
        documents[0][name] == documents[1][name] for name in documents[0] if name not in told
    )


def _figure(claim: Claim, experiment: Experiment, seconds: float | None) -> Figure:
    metric = METRICS[claim.metric]
    until = seconds or experiment.simulation.horizon
    whose = f"{metric.label} of {claim.lane}"
    if metric.reduced != "none":
        joint = claim.joint
        whose += _OF_JOINTS[metric.reduced] if joint is None else f", joint {joint}"
    if claim.metric in ("sampling_margin", "margin_limit"):
        window = ""
    elif claim.at is not None:
        window = f"at {claim.at:g} s"
    else:
        window = f"{claim.since:g} to {until:g} s"
    layer = getattr(experiment.lanes[claim.lane], "layer", 0.0)
    number = f"{claim.quoted:,.10g}" if claim.quoted >= 10_000 else f"{claim.quoted:.10g}"
    return Figure(
        label=whose,
        window=window,
        quoted=_BEFORE[claim.bound] + number,
        unit=metric.unit,
        factor=metric.factor,
        metric=claim.metric,
        lane=claim.lane,
        joint=claim.joint,
        reduced=metric.reduced,
        since=claim.since,
        until=until,
        at=claim.at,
        layer=tuple(np.broadcast_to(np.asarray(layer, dtype=float), experiment.joints).tolist()),
        high_frequency=experiment.simulation.high_frequency,
    )
