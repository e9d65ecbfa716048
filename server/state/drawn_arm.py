"""The live session draws one arm: experiments with another one are refused in words."""

from __future__ import annotations

from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack


def pack_drawn(experiment: Experiment) -> Packed:
    """Turn an experiment for the live session into numbers.

    Raises:
        InvalidExperimentError: if its arm is not the one that is drawn, or can't follow its
            trajectory.
    """
    model = experiment.robot.model
    if model != SHIPPED:
        text = (
            f"robot.model must be {SHIPPED} on the dashboard, got {model}: it draws no other arm "
            "so far; slidetune run and the studies of the command line take all of them"
        )
        raise InvalidExperimentError([FieldError("robot.model", text, model)])
    return pack(experiment)
