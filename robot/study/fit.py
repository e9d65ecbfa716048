"""Fit numbers of an experiment to published figures: which unknown constants come closest to them.

That they come close proves nothing by itself: with as many numbers as data anything can be met.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import optuna
from optuna.distributions import BaseDistribution, FloatDistribution
from pydantic import Field, model_validator

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import LONGEST_LANE_NAME, Experiment
from slidetune.robot.experiment.number_place import number_at, number_patch
from slidetune.robot.fields.quantity import JOINTS, Integer, Number, Section, refusal
from slidetune.robot.fields.quantity import field as quantity
from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.study.draws import merge
from slidetune.robot.study.samplers import BATCH, sampler
from slidetune.robot.study.tuning import MOST_TRIALS

Array = np.ndarray

FITTED = tuple(
    name for name, one in FIGURES.items() if one.source == "run" and name != "diverged_at"
)
"""Figures that can be fitted: those of runs that come to their end."""
UNMET = 10.0
"""Deviation that counts for a figure which a run can't tell, in powers of e (*ours*)."""


class FittedRange(Section):
    """Between which values a number is fitted."""

    low: Number = quantity(
        0.0, title="From", low=-1e9, high=1e9, meaning="Least value, in the field's own unit."
    )
    high: Number = quantity(
        1.0, title="To", low=-1e9, high=1e9, meaning="Greatest value, in the field's own unit."
    )
    logarithmic: bool = Field(False, description="Whether ratios count, not differences.")

    @model_validator(mode="after")
    def _is_not_empty(self) -> FittedRange:
        if self.low >= self.high or (self.logarithmic and self.low <= 0.0):
            least = "0 < low < high" if self.logarithmic else "low < high"
            text = f"a range must have {least}, got {self.low:g} to {self.high:g}"
            raise refusal("high", self.high, text)
        return self


class Target(Section):
    """A figure as it was published."""

    lane: str = Field(max_length=LONGEST_LANE_NAME, description="Whose figure it is.")
    figure: str = Field("mae", description="Name of a figure of a run.")
    joint: Integer = quantity(
        0, title="Joint", low=0, high=JOINTS, step=1, meaning="0: the number in the table."
    )
    since: Number = quantity(
        0.0, title="Since", unit="s", low=0.0, high=120.0, step=0.1, meaning="From when it counts."
    )
    value: Number = quantity(
        1.0, title="Value", low=1e-12, high=1e12, meaning="As published, in the SI unit."
    )


class Fitting(Section):
    """What is fitted, and to what."""

    fields: dict[str, FittedRange] = Field(
        min_length=1, max_length=24, description="Numbers by path, and their ranges."
    )
    targets: list[Target] = Field(min_length=1, max_length=200, description="Published figures.")
    trials: Integer = quantity(
        400, title="Trials", low=1, high=MOST_TRIALS, step=10, meaning="How many are tried."
    )
    seed: Integer = quantity(
        1, title="Seed", low=0, high=2**31 - 1, step=1, meaning="The same one, the same trials."
    )

    @property
    def spare(self) -> int:
        """How many more data there are than numbers that are fitted."""
        return len(self.targets) - len(self.fields)


@dataclass(frozen=True)
class FitTrial:
    """One set of numbers that was tried.

    Attributes:
        number: which one, from 0; the first is the experiment as it is.
        values: by path.
        patch: the merge patch that makes it so.
        figures: of each target, ``None`` where the run can't tell it.
        deviation: root mean square of the figures' logarithmic deviations: 0.1 is about 10 %.
    """

    number: int
    values: dict[str, float]
    patch: dict[str, Any] = field(repr=False)
    figures: list[float | None]
    deviation: float

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return asdict(self)


def fit(experiment: Experiment, fitting: Fitting, executor: Executor) -> Iterator[FitTrial]:
    r"""Search for the numbers whose figures come closest to the targets; yield every trial.

    .. math:: \sqrt{\frac{1}{n} \sum_i \ln^2 (x_i / x_i^*)}

    is made small by CMA-ES, in batches that are told in order: a seed gives the same trials on
    however many cores.

    Raises:
        InvalidExperimentError: before anything runs, naming every refused field.
    """
    _check(experiment, fitting)
    present = {name: number_at(experiment, name) for name in fitting.fields}
    start = {n: min(max(present[n], one.low), one.high) for n, one in fitting.fields.items()}
    study = optuna.create_study(sampler=sampler("cmaes", fitting.seed))
    study.enqueue_trial(start)
    ranges: dict[str, BaseDistribution] = {
        name: FloatDistribution(one.low, one.high, log=one.logarithmic)
        for name, one in fitting.fields.items()
    }

    def trials() -> Iterator[FitTrial]:
        for first in range(0, fitting.trials, BATCH):
            asked = [study.ask(ranges) for _ in range(min(BATCH, fitting.trials - first))]
            values = [
                {name: float(f"{trial.params[name]:.4g}") for name in fitting.fields}
                for trial in asked
            ]
            if not first:
                values[0] = present
            patches = [_patch(experiment, one) for one in values]
            if not first:
                patches[0] = {}  # of six numbers, present only tells the first
            tasks = [executor.submit(figures_of, experiment, one, fitting) for one in patches]
            try:
                found = [task.result() for task in tasks]
            finally:
                for task in tasks:
                    task.cancel()
            made = [
                FitTrial(
                    first + place,
                    values[place],
                    patches[place],
                    figures,
                    _deviation(figures, fitting.targets),
                )
                for place, figures in enumerate(found)
            ]
            for trial, one in zip(asked, made, strict=True):
                study.tell(trial, one.deviation)
            yield from made

    return trials()


def figures_of(
    experiment: Experiment, patch: Mapping[str, Any], fitting: Fitting, stop: Array | None = None
) -> list[float | None]:
    """Return the figures of all targets of one variant: one task of a fit.

    Args:
        experiment: where to start from.
        patch: the variant.
        fitting: whose targets.
        stop: once another thread has set it, the run stops.
    """
    try:
        variant = experiment.patched(patch)
        lanes = simulate(variant, stop=stop, estimate=False).lanes
    except InvalidExperimentError:
        return [None] * len(fitting.targets)
    found: list[float | None] = []
    metrics = {
        (one.lane, one.since): lanes[one.lane].metrics_since(one.since) for one in fitting.targets
    }
    for one in fitting.targets:
        value = getattr(metrics[one.lane, one.since], one.figure)
        if lanes[one.lane].freeze is not None:
            found.append(None)
            continue
        figure = FIGURES[one.figure]
        number = value[one.joint - 1] if one.joint else figure.overall(value)
        found.append(None if number is None or not np.isfinite(number) else float(number))
    return found


def _deviation(figures: Sequence[float | None], targets: Sequence[Target]) -> float:
    logarithms = [
        UNMET if not value else float(np.log(value / one.value))
        for value, one in zip(figures, targets, strict=True)
    ]
    return float(np.sqrt(np.mean(np.square(logarithms))))


def _patch(experiment: Experiment, values: Mapping[str, float]) -> dict[str, Any]:
    patch: dict[str, Any] = {}
    changed = experiment
    for name, value in values.items():
        # One after the other: two joints of the same field share one list.
        one = number_patch(changed, name, value)
        merge(patch, one)
        changed = changed.patched(one)
    return patch


def _check(experiment: Experiment, fitting: Fitting) -> None:
    refused = []
    for place, one in enumerate(fitting.targets):
        path = f"targets.{place}"
        if one.lane not in experiment.lanes:
            known = ", ".join(experiment.lanes)
            text = f"no lane is named {one.lane}; there are: {known}"
            refused.append(FieldError(f"{path}.lane", text, one.lane))
        if one.figure not in FITTED:
            known = ", ".join(FITTED)
            text = f"{one.figure} is no figure of a run; there are: {known}"
            refused.append(FieldError(f"{path}.figure", text, one.figure))
        elif one.joint and not FIGURES[one.figure].per_joint:
            text = f"joint must be 0, got {one.joint}: {one.figure} is one number"
            refused.append(FieldError(f"{path}.joint", text, one.joint))
    if refused:
        raise InvalidExperimentError(refused)
    for end in ("low", "high"):
        ends = {name: float(getattr(one, end)) for name, one in fitting.fields.items()}
        experiment.patched(_patch(experiment, ends))
