"""What a study tries: the trials of a strip, of a sensitivity chart, of a smoothing curve."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any, get_args

import numpy as np

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.knobs.knob import COUNT, knob, knobs

EPSILONS = np.geomspace(1e-3, 1.0, 13)
"""Boundary layers of an accuracy-chattering curve in [rad/s] (*ours*)."""


@dataclass(frozen=True)
class Trial:
    """One run of a study.

    Attributes:
        name: the field that it changes.
        value: the value that it sets.
        patch: the merge patch.
        factor: by how much the field was multiplied, where that is the point.
        present: whether it is the experiment as it is.
    """

    name: str
    value: Any
    patch: dict[str, Any] = field(repr=False)
    factor: float | None = None
    present: bool = False

    def document(self) -> dict[str, Any]:
        """Return the trial as plain JSON values."""
        return asdict(self)


def strip(
    experiment: Experiment, lane: str, name: str, count: int = COUNT, joint: int | None = None
) -> list[Trial]:
    """Return trials of one knob along its slider's track, the others fixed.

    Args:
        experiment: where to start from.
        lane: whose knob.
        name: its field.
        count: how many positions.
        joint: turn the share of this joint alone, 1 to 6. Without it all joints' are
            turned; where they differ the value is the greatest one's, the others stay in
            proportion.

    Raises:
        InvalidExperimentError: if there is no such lane or knob.
    """
    turned = knob(experiment, lane, name)
    values = [float(value) for value in turned.positions(count)]
    if joint is None:
        return [Trial(name, value, turned.patch(turned.at_all(value))) for value in values]
    return [Trial(name, value, turned.patch(turned.at_joint(joint, value))) for value in values]


def sensitivity(experiment: Experiment, lane: str, change: float = 0.1) -> list[Trial]:
    """Return trials of every knob, a little down and a little up; first the present state.

    A knob at 0 can't be scaled and is left out.

    Raises:
        InvalidExperimentError: if there is no such lane.
    """
    found = knobs(experiment, lane)
    trials = [Trial("", None, {}, present=True)]
    for turned in found:
        if not np.any(turned.value):
            continue
        for factor in (1.0 - change, 1.0 + change):
            value = turned.scaled(factor)
            trials.append(Trial(turned.field, value, turned.patch(value), factor))
    return trials


def switching_comparison(experiment: Experiment, lane: str) -> list[Trial]:
    """Return trials of tanh over the boundary layer, then of each switching function of its law.

    Raises:
        InvalidExperimentError: if there is no such lane, or it doesn't switch.
    """
    knobs(experiment, lane)
    present = experiment.lanes[lane]
    if not hasattr(present, "switching"):
        text = f"{lane} has no switching function to compare"
        raise InvalidExperimentError([FieldError("lane", text, lane)])

    def patch(**gains: Any) -> dict[str, Any]:
        return {"lanes": {lane: gains}}

    curve = [
        Trial("epsilon", float(value), patch(switching="tanh", epsilon=float(value)))
        for value in EPSILONS
    ]
    functions = [
        Trial("switching", name, patch(switching=name), present=name == present.switching)
        for name in get_args(type(present).model_fields["switching"].annotation)
        if (name, present.reaching) != ("implicit", "power")
    ]
    return curve + functions
