"""Arms that are drawn: lengths and masses over two decades, joints about any axis."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.home import home_pose
from slidetune.robot.arm.known_arm import KnownArm, digest_of

Array = np.ndarray

_EFFORT = 3.0
"""Effort limits, as a multiple of what holds the arm where that takes most."""


def drawn_arm(joints: int, seed: int, slides: bool = False) -> KnownArm:
    """Return an arm of uniform rods.

    Args:
        joints: how many it has.
        seed: of the draw.
        slides: whether some of its joints slide.
    """
    random = np.random.default_rng([joints, seed])
    size, heavy = 10.0 ** random.uniform(-1.3, 0.7), 10.0 ** random.uniform(-1.0, 1.0)
    model, place = pin.Model(), pin.SE3.Identity()
    for number in range(joints):
        # From the base on each link is shorter and lighter, as in arms that people build.
        length = size * 0.8**number * random.uniform(0.3, 1.0)
        mass = heavy * 0.7**number * random.uniform(0.3, 1.0)
        axis = np.eye(3)[random.integers(3)] if number else np.eye(3)[1]
        slide = slides and random.uniform() < 0.4
        kind = pin.JointModelPrismaticUnaligned if slide else pin.JointModelRevoluteUnaligned
        index = model.addJoint(number, kind(axis), place, f"joint_{number + 1}")
        along = random.normal(size=3)
        along *= length / np.linalg.norm(along)
        rod = pin.Inertia.FromCylinder(mass, 0.1 * length, length)
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), along).matrix()
        model.appendBodyToJoint(index, rod, pin.SE3(turn, 0.5 * along))
        place = pin.SE3(pin.exp3(random.normal(size=3)), along)
    model.addFrame(pin.Frame("tip", joints, 0, place, pin.FrameType.BODY))
    model.lowerPositionLimit = -random.uniform(0.5, 3.0, joints)
    model.upperPositionLimit = random.uniform(0.5, 3.0, joints)
    model.velocityLimit = random.uniform(0.3, 3.0, joints)
    model.effortLimit = _EFFORT * _holding(model, random)
    home = home_pose(model, "tip")
    name = f"drawn-{digest_of(model, 'tip')}"
    return KnownArm(name, f"Drawn {joints}, {seed}", "", model, "tip", home)


def _holding(model: pin.Model, random: np.random.Generator) -> Array:
    """Return the greatest torque of gravity of each joint; of those without, of the inertia."""
    data, most = model.createData(), np.zeros(model.nv)
    for q in random.uniform(model.lowerPositionLimit, model.upperPositionLimit, (200, model.nv)):
        gravity = np.abs(pin.computeGeneralizedGravity(model, data, q))
        most = np.maximum(most, np.maximum(gravity, np.diagonal(pin.crba(model, data, q))))
    return most
