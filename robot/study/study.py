"""One study, of whatever kind: what it is told, its entries in their order, and what they show."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from math import prod
from typing import Any, Literal

import msgspec
import numpy as np
from pydantic import Field, ValidationError

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import LONGEST_LANE_NAME, Experiment
from slidetune.robot.fields.quantity import Integer, Section, field
from slidetune.robot.fields.refusal import field_errors
from slidetune.robot.study.draws import placed
from slidetune.robot.study.robustness import Draw, robustness, worst_case
from slidetune.robot.study.sweep import Axis, AxisRange, Point, combination, sweep
from slidetune.robot.study.tune import Trial, tune
from slidetune.robot.study.tuning import MOST_DRAWS, MOST_TRIALS, Tuning, told

Kind = Literal["tune", "robustness", "worst", "sweep"]
Entry = Trial | Draw | Point


class _OfLane(Section):
    lane: str = Field(
        max_length=LONGEST_LANE_NAME, title="Lane", description="Lane that is studied."
    )


class Robustness(_OfLane):
    """How a lane does over what is not known exactly."""

    draws: Integer = field(
        200,
        title="Draws",
        low=1,
        high=MOST_DRAWS,
        step=10,
        meaning="How many draws of what is uncertain are run.",
    )


class WorstCase(_OfLane):
    """A search for the draw that a lane does worst at."""

    trials: Integer = field(
        100,
        title="Tries",
        low=1,
        high=MOST_TRIALS,
        step=10,
        meaning="How many places within the ranges are tried: corners first, then by CMA-ES.",
    )
    seed: Integer = field(
        1, title="Seed", low=0, high=2**31 - 1, step=1, meaning="The same one, the same places."
    )


class Sweep(_OfLane):
    """Every combination of the values of one or two fields."""

    axes: list[AxisRange] = Field(
        min_length=1, max_length=2, title="Axes", description="One field or two, and their values."
    )

    def values(self) -> list[Axis]:
        """Return the axes with their values.

        Raises:
            InvalidExperimentError: for a range that is empty, or logarithmic and not above 0.
        """
        return [one.axis() for one in self.axes]


KINDS: dict[str, type[Section]] = {
    "tune": Tuning,
    "robustness": Robustness,
    "worst": WorstCase,
    "sweep": Sweep,
}
"""What a study of each kind is told."""


@dataclass(frozen=True)
class Study:
    """A study that can be run, and gone on with.

    Attributes:
        kind: which.
        experiment: whose lane it is.
        wanted: what it is told.
    """

    kind: Kind
    experiment: Experiment
    wanted: Tuning | Robustness | WorstCase | Sweep

    @classmethod
    def from_document(cls, kind: Kind, experiment: Experiment, wanted: Mapping[str, Any]) -> Study:
        """Return a study from plain values.

        Raises:
            InvalidExperimentError: naming every refused field.
        """
        model = KINDS[kind]
        first = {"lane": next(iter(experiment.lanes))}
        whole = told(experiment, wanted) if kind == "tune" else {**first, **wanted}
        try:
            valid: Any = model.model_validate(whole)
        except ValidationError as error:
            raise InvalidExperimentError(field_errors(error, model)) from error
        return cls(kind, experiment, valid)

    @property
    def lane(self) -> str:
        """Name of its lane."""
        return self.wanted.lane

    @property
    def total(self) -> int:
        """How many entries it has once it is done."""
        if isinstance(self.wanted, Sweep):
            return prod(one.count for one in self.wanted.axes)
        if isinstance(self.wanted, Robustness):
            return self.wanted.draws
        return self.wanted.trials

    def entries(self, executor: Executor, known: Sequence[Entry] = ()) -> Iterator[Entry]:
        """Yield what comes of it, in order.

        Args:
            executor: where the runs are made.
            known: its first entries, from an earlier time; they are not made again.

        Raises:
            InvalidExperimentError: before anything runs.
        """
        wanted, lane = self.wanted, self.lane
        if isinstance(wanted, Tuning):
            return tune(self.experiment, wanted, executor, [_trial(one) for one in known])
        if isinstance(wanted, Robustness):
            return robustness(self.experiment, lane, wanted.draws, executor, len(known))
        if isinstance(wanted, WorstCase):
            places = [one for one in known if isinstance(one, Draw)]
            trials, seed = wanted.trials, wanted.seed
            return worst_case(self.experiment, lane, trials, executor, seed, places)
        return sweep(self.experiment, lane, wanted.values(), executor, len(known))

    def check(self) -> None:
        """Refuse it before anything runs, if it can't come to anything.

        Raises:
            InvalidExperimentError: naming what is wrong.
        """
        self.entries(_NoExecutor())

    def variant(self, entry: Entry) -> Experiment:
        """Return the experiment that an entry is of; all its other lanes stay as they are.

        Of a search over draws that is the gains alone, not the draw that counted.

        Raises:
            InvalidExperimentError: if it was refused when it was tried.
        """
        if isinstance(entry, Trial):
            return self.experiment.patched(entry.patch)
        if isinstance(entry, Draw):
            return placed(self.experiment, np.array(entry.share))
        assert isinstance(self.wanted, Sweep)
        names = [one.field for one in self.wanted.axes]
        return self.experiment.patched(combination(self.experiment, self.lane, names, entry.values))

    def read(self, texts: Iterable[str]) -> list[Entry]:
        """Return entries from the JSON of what their ``document`` returned.

        Raises:
            msgspec.DecodeError: if one is none of this kind of study.
        """
        model: Any = {"tune": Trial, "sweep": Point}.get(self.kind, Draw)
        read = msgspec.json.Decoder(model).decode
        return [read(text) for text in texts]


def _trial(entry: Entry) -> Trial:
    assert isinstance(entry, Trial)
    return entry


class _NoExecutor(Executor):
    """Runs nothing."""
