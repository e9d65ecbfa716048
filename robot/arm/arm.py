"""The arm: URDF to Pinocchio model, true and nominal, and where its flange is."""

from __future__ import annotations

import logging
from functools import cache, lru_cache
from math import cos, sin
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.chain import checked_chain
from slidetune.robot.arm.description import URDF_PATH
from slidetune.robot.arm.section import Robot
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel

Array = np.ndarray

log = logging.getLogger("slidetune.arm")

FLANGE = "flange_link"
DATASHEET_SCALE = 23.0 / 96.3935
"""Mass of the real arm (*vendor* datasheet, 23 kg) over that of its description (*vendor*)."""


@cache
def _described_model() -> pin.Model:
    return pin.buildModelFromUrdf(str(URDF_PATH))


def _scaled(model: pin.Model, scale: float) -> None:
    for j in range(1, model.njoints):
        inertia = model.inertias[j]
        model.inertias[j] = pin.Inertia(
            scale * inertia.mass, inertia.lever, scale * inertia.inertia
        )


def build_model(robot: Robot, mismatch: float = 1.0, payload: bool = True) -> pin.Model:
    """Return a Pinocchio model of the arm.

    Args:
        robot: inertials, inertia scale, armature and payload.
        mismatch: factor on the inertials of the arm, 1 for the true one.
        payload: whether the payload is part of it.

    Returns:
        A model of its own, free to change. Its mass matrix includes the armature [kg m^2].
    """
    model = _described_model().copy()
    scale = DATASHEET_SCALE if robot.inertials == "datasheet" else 1.0
    _scaled(model, scale * robot.inertia_scale * mismatch)
    if payload and robot.payload.mass > 0.0:
        point = pin.Inertia(robot.payload.mass, np.array(robot.payload.center), np.zeros((3, 3)))
        frame = model.frames[model.getFrameId(FLANGE)]
        model.appendBodyToJoint(frame.parentJoint, point, frame.placement)
    model.armature = np.broadcast_to(np.asarray(robot.armature, dtype=float), JOINTS).copy()
    return model


class Arm(NamedTuple):
    """An arm in both forms; neither is changed.

    Attributes:
        model: for Pinocchio.
        chain: for the compiled recursion, ``None`` where that does not agree with Pinocchio.
    """

    model: pin.Model
    chain: Array | None


@lru_cache(maxsize=64)
def build_arm(robot: Robot, mismatch: float = 1.0, payload: bool = True) -> Arm:
    """Return an arm; the arguments are those of ``build_model``."""
    model = build_model(robot, mismatch, payload)
    chain = checked_chain(model)
    if chain is None:
        _warn_once()
    return Arm(model, chain)


@cache
def _warn_once() -> None:
    log.warning("The compiled recursion does not agree with Pinocchio: runs are stepped.")


def nominal_arm(robot: Robot, mismatch: float) -> Arm | None:
    """Return the nominal arm of a model-based law, or ``None`` if it is the true one.

    It knows the armature, no friction, and the payload only where ``payload.known`` says so.
    """
    knows_payload = robot.payload.known or robot.payload.mass == 0.0
    if mismatch == 1.0 and knows_payload:
        return None
    return build_arm(robot, mismatch, robot.payload.known)


@cache
def _chain() -> Array:
    """Return the placements of the six joints and of the flange. Shape (7, 3, 4)."""
    model = _described_model()
    frame = model.frames[model.getFrameId(FLANGE)]
    placements = [*(model.jointPlacements[j] for j in range(1, JOINTS + 1)), frame.placement]
    return np.array([np.hstack([p.rotation, p.translation[:, None]]) for p in placements])


@kernel
def _flange_positions(chain, angles, out):  # type: ignore[no-untyped-def]
    """Carry the flange's centre from frame to frame, from the last joint back to the base."""
    for row in range(angles.shape[0]):
        x, y, z = chain[JOINTS, 0, 3], chain[JOINTS, 1, 3], chain[JOINTS, 2, 3]
        for joint in range(JOINTS - 1, -1, -1):
            place = chain[joint]
            c, s = cos(angles[row, joint]), sin(angles[row, joint])
            x, y = c * x - s * y, s * x + c * y
            x, y, z = (
                place[0, 0] * x + place[0, 1] * y + place[0, 2] * z + place[0, 3],
                place[1, 0] * x + place[1, 1] * y + place[1, 2] * z + place[1, 3],
                place[2, 0] * x + place[2, 1] * y + place[2, 2] * z + place[2, 3],
            )
        out[row, 0], out[row, 1], out[row, 2] = x, y, z


def flange_positions(angles: Array) -> Array:
    """Return where the flange's centre is.

    Args:
        angles: joint angles in [rad]. Shape (n, 6).

    Returns:
        Positions in the base frame in [m]. Shape (n, 3).
    """
    out = np.empty((len(angles), 3))
    _flange_positions(_chain(), np.ascontiguousarray(angles, dtype=float), out)
    return out
