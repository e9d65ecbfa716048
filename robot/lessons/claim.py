"""What a lesson says in numbers, each of which a run can confirm or deny."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import MOST_JOINTS, Section, refusal
from slidetune.robot.kernels.workspace import NODES
from slidetune.robot.laws.terms.network import NetworkGains
from slidetune.robot.loop.figures import FIGURES, Reduction
from slidetune.robot.loop.metrics import Metrics
from slidetune.robot.loop.simulate import LaneRun, Run
from slidetune.robot.margins.margin import margin_limit, worst_margin

Array = np.ndarray

Metric = Literal[
    "mean_error",
    "max_error",
    "error_at",
    "reaching_time",
    "peak_torque",
    "chattering",
    "switches",
    "sign_changes",
    "high_frequency_torque",
    "flange_rms",
    "flange_max",
    "rms_torque",
    "sampling_margin",
    "margin_limit",
    "time_constant",
    "integral_gain",
    "network_stiffness",
    "proportional_share",
    "least_gaussian",
    "integrator_gap",
]

LOOSEST = 0.025
"""Greatest relative error of a number that a lesson quotes (*ours*)."""

Bound = Literal["about", "at_least", "at_most"]
BOUNDS: tuple[Bound, ...] = ("about", "at_least", "at_most")


class Claim(Section):
    """One number of a lesson: what a run of the step's experiment has to show."""

    name: str = Field(pattern=r"[a-z][a-z0-9_]*", description="By which texts quote it.")
    metric: Metric
    lane: str
    joint: int | None = Field(None, ge=1, le=MOST_JOINTS, description="None: all, as in a table.")
    since: float = Field(0.0, ge=0.0, description="Begin of what is measured [s].")
    at: float | None = Field(None, ge=0.0, description="Instant of ``error_at`` [s].")
    than: str = Field("", description="Another claim: this one is how many times as great.")
    about: float | None = Field(None, description="As exact as it is written.")
    at_least: float | None = None
    at_most: float | None = None

    @model_validator(mode="after")
    def _one_bound(self) -> Claim:
        given = [name for name in BOUNDS if getattr(self, name) is not None]
        if len(given) != 1:
            text = f"must have exactly one of {', '.join(BOUNDS)}, got {', '.join(given) or 'none'}"
            raise refusal("name", self.name, text)
        if (self.metric == "error_at") != (self.at is not None):
            raise refusal(
                "at", self.at, "error_at needs a time at [s], and no other metric takes one"
            )
        return self

    @property
    def bound(self) -> Bound:
        """Which of the three bounds is given."""
        return next(name for name in BOUNDS if getattr(self, name) is not None)

    @property
    def quoted(self) -> float:
        """The number as texts quote it, in ``unit``."""
        return float(getattr(self, self.bound))

    @property
    def unit(self) -> str:
        """Unit in which it is quoted, empty for none."""
        return "times" if self.than else METRICS[self.metric].unit

    def holds(self, measured: float) -> bool:
        """Whether a measured value confirms it."""
        if self.bound == "at_least":
            return measured >= self.quoted
        if self.bound == "at_most":
            return measured <= self.quoted
        exponent = Decimal(repr(self.quoted)).normalize().as_tuple().exponent
        written = 0.5 * 10.0 ** int(exponent)
        return abs(measured - self.quoted) <= min(written, LOOSEST * abs(self.quoted)) * (1 + 1e-9)


@dataclass(frozen=True)
class Look:
    """Where a metric looks: one lane of one run."""

    run: Run
    claim: Claim

    @property
    def lane(self) -> LaneRun:
        """What the lane did."""
        return self.run.lanes[self.claim.lane]

    @property
    def gains(self) -> Any:
        """The lane's section of the experiment."""
        return self.run.experiment.lanes[self.claim.lane]

    @property
    def figures(self) -> Metrics:
        """The lane's figures since ``claim.since``."""
        return self.lane.metrics_since(self.claim.since)

    def of_joint(self, values: object) -> float:
        """Return the claim's joint of one value or more; without one the metric reduces them."""
        six = np.broadcast_to(np.asarray(values, dtype=float), self.run.experiment.joints)
        if self.claim.joint is not None:
            return float(six[self.claim.joint - 1])
        greatest = METRICS[self.claim.metric].reduced == "greatest"
        return float(six.max() if greatest else six.mean())


@dataclass(frozen=True)
class LessonMetric:
    """Something that a claim can be about.

    Attributes:
        unit: unit in which it is quoted, empty for none.
        value: works it out in SI units.
        factor: from these to ``unit``.
        label: what it is called beside a live one; empty where it follows from the gains alone.
        reduced: what six joints become: their mean, their greatest, as in the tables; ``none`` of
            what belongs to a lane as a whole.
    """

    unit: str
    value: Callable[[Look], float]
    factor: float = 1.0
    label: str = ""
    reduced: Reduction = "mean"


def _figure(name: str, value: Callable[[Look], float]) -> LessonMetric:
    """Return a metric that is a figure, or worked out as another one of the same kind."""
    figure = FIGURES[name]
    return LessonMetric(figure.shown_unit, value, figure.factor, figure.label, figure.reduced)


def _of_run(name: str) -> LessonMetric:
    """Return a metric that is a figure of the run."""

    def value(look: Look) -> float:
        known = getattr(look.figures, name)
        return np.nan if known is None else look.of_joint(known)

    return _figure(name, value)


def _error_at(look: Look) -> float:
    row = int(np.searchsorted(look.run.time, (look.claim.at or 0.0) - 1e-9))
    return look.of_joint(np.abs(look.lane.e[row]))


def _reaching_time(look: Look) -> float:
    """Return when S was reached, infinite where it never was, NaN where the lane had ended."""
    if np.isnan(look.figures.mae).any():
        return np.nan
    return look.of_joint([np.inf if t is None else t for t in look.figures.reaching_time])


def _sign_changes(look: Look) -> float:
    """Return at how many of the rows S has another sign than at the one before, as a share."""
    S = look.lane.S[look.run.time >= look.claim.since]
    if not np.isfinite(S).all():
        return np.nan  # the lane ended: what came after is neither a change nor none
    positive = S > 0.0
    return look.of_joint((positive[1:] != positive[:-1]).mean(axis=0))


def _only_lane(look: Look) -> Experiment:
    name = look.claim.lane
    return look.run.experiment.model_copy(update={"lanes": {name: look.gains}})


def _sampling_margin(look: Look) -> float:
    return worst_margin(pack(_only_lane(look)), look.claim.lane)


def _gaussians(gains: NetworkGains, error: Array) -> Array:
    """Return h of every node (Eq. 19) at one error a joint. Shape (10, 6)."""
    distance = error - gains.centers()[:, None]
    return np.asarray(np.exp(-0.5 * np.square(distance / np.asarray(gains.width))))


def _least_gaussian(look: Look) -> float:
    worst = np.abs(look.lane.e).max(axis=0)
    return look.of_joint(_gaussians(look.gains, worst).min(axis=0))


def _integral_gain(gains: NetworkGains) -> Array:
    r"""Return :math:`\varphi\sum_j h_j^2`: how fast f follows S near e = 0. Shape (6,)."""
    squares = np.square(_gaussians(gains, np.zeros(1))).sum(axis=0)
    return np.asarray(np.asarray(gains.learning_rate) * squares)


def _network_stiffness(gains: Any) -> Array:
    r"""Return :math:`c\,\varphi\sum_j h_j^2`: f follows e so, as S holds c de. Shape (6,)."""
    return np.asarray(np.asarray(gains.c) * _integral_gain(gains))


def _proportional_share(look: Look) -> float:
    r"""Return how much of f is proportional to e, as a share.

    The part :math:`p = c\,\varphi\sum_j h_j^2\,(e - e(0))` is projected on f: its share and that of
    the rest add up.

    .. math:: \frac{\int p f\,dt}{\int f^2\,dt}
    """
    f, part = look.lane.f, _network_stiffness(look.gains) * (look.lane.e - look.lane.e[0])
    return look.of_joint((part * f).sum(axis=0) / np.square(f).sum(axis=0))


def _integrator_gap(look: Look) -> float:
    r"""Return how far f is from :math:`10\,\varphi\int S\,dt`, as a share of its greatest value."""
    period, S = look.run.time[1], look.lane.S
    integral = np.vstack([np.zeros_like(S[0]), np.cumsum(0.5 * period * (S[1:] + S[:-1]), axis=0)])
    gap = np.abs(look.lane.f - NODES * np.asarray(look.gains.learning_rate) * integral)
    return look.of_joint(gap.max(axis=0)) / look.of_joint(np.abs(look.lane.f).max(axis=0))


METRICS: dict[Metric, LessonMetric] = {
    "mean_error": _of_run("mae"),
    "max_error": _of_run("max_error"),
    "error_at": replace(_figure("mae", _error_at), label="|e|"),
    "reaching_time": _figure("reaching_time", _reaching_time),
    "peak_torque": _of_run("peak_torque"),
    "chattering": _of_run("chattering"),
    "switches": _of_run("switches"),
    "sign_changes": LessonMetric("%", _sign_changes, 100.0, "sign changes of S"),
    "high_frequency_torque": _of_run("high_frequency_torque"),
    "flange_rms": _of_run("flange_rms"),
    "flange_max": _of_run("flange_max"),
    "rms_torque": _of_run("rms_torque"),
    "sampling_margin": _figure("gamma", _sampling_margin),
    "margin_limit": _figure(
        "gamma_limit", lambda look: margin_limit(look.run.experiment.simulation)
    ),
    "time_constant": LessonMetric(
        "s", lambda look: look.of_joint(np.divide(look.gains.c, look.gains.nu))
    ),
    "integral_gain": LessonMetric(
        "N·m/rad", lambda look: look.of_joint(_integral_gain(look.gains))
    ),
    "network_stiffness": LessonMetric(
        "N·m/rad", lambda look: look.of_joint(_network_stiffness(look.gains))
    ),
    "proportional_share": LessonMetric("%", _proportional_share, 100.0),
    "least_gaussian": LessonMetric("", _least_gaussian),
    "integrator_gap": LessonMetric("%", _integrator_gap, 100.0),
}
"""What a claim can be about, by name."""


def measured(claim: Claim, run: Run) -> float:
    """Return what a run shows for a claim, in the metric's unit, before any ``than``."""
    metric = METRICS[claim.metric]
    return metric.factor * metric.value(Look(run, claim))
