"""The arm's section of an experiment: inertials, friction, limits, payload."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import PlainValidator, WithJsonSchema, model_validator

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.fields.quantity import (
    Number,
    PerJoint,
    PerJointOrOff,
    Point,
    Section,
    field,
    refusal,
)


class Payload(Section):
    """Payload at the flange."""

    mass: Number = field(
        0.0,
        title="Mass",
        symbol="m",
        unit="kg",
        low=0.0,
        high=10.0,
        step=0.1,
        meaning="Mass at the flange; the arm is rated for 5 kg.",
    )
    center: Point = field(
        (0.0, 0.0, 0.05),
        title="Centre of mass",
        unit="m",
        low=-0.3,
        high=0.3,
        step=0.005,
        meaning="Position of the centre of mass in the flange frame (z points out of the flange).",
    )
    known: bool = field(
        False,
        title="Known to the controller",
        meaning="Whether the nominal model includes the payload.",
    )


def _known(name: object) -> str:
    if not isinstance(name, str):
        raise ValueError("must be the name of an arm")
    return arm_named(name).name


ArmName = Annotated[str, PlainValidator(_known), WithJsonSchema({"type": "string"})]


class Robot(Section):
    """The arm."""

    model: ArmName = field(
        SHIPPED,
        title="Arm",
        source="published",
        meaning="Which arm: the JAKA Zu 5 of the paper, one to learn with, or one of your own.",
    )
    inertials: Literal["vendor", "datasheet"] = field(
        "vendor",
        title="Inertials",
        source="vendor",
        meaning="vendor: the manufacturer's robot description, solid steel, 96.4 kg, on which the "
        "paper's results are based; datasheet: scaled to the arm's real mass, 23 kg.",
    )
    inertia_scale: Number = field(
        1.0,
        title="Inertia scale",
        low=0.1,
        high=3.0,
        step=0.01,
        meaning="Multiplies every mass and inertia of the arm and of its nominal model.",
    )
    armature: PerJoint = field(
        0.0,
        title="Reflected rotor inertia",
        symbol="A",
        unit="kg·m²",
        low=0.0,
        high=5.0,
        step=0.01,
        meaning="Inertia of the motors reflected through the gears; the paper has none.",
    )
    viscous_friction: PerJoint = field(
        0.0,
        title="Viscous friction",
        symbol="d",
        unit="N·m·s/rad",
        low=0.0,
        high=50.0,
        step=0.1,
        meaning="Friction torque per unit of velocity; not in the nominal model.",
    )
    coulomb_friction: PerJoint = field(
        0.0,
        title="Coulomb friction",
        symbol="f_C",
        unit="N·m",
        low=0.0,
        high=50.0,
        step=0.1,
        meaning="Dry friction torque, smoothed by tanh(v/0.02); not in the nominal model.",
    )
    torque_limit: PerJointOrOff = field(
        None,
        title="Torque limit",
        symbol="τ_max",
        unit="N·m",
        low=0.01,
        high=5000.0,
        step=1.0,
        scale="log",
        meaning="Torque at which the joint saturates; off as in the paper.",
    )
    lag: PerJoint = field(
        0.0,
        title="Lag of the drive",
        symbol="τ_lag",
        unit="s",
        low=0.0,
        high=0.05,
        step=0.0005,
        meaning="Time constant with which the torque at the joint follows the commanded one, after "
        "its limit; 0 is a drive without lag, as in the paper. Joint torque loops take 2-10 ms.",
    )
    lag_order: Literal["first", "second"] = field(
        "first",
        title="Order of the lag",
        meaning="first: one lag 1/(τ_lag·s + 1), as of a torque loop; second: two equal ones in "
        "series.",
    )
    payload: Payload = Payload()

    @model_validator(mode="after")
    def _has_a_datasheet(self) -> Robot:
        if self.inertials == "datasheet" and self.model != SHIPPED:
            text = f"inertials must be vendor for {self.model}: no other mass of it is known"
            raise refusal("inertials", self.inertials, text)
        return self
