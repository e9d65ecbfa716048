"""The knobs of a lane: which fields a number can be tuned on, and the values worth trying."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment

Array = np.ndarray

COUNT = 20
"""Positions along a slider's track (*ours*)."""


@dataclass(frozen=True)
class Knob:
    """A number of a lane that can be tuned.

    Attributes:
        lane: the lane.
        field: name of the gain.
        value: its present value, a number or one a joint.
        low: least permitted value.
        high: greatest permitted value.
        logarithmic: whether its slider runs logarithmically.
        per_joint: whether every joint may have its own share.
        joints: how many joints the arm has.
    """

    lane: str
    field: str
    value: float | tuple[float, ...]
    low: float
    high: float
    logarithmic: bool
    per_joint: bool
    joints: int

    def patch(self, value: float | list[float]) -> dict[str, Any]:
        """Return the merge patch that sets the knob."""
        return {"lanes": {self.lane: {self.field: value}}}

    def at_joint(self, joint: int, value: float) -> list[float]:
        """Return the value with one joint's share, counted from 1, replaced.

        Raises:
            InvalidExperimentError: if the knob is one number for all, or there is no such joint.
        """
        if not self.per_joint:
            text = f"{self.field} is one number for all joints; leave out joint"
            raise InvalidExperimentError([FieldError("joint", text, joint)])
        if joint > self.joints:
            text = f"joint must be 1 to {self.joints}, got {joint}"
            raise InvalidExperimentError([FieldError("joint", text, joint)])
        each = self.shares()
        each[joint - 1] = value
        return each

    def shares(self) -> list[float]:
        """Return the value of every joint."""
        each = np.broadcast_to(np.asarray(self.value, dtype=float), self.joints)
        return [float(share) for share in each]

    def at_all(self, value: float) -> float | list[float]:
        """Return the value with the greatest share set to this and the others in proportion.

        One number for all joints is just replaced; so are shares that are all 0.
        """
        if not isinstance(self.value, tuple):
            return value
        greatest = max(self.value, key=abs)
        return self.scaled(value / greatest) if greatest else value

    def positions(self, count: int = COUNT) -> Array:
        """Return values along the slider's track, both ends included. Shape (count,)."""
        if self.logarithmic:
            return np.geomspace(self.low, self.high, count)
        return np.linspace(self.low, self.high, count)

    def scaled(self, factor: float) -> float | list[float]:
        """Return the value times a factor, held within the bounds."""
        scaled = np.clip(np.asarray(self.value) * factor, self.low, self.high)
        return scaled.tolist() if scaled.ndim else float(scaled)


def knobs(experiment: Experiment, lane: str) -> list[Knob]:
    """Return the knobs of one lane in the order of its fields.

    Odd whole numbers (p, k) are left out: they are chosen, not tuned.

    Raises:
        InvalidExperimentError: if there is no such lane.
    """
    gains: Any = experiment.lane(lane)
    found = []
    for name, info in type(gains).model_fields.items():
        extra = info.json_schema_extra
        if not isinstance(extra, dict) or "minimum" not in extra or extra.get("odd"):
            continue
        low, high = float(extra["minimum"]), float(extra["maximum"])
        logarithmic = extra.get("scale") == "log"
        # The type of a share for every joint is a union: one number, or one a joint.
        per_joint = bool(get_args(info.annotation))
        value, joints = getattr(gains, name), experiment.joints
        found.append(Knob(lane, name, value, low, high, logarithmic, per_joint, joints))
    return found


def knob(experiment: Experiment, lane: str, field: str) -> Knob:
    """Return one knob of a lane.

    Raises:
        InvalidExperimentError: if there is no such lane or knob; lists the known ones.
    """
    found = knobs(experiment, lane)
    for candidate in found:
        if candidate.field == field:
            return candidate
    known = ", ".join(candidate.field for candidate in found)
    text = f"{lane} has no gain {field}; it has: {known}"
    raise InvalidExperimentError([FieldError("field", text, field)])
