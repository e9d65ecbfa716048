"""The arm: URDF to Pinocchio model, true and nominal, and where its flange is."""

from __future__ import annotations

import logging
from functools import cache, lru_cache
from math import cos, sin
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.chain import checked_chain, turned_axis
from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.section import Robot
from slidetune.robot.kernels.compiler import kernel

Array = np.ndarray

log = logging.getLogger("slidetune.arm")

DATASHEET_SCALE = 23.0 / 96.3935
"""Mass of the real arm (*vendor* datasheet, 23 kg) over that of its description (*vendor*)."""


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
    arm = arm_named(robot.model)
    model = arm.model.copy()
    scale = DATASHEET_SCALE if robot.inertials == "datasheet" else 1.0
    _scaled(model, scale * robot.inertia_scale * mismatch)
    if payload and robot.payload.mass > 0.0:
        point = pin.Inertia(robot.payload.mass, np.array(robot.payload.center), np.zeros((3, 3)))
        frame = model.frames[model.getFrameId(arm.tip)]
        model.appendBodyToJoint(frame.parentJoint, point, frame.placement)
    armature = np.asarray(robot.armature, dtype=float)
    model.armature = np.broadcast_to(armature, model.nv).copy()
    return model


class Arm(NamedTuple):
    """An arm in both forms; neither is changed.

    Attributes:
        model: for Pinocchio.
        chain: for the compiled recursion, ``None`` where that does not agree with Pinocchio.
        places: for ``flange_positions``.
    """

    model: pin.Model
    chain: Array | None
    places: Array


@lru_cache(maxsize=64)
def build_arm(robot: Robot, mismatch: float = 1.0, payload: bool = True) -> Arm:
    """Return an arm; the arguments are those of ``build_model``."""
    model = build_model(robot, mismatch, payload)
    chain = checked_chain(model)
    if chain is None:
        _warn_once()
    return Arm(model, chain, flange_places(model, arm_named(robot.model).tip))


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
def shipped_places() -> Array:
    """Return what ``flange_positions`` takes of the arm that is drawn. Shape (7, 13)."""
    return build_arm(Robot()).places


PLACE_COLUMNS = 13
"""Columns of ``flange_places``: rotation row by row, place [m], and whether the joint slides."""


def flange_places(model: pin.Model, flange: str) -> Array:
    """Return where each joint and the flange stand in the frame before, as numbers.

    Args:
        model: a serial arm; z of every joint's frame is turned onto its axis.
        flange: name of the flange's frame.

    Returns:
        For ``flange_positions``. Shape (n + 1, 13).
    """
    frame, before = model.frames[model.getFrameId(flange)], np.eye(3)
    places = np.zeros((model.nv + 1, PLACE_COLUMNS))
    for joint in range(1, model.nv + 1):
        found = turned_axis(model, joint)
        if found is None:
            raise ValueError(f"joint {joint} neither turns about nor slides along one axis")
        turn, slides = found
        placement = model.jointPlacements[joint]
        places[joint - 1, :9] = (before.T @ placement.rotation @ turn).ravel()
        places[joint - 1, 9:12] = before.T @ placement.translation
        places[joint - 1, 12] = slides
        before = turn
    places[-1, :9] = (before.T @ frame.placement.rotation).ravel()
    places[-1, 9:12] = before.T @ frame.placement.translation
    return places


@kernel
def _flange_positions(places, angles, out):  # type: ignore[no-untyped-def]
    """Carry the flange's centre from frame to frame, from the last joint back to the base."""
    last = places.shape[0] - 1
    for row in range(angles.shape[0]):
        x, y, z = places[last, 9], places[last, 10], places[last, 11]
        for joint in range(last - 1, -1, -1):
            place, q = places[joint], angles[row, joint]
            if place[12] != 0.0:
                z += q
            else:
                c, s = cos(q), sin(q)
                x, y = c * x - s * y, s * x + c * y
            x, y, z = (
                place[0] * x + place[1] * y + place[2] * z + place[9],
                place[3] * x + place[4] * y + place[5] * z + place[10],
                place[6] * x + place[7] * y + place[8] * z + place[11],
            )
        out[row, 0], out[row, 1], out[row, 2] = x, y, z


def flange_positions(angles: Array, places: Array) -> Array:
    """Return where the flange's centre is.

    Args:
        angles: joint angles in [rad], or displacements in [m]. Shape (m, n).
        places: what ``flange_places`` returned of the arm. Shape (n + 1, 13).

    Returns:
        Positions in the base frame in [m]. Shape (m, 3).
    """
    out = np.empty((len(angles), 3))
    _flange_positions(places, np.ascontiguousarray(angles, dtype=float), out)
    return out
