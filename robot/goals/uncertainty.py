"""The uncertainty's section of an experiment: what is not known exactly, and how far it may be off.

Every quantity is drawn evenly from its range, all of them independently. The controller's nominal
model stays what it is.
"""

from __future__ import annotations

from typing import Any

from pydantic import model_validator

from slidetune.robot.fields.quantity import Integer, Range, Section, field, refusal

_FACTOR: dict[str, Any] = {"low": 0.0, "high": 10.0, "step": 0.05}


class Uncertainty(Section):
    """What is not known exactly: ranges from which robustness draws."""

    payload: Range = field(
        None,
        usual=(0.0, 2.0),
        title="Payload",
        symbol="m",
        unit="kg",
        low=0.0,
        high=10.0,
        step=0.1,
        meaning="Mass at the flange, in place of the arm's; a payload known to the controller is "
        "known at every draw.",
    )
    inertia: Range = field(
        None,
        usual=(0.8, 1.2),
        title="Masses and inertias",
        low=0.2,
        high=5.0,
        step=0.05,
        meaning="Factor on the inertia scale of the arm, not on that of its nominal model.",
    )
    viscous_friction: Range = field(
        None,
        usual=(0.5, 1.5),
        title="Viscous friction",
        meaning="Factor on the viscous friction of every joint.",
        **_FACTOR,
    )
    coulomb_friction: Range = field(
        None,
        usual=(0.5, 1.5),
        title="Coulomb friction",
        meaning="Factor on the Coulomb friction of every joint.",
        **_FACTOR,
    )
    disturbance: Range = field(
        None,
        usual=(0.5, 1.5),
        title="Disturbance",
        meaning="Factor on every disturbance torque: constant, sine, pulse and noise.",
        **_FACTOR,
    )
    sensor_noise: Range = field(
        None,
        usual=(0.0, 2.0),
        title="Sensor noise",
        meaning="Factor on the noise of angles and velocities.",
        **_FACTOR,
    )
    input_delay: Range = field(
        None,
        usual=(0.0, 0.002),
        title="Input delay",
        unit="s",
        low=0.0,
        high=0.05,
        step=0.0001,
        applies="sampled",
        meaning="Input delay, in place of the simulation's.",
    )
    lag: Range = field(
        None,
        usual=(0.0, 0.004),
        title="Lag of the drives",
        symbol="τ_lag",
        unit="s",
        low=0.0,
        high=0.05,
        step=0.0005,
        meaning="Time constant of every drive, in place of the arm's.",
    )
    seed: Integer = field(
        1,
        title="Seed",
        low=0,
        high=2**31 - 1,
        step=1,
        meaning="The same seed gives the same draws, whatever is tuned: trials are compared on "
        "equal terms.",
    )

    @model_validator(mode="after")
    def _ranges_are_in_order(self) -> Uncertainty:
        for name in self.uncertain:
            low, high = getattr(self, name)
            if low > high:
                text = (
                    f"{name} must go from the least to the greatest value, got [{low:g}, {high:g}]"
                )
                raise refusal(name, [low, high], text)
        return self

    @property
    def uncertain(self) -> tuple[str, ...]:
        """Names of the quantities that have a range, in the order of the fields."""
        names = [name for name in type(self).model_fields if name != "seed"]
        return tuple(name for name in names if getattr(self, name) is not None)
