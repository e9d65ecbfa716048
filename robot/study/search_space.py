"""The numbers that a search turns, and the patch that a choice of them is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import log
from typing import Any

import numpy as np

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.field_path import field_path
from slidetune.robot.knobs.knob import Knob, knobs
from slidetune.robot.study.tuning import GainRange, Tuning

WIDTH = 10.0
"""From a tenth of its value to ten times a gain is searched where no range is given (*ours*)."""
_DECADE = 10.0
"""A range that spans as much is searched logarithmically (*ours*)."""


@dataclass(frozen=True)
class Dimension:
    """One number that is searched.

    Attributes:
        name: of the gain, with the joint in brackets where it is one joint's.
        knob: the gain.
        joint: whose share it is, from 1, or 0 for all in proportion.
        low: least value.
        high: greatest value.
        logarithmic: whether it is searched on a logarithmic scale.
        present: its present value, which may lie outside of the range.
    """

    name: str
    knob: Knob
    joint: int
    low: float
    high: float
    logarithmic: bool
    present: float

    @property
    def begin(self) -> float:
        """The present value, held within the range: where a search begins."""
        return min(max(self.present, self.low), self.high)

    def share(self, value: float) -> float:
        """Return where a value within the range lies, 0 at its low end, 1 at its high end."""
        if self.logarithmic:
            return log(value / self.low) / log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def at(self, share: float) -> float:
        """Return the value that lies there, 0 at the low end, 1 at the high end."""
        if self.logarithmic:
            return float(self.low * (self.high / self.low) ** share)
        return self.low + (self.high - self.low) * share

    def rounded(self, value: float) -> float:
        """Return a value of four digits within the range; the present one stays as it is."""
        if value == self.present:
            return value
        return min(max(_legible(value), self.low), self.high)


def search_space(experiment: Experiment, tuning: Tuning) -> list[Dimension]:
    """Return what a search turns.

    Raises:
        InvalidExperimentError: for a gain that isn't there or has no effect, or a range outside of
            its bounds.
    """
    known = {knob.field: knob for knob in knobs(experiment, tuning.lane)}
    acting = {name for name in known if _acts(experiment, tuning.lane, name)}
    if not tuning.gains:
        ranges = {name: _usual_range(known[name]) for name in known if name in acting}
    else:
        _check(tuning, known, acting)
        ranges = dict(tuning.gains)
    return [one for name, wanted in ranges.items() for one in _dimensions(known[name], wanted)]


def patch_of(lane: str, space: list[Dimension], values: Mapping[str, float]) -> dict[str, Any]:
    """Return the merge patch that sets every dimension to its value."""
    gains: dict[str, Any] = {}
    for one in space:
        value = values[one.name]
        if one.joint:
            gains.setdefault(one.knob.field, one.knob.shares())[one.joint - 1] = value
        elif value != one.present:
            turned = np.asarray(one.knob.at_all(value))
            each = [_legible(share) for share in turned.ravel().tolist()]
            gains[one.knob.field] = each if turned.ndim else each[0]
    return {"lanes": {lane: gains}}


def _legible(value: float) -> float:
    """Return a number of four digits, which is what is run, shown and written."""
    return float(f"{value:.4g}")


def _acts(experiment: Experiment, lane: str, name: str) -> bool:
    """Tell whether a gain has an effect under the lane's present choices."""
    gains: Any = experiment.lanes[lane]
    extra = type(gains).model_fields[name].json_schema_extra
    needs = extra.get("needs", {}) if isinstance(extra, dict) else {}
    weight = extra.get("weight") if isinstance(extra, dict) else None
    chosen = all(getattr(gains, key) in options for key, options in needs.items())
    return chosen and (weight is None or bool(np.any(getattr(gains, weight["name"]))))


def _usual_range(knob: Knob) -> GainRange:
    present = float(np.max(np.abs(knob.value)))
    if present == 0.0:
        return GainRange(low=knob.low, high=knob.high)
    return GainRange(low=max(knob.low, present / WIDTH), high=min(knob.high, present * WIDTH))


def _check(tuning: Tuning, known: Mapping[str, Knob], acting: set[str]) -> None:
    refused = []
    for name, wanted in tuning.gains.items():
        path = field_path(("gains", name))
        if name not in known:
            text = f"{tuning.lane} has no gain {name} to search; it has: {', '.join(known)}"
            refused.append(FieldError(path, text, name))
            continue
        knob = known[name]
        if name not in acting:
            text = f"{name} has no effect under the present choices of {tuning.lane}"
            refused.append(FieldError(path, text, name))
        if wanted.low < knob.low or wanted.high > knob.high:
            text = f"must lie in [{knob.low:g}, {knob.high:g}], got {wanted.low:g} to"
            refused.append(FieldError(path, f"the range of {name} {text} {wanted.high:g}"))
        if wanted.joints == "each" and not knob.per_joint:
            text = f"{name} is one number for all joints: it can't be searched for each"
            refused.append(FieldError(f"{path}.joints", text, wanted.joints))
    if refused:
        raise InvalidExperimentError(refused)


def _dimensions(knob: Knob, wanted: GainRange) -> list[Dimension]:
    spans = wanted.low > 0.0 and wanted.high >= _DECADE * wanted.low
    logarithmic = spans or (knob.logarithmic and wanted.low > 0.0)
    each = knob.shares()

    def dimension(name: str, joint: int, present: float) -> Dimension:
        return Dimension(name, knob, joint, wanted.low, wanted.high, logarithmic, present)

    if wanted.joints == "alike":
        return [dimension(knob.field, 0, float(max(each, key=abs)))]
    return [
        dimension(f"{knob.field}[{joint}]", joint, share) for joint, share in enumerate(each, 1)
    ]
