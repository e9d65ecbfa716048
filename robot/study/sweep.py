"""Sweeps: every combination of the values of one or two fields."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from itertools import product
from typing import Any

import numpy as np
from pydantic import Field

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.number_place import number_patch
from slidetune.robot.fields.field_path import path_parts
from slidetune.robot.fields.quantity import Integer, Number, Section
from slidetune.robot.fields.quantity import field as quantity
from slidetune.robot.knobs.knob import knobs
from slidetune.robot.loop.response import only_lane
from slidetune.robot.study.draws import merge
from slidetune.robot.study.outcome import Outcome, outcomes

TASK = 4
"""Runs of one task (*ours*): 50 ms or more."""
MOST_POINTS = 10_000
"""Most runs of a sweep (*ours*)."""
LONGEST_PATH = 200
"""Most characters of a field's path (*ours*)."""


@dataclass(frozen=True)
class Axis:
    """A field and the values that it takes.

    Attributes:
        field: a gain of the lane, or the dotted path of a number elsewhere, such as "robot.lag".
        values: what it is set to.
    """

    field: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Point:
    """One combination and what came of it.

    Attributes:
        values: of each axis, in their order.
        outcome: what came of it.
    """

    values: tuple[float, ...]
    outcome: Outcome

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return asdict(self)


class AxisRange(Section):
    """A field and the range that it is swept over."""

    field: str = Field(
        max_length=LONGEST_PATH,
        title="Field",
        description="A gain of the lane, or the path of another number, such as robot.lag.",
    )
    low: Number = quantity(
        0.0, title="From", low=-1e9, high=1e9, meaning="First value, in the field's own unit."
    )
    high: Number = quantity(
        1.0, title="To", low=-1e9, high=1e9, meaning="Last value, in the field's own unit."
    )
    count: Integer = quantity(
        20, title="Values", low=2, high=MOST_POINTS, step=1, meaning="How many, both ends included."
    )
    logarithmic: bool = Field(
        False, title="Logarithmic", description="Whether their ratio is even, not their distance."
    )

    def axis(self) -> Axis:
        """Return the values.

        Raises:
            InvalidExperimentError: if the range is empty, or logarithmic and not above 0.
        """
        return axis(self.field, self.low, self.high, self.count, self.logarithmic)


def axis(field: str, low: float, high: float, count: int, logarithmic: bool) -> Axis:
    """Return an axis of evenly spaced values, both ends included.

    Raises:
        InvalidExperimentError: if there are fewer than two, the range is empty, or a logarithmic
            one doesn't begin above 0.
    """
    if count < 2:
        raise _refusal(field, f"a sweep needs two values or more, got {count}")
    if not low < high:
        raise _refusal(field, f"a range goes from the least to the greatest, got {low:g}:{high:g}")
    if logarithmic and low <= 0.0:
        raise _refusal(field, f"a logarithmic range begins above 0, got {low:g}")
    spaced = np.geomspace(low, high, count) if logarithmic else np.linspace(low, high, count)
    return Axis(field, tuple(float(value) for value in spaced))


def sweep(
    experiment: Experiment, lane: str, axes: Sequence[Axis], executor: Executor, first: int = 0
) -> Iterator[Point]:
    """Run a lane at every combination; yield them in order, the last axis the fastest.

    Args:
        experiment: where to start from.
        lane: which lane.
        axes: fields and their values.
        executor: where the runs are made.
        first: the combination to begin with; those before it are known.

    Raises:
        InvalidExperimentError: before anything runs: for a field that isn't there, a value that it
            can't take, a field twice, or too many combinations.
    """
    experiment.lane(lane)
    names = [one.field for one in axes]
    if len(set(names)) < len(names):
        raise _refusal(names[0], f"{names[0]} is swept twice")
    if (count := int(np.prod([len(one.values) for one in axes]))) > MOST_POINTS:
        raise _refusal(names[0], f"{count:,} runs; a sweep has at most {MOST_POINTS:,}")
    for one in axes:
        for end in (one.values[0], one.values[-1]):
            experiment.patched(_patch(experiment, lane, one.field, end))
    if len(axes) == 2:
        (first_low, first_high), second = (axes[0].values[0], axes[0].values[-1]), axes[1].values[0]
        low, high = (
            combination(experiment, lane, names, (one, second)) for one in (first_low, first_high)
        )
        if low == high:
            raise _refusal(names[1], f"{names[1]} sets what {names[0]} sets: it is swept twice")
    combinations = list(product(*(one.values for one in axes)))
    patches = [combination(experiment, lane, names, values) for values in combinations]
    alone = only_lane(experiment, lane)

    def points() -> Iterator[Point]:
        starts = range(first, len(patches), TASK)
        tasks = [
            executor.submit(outcomes, alone, lane, patches[start : start + TASK])
            for start in starts
        ]
        try:
            for start, task in zip(starts, tasks, strict=True):
                for place, (made,) in enumerate(task.result(), start):
                    yield Point(combinations[place], made)
        finally:
            for task in tasks:
                task.cancel()

    return points()


def _refusal(field: str, text: str) -> InvalidExperimentError:
    return InvalidExperimentError([FieldError(field, text)])


def combination(
    experiment: Experiment, lane: str, names: Sequence[str], values: Sequence[float]
) -> dict[str, Any]:
    """Return the merge patch that sets fields to values.

    Args:
        experiment: where to start from.
        lane: whose gains the names without a dot are.
        names: of the axes, in their order.
        values: of each axis.

    Raises:
        InvalidExperimentError: for a field that isn't there or is no number.
    """
    whole: dict[str, Any] = {}
    for name, value in zip(names, values, strict=True):
        one = _patch(experiment, lane, name, value)
        if _meet(whole, one):
            # Two joints of the same field share one list.
            one = _patch(experiment.patched(whole), lane, name, value)
        merge(whole, one)
    return whole


def _meet(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Tell whether two merge patches set the same field."""
    for key in one.keys() & other.keys():
        inner = one[key], other[key]
        if not all(isinstance(value, dict) for value in inner) or _meet(*inner):
            return True
    return False


def _patch(experiment: Experiment, lane: str, name: str, value: float) -> dict[str, Any]:
    """Return the patch that sets a gain, six in proportion, or a number elsewhere."""
    parts = path_parts(name)
    if len(parts) == 1:
        found = next((one for one in knobs(experiment, lane) if one.field == name), None)
        if found is None:
            known = ", ".join(one.field for one in knobs(experiment, lane))
            raise _refusal(name, f"{lane} has no gain {name} to sweep; it has: {known}")
        return found.patch(found.at_all(value))
    if parts[0] == "lanes" and parts[1] != lane:
        raise _refusal(name, f"only {lane} is run here, not {parts[1]}: sweep one of its own gains")
    return number_patch(experiment, name, value)
