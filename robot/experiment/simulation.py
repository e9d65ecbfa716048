"""The simulation's section of an experiment: mode, step, rate, delay, horizon, initial state."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from slidetune.robot.fields.quantity import Integer, Number, PerJoint, Section, field, refusal

MAX_STEPS = 200_000
"""Most steps of one run (*ours*): 200 s at 1 kHz, about 80 MB of results a lane."""


class Simulation(Section):
    """How the closed loop is computed."""

    mode: Literal["continuous", "sampled"] = field(
        "continuous",
        title="Mode",
        source="published",
        meaning="continuous: the controller is part of the differential equation, as in the paper; "
        "sampled: it runs at its own rate with a zero-order hold, as on a real arm.",
    )
    step: Number = field(
        0.001,
        title="Step",
        symbol="h",
        unit="s",
        low=0.00005,
        high=0.005,
        step=0.0001,
        scale="log",
        applies="continuous",
        meaning="Integration step.",
    )
    scheme: Literal["extrapolated", "plain"] = field(
        "extrapolated",
        title="Scheme",
        applies="continuous",
        meaning="extrapolated: two half steps and one full step, combined; a hundred times as "
        "accurate; plain: one linearly implicit step, faster.",
    )
    control_rate: Number = field(
        1000.0,
        title="Control rate",
        unit="Hz",
        low=50.0,
        high=10000.0,
        step=10.0,
        scale="log",
        applies="sampled",
        meaning="Rate at which the controller samples and updates its torque.",
    )
    plant_substeps: Integer = field(
        10,
        title="Steps of the arm",
        low=1,
        high=200,
        step=1,
        applies="sampled",
        meaning="Integration steps of the arm per control period.",
    )
    input_delay: Number = field(
        0.0,
        title="Input delay",
        unit="s",
        low=0.0,
        high=0.05,
        step=0.0001,
        applies="sampled",
        meaning="Delay from a measurement to the resulting torque at the joint.",
    )
    horizon: Number = field(
        10.0,
        title="Horizon",
        unit="s",
        low=0.1,
        high=120.0,
        step=0.5,
        source="published",
        meaning="Duration of a whole run.",
    )
    initial_velocity: Literal["desired", "rest"] = field(
        "desired",
        title="Initial velocity",
        source="inferred",
        meaning="Whether the arm starts with the desired velocity or at rest.",
    )
    initial_error: PerJoint = field(
        0.0,
        title="Initial error",
        symbol="e(0)",
        unit="rad",
        low=-1.0,
        high=1.0,
        step=0.01,
        meaning="Desired minus actual angle at t = 0.",
    )
    high_frequency: Number = field(
        50.0,
        title="High frequency",
        symbol="f_h",
        unit="Hz",
        low=10.0,
        high=5000.0,
        step=1.0,
        scale="log",
        meaning="Torque above it counts as chattering in the figures and the chattering lens; the "
        "motion does not depend on it. Torque above half the rate of the rows is not seen.",
    )

    @property
    def row_period(self) -> float:
        """Time between two rows of a result in [s]."""
        return self.step if self.mode == "continuous" else 1.0 / self.control_rate

    @property
    def rows(self) -> int:
        """Rows of a result, both ends of the horizon included."""
        return round(self.horizon / self.row_period) + 1

    @property
    def arm_step(self) -> float:
        """Step of the arm in [s]."""
        return self.row_period / self.plant_substeps if self.mode == "sampled" else self.step

    @property
    def hold(self) -> float:
        """For so long a torque is held in [s]; 0 where nothing is sampled."""
        return self.row_period if self.mode == "sampled" else 0.0

    @property
    def delay(self) -> tuple[int, float]:
        """Input delay as whole control periods and the steps of the arm, or parts, beyond them."""
        # Rounded, so that a delay of whole steps is one, whatever 0.1 is in binary.
        steps = round(self.input_delay * self.control_rate * self.plant_substeps, 9)
        whole, part = divmod(steps, self.plant_substeps)
        return int(whole), part

    @model_validator(mode="after")
    def _not_too_long(self) -> Simulation:
        steps = self.horizon / self.row_period
        if steps > MAX_STEPS:
            text = (
                f"horizon takes {steps:.0f} steps, at most {MAX_STEPS}: shorten it, or lengthen "
                "the step or lower the control rate"
            )
            raise refusal("horizon", self.horizon, text)
        return self
