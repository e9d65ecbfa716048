"""The goals' section of an experiment: bounds on responses and on figures, hard or soft.

Each is normalised to its bound, so that 1 is just met: what must hold is hard, the rest is made as
small as it will go (Apkarian, Gahinet and Buhr, *Multi-model, multi-objective tuning*, 2014).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from slidetune.robot.fields.quantity import MOST_JOINTS, Integer, Number, Section, field, refusal

Channel = Literal["e", "de", "tau", "S", "flange_error"]
Priority = Literal["hard", "soft"]
Bounded = Literal[
    "mae",
    "max_error",
    "max_velocity_error",
    "chattering",
    "high_frequency_torque",
    "peak_torque",
    "reaching_time",
    "flange_rms",
    "flange_max",
    "rms_torque",
    "itae",
]
"""Figures that can be bounded: those of which less is better."""

CHANNELS: dict[str, tuple[str, str]] = {
    "e": ("|e|", "rad"),
    "de": ("|de|", "rad/s"),
    "tau": ("|τ|", "N·m"),
    "S": ("|S|", "rad/s"),
    "flange_error": ("flange error", "m"),
}
"""Symbol and unit of each channel."""
OF_THE_WHOLE_ARM = frozenset(
    {"flange_error", "chattering", "high_frequency_torque", "flange_rms", "flange_max"}
)
"""What is one number for the whole arm, whose joint can't be chosen."""
MOST_GOALS = 24
LATEST = 120.0
"""Latest instant that a goal can name in [s]: the longest horizon."""


class Goal(Section):
    """A bound, and how much it counts."""

    bound: Number = field(
        0.01,
        title="Bound",
        low=1e-9,
        high=1e9,
        scale="log",
        meaning="Greatest permitted value, in the unit of what is bounded: rad, rad/s, N·m, m, s.",
    )
    joint: Integer = field(
        0,
        title="Joint",
        low=0,
        high=MOST_JOINTS,
        joint=True,
        step=1,
        meaning="Joint that the goal is for; 0 for every joint, and of a figure for the number in "
        "the table.",
    )
    priority: Priority = field(
        "soft",
        title="Priority",
        meaning="hard must hold; of soft ones the one that misses its bound most is made as small "
        "as possible, as long as every hard one holds.",
    )


class ResponseGoal(Goal):
    """A bound on a response, between two instants."""

    kind: Literal["response"] = "response"
    channel: Channel = field(
        "e",
        title="Channel",
        meaning="What is bounded, by its absolute value: error e, velocity error de, torque tau, "
        "sliding variable S, or the distance of the flange from its desired position.",
    )
    start: Number = field(
        0.0,
        title="From",
        unit="s",
        low=0.0,
        high=LATEST,
        step=0.1,
        meaning="First instant at which it holds.",
    )
    end: Number = field(
        LATEST,
        title="To",
        unit="s",
        low=0.0,
        high=LATEST,
        step=0.1,
        meaning="Last instant at which it holds, or the horizon, whichever is first.",
    )

    @model_validator(mode="after")
    def _has_a_span(self) -> ResponseGoal:
        if self.end <= self.start:
            text = f"must be later than start = {self.start:g} s, got {self.end:g} s"
            raise refusal("end", self.end, f"end {text}")
        _refuse_joint(self.channel, self.joint)
        return self


class FigureGoal(Goal):
    """A bound on a figure of the whole run."""

    kind: Literal["figure"] = "figure"
    figure: Bounded = field(
        "mae", title="Figure", meaning="Figure of the table that is bounded, in its SI unit."
    )

    @model_validator(mode="after")
    def _has_joints(self) -> FigureGoal:
        _refuse_joint(self.figure, self.joint)
        return self


def _refuse_joint(what: str, joint: int) -> None:
    if joint and what in OF_THE_WHOLE_ARM:
        raise refusal("joint", joint, f"joint must be 0, got {joint}: {what} is of the whole arm")


AnyGoal = Annotated[ResponseGoal | FigureGoal, Field(discriminator="kind")]
GOALS: dict[str, type[Goal]] = {"response": ResponseGoal, "figure": FigureGoal}
