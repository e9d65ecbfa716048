"""The numbers that a log may tell: their fields, what they are called, and what is permitted.

In this order: mass and centre of the payload, then armature, viscous and Coulomb friction, and a
constant torque of each joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.section import Payload, Robot
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.fields.units import sliding
from slidetune.robot.identification.solving import PAYLOAD

Array = np.ndarray

PARTS = ("payload", "armature", "viscous_friction", "coulomb_friction", "constant")
"""What can be fitted: of the arm, and the constant torque of the disturbance."""
OF_JOINTS = PARTS[1:4]
"""Of them, those that the arm has for each joint."""
BLOCKS = len(PARTS) - 1
"""How many numbers each joint has."""
_AXES = ("x", "y", "z")


def names_of(robot: Robot) -> list[str]:
    """Return the fields in the order of the numbers."""
    joints = arm_named(robot.model).joints
    center = [f"robot.payload.center.{axis}" for axis in range(3)]
    fields = [*(f"robot.{part}" for part in OF_JOINTS), "disturbance.constant"]
    each = [f"{field}.{joint}" for field in fields for joint in range(joints)]
    return ["robot.payload.mass", *center, *each]


def part_of(path: str) -> str:
    """Return which of ``PARTS`` a number belongs to."""
    return path.split(".")[1]


def values_of(robot: Robot, load: Sequence[float] | float) -> Array:
    """Return what the experiment has, its constant torques included. Shape (p,)."""
    joints = arm_named(robot.model).joints
    each = [np.broadcast_to(getattr(robot, part), joints) for part in OF_JOINTS]
    each.append(np.broadcast_to(load, joints))
    return np.concatenate([[robot.payload.mass], robot.payload.center, *each]).astype(float)


def bounds_of(count: int) -> tuple[Array, Array]:
    """Return what the fields permit, least and greatest. Shapes (p,).

    A point mass that isn't negative is a body that can be.
    """
    joints = (count - PAYLOAD) // BLOCKS
    ends = [bounds(Payload, "mass"), *[bounds(Payload, "center")] * 3]
    ends += [bounds(Robot, part) for part in OF_JOINTS for _ in range(joints)]
    ends += [bounds(Disturbance, "constant")] * joints
    low, high = np.array(ends, dtype=float).T
    return low, high


def title_of(path: str) -> str:
    """Return what a number is called, in words."""
    part, last = part_of(path), path.rsplit(".", 1)[-1]
    if part == "payload":
        return "payload mass" if last == "mass" else f"payload centre {_AXES[int(last)]}"
    words = {
        "armature": "rotor inertia",
        "viscous_friction": "viscous friction",
        "coulomb_friction": "Coulomb friction",
        "constant": "constant torque",
    }
    return f"{words[part]} of joint {int(last) + 1}"


def titles_of(names: Sequence[str], numbers: Sequence[int]) -> str:
    """Return what several numbers are called, in words."""
    return " and ".join(title_of(names[number]) for number in numbers)


def unit_of(robot: Robot, path: str) -> str:
    """Return the unit of a number: that of its field, or of its joint where that slides."""
    part, last = path.split(".")[1:3]
    model: Any = {"payload": Payload, "constant": Disturbance}.get(part, Robot)
    extra: Any = model.model_fields[last if part == "payload" else part].json_schema_extra
    unit = str(extra["unit"])
    slides = part != "payload" and arm_named(robot.model).slides[int(last)]
    return sliding(unit) if slides else unit
