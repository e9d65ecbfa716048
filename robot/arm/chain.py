"""A serial arm as the numbers that the compiled recursion takes, compared with Pinocchio."""

from __future__ import annotations

from math import inf

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.recursion import (
    ARMATURE,
    CENTRE,
    CHAIN_COLUMNS,
    MASS,
    PLACE,
    ROTATION,
    SCRATCH_COLUMNS,
    SLIDES,
    TENSOR,
    chain_dynamics,
)
from slidetune.robot.fields.quantity import MOST_JOINTS

Array = np.ndarray

AGREEMENT = 1e-10
"""Relative difference from Pinocchio up to which a chain is used (*ours*)."""
_STATES = 4
"""States at which the two are compared (*ours*)."""


def _frame_along(axis: Array) -> Array:
    """Return a rotation whose z is ``axis``. Shape (3, 3)."""
    z = axis / np.linalg.norm(axis)
    x = np.eye(3)[np.argmin(np.abs(z))]
    x = x - z * (z @ x)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def turned_axis(model: pin.Model, joint: int) -> tuple[Array, bool] | None:
    """Return how a joint's frame is turned for its z to be its axis, and whether it slides.

    Args:
        model: the arm.
        joint: Pinocchio's number of the joint.

    Returns:
        A rotation of shape (3, 3) and a flag; ``None`` for a screw, or where no axis stays.
    """
    motion = np.asarray(model.joints[joint].createData().S).ravel()
    slides = bool(motion[:3].any())
    if motion.shape != (6,) or slides == bool(motion[3:].any()):
        return None
    return _frame_along(motion[:3] if slides else motion[3:]), slides


def pack_chain(model: pin.Model) -> Array | None:
    """Return an arm as a chain, or ``None`` where it is none.

    Args:
        model: a fixed-base arm: revolute and prismatic joints about or along any axis, each on the
            one before, at most 12 of them.

    Returns:
        A row for each joint and one for gravity. Shape (n + 1, 24).
    """
    count = model.njoints - 1
    serial = list(model.parents)[1:] == list(range(count))
    if not (serial and 1 <= count <= MOST_JOINTS and model.nq == model.nv == count):
        return None
    chain = np.zeros((count + 1, CHAIN_COLUMNS))
    chain[count, :3] = model.gravity.linear
    before = np.eye(3)
    for number, row in enumerate(chain[:count], 1):
        placement, inertia = model.jointPlacements[number], model.inertias[number]
        found = turned_axis(model, number)
        if found is None:
            return None
        turn, slides = found
        row[ROTATION:PLACE] = (before.T @ placement.rotation @ turn).ravel()
        row[PLACE:MASS] = before.T @ placement.translation
        row[MASS], row[CENTRE:TENSOR] = inertia.mass, turn.T @ inertia.lever
        row[TENSOR:ARMATURE] = (turn.T @ inertia.inertia @ turn)[np.triu_indices(3)]
        row[SLIDES] = float(slides)
        before = turn
    chain[:count, ARMATURE] = model.armature
    return chain


def deviation(model: pin.Model, chain: Array) -> float:
    """Return the greatest relative difference between M and h of a chain and of Pinocchio [-].

    Args:
        model: the arm.
        chain: what ``pack_chain`` returned.
    """
    count, data = model.nv, model.createData()
    random = np.random.default_rng(count)
    inertia, bias = np.zeros((count, count)), np.zeros(count)
    scratch, worst = np.zeros((count, SCRATCH_COLUMNS)), 0.0
    for q, v in random.uniform(-3.0, 3.0, (_STATES, 2, count)):
        chain_dynamics(chain, q, v, inertia, bias, scratch)
        known_inertia, known_bias = (
            pin.crba(model, data, q),
            pin.nonLinearEffects(model, data, q, v),
        )
        worst = max(
            worst,
            _difference(np.triu(inertia), np.triu(known_inertia)),
            _difference(bias, known_bias),
        )
    return worst


def _difference(ours: Array, theirs: Array) -> float:
    """Return the greatest difference, relative to the greatest of all numbers."""
    if not (np.isfinite(ours).all() and np.isfinite(theirs).all()):
        return inf  # not NaN, which is never the greatest
    scale = max(float(np.abs(theirs).max()), float(np.abs(ours).max()))
    return float(np.abs(ours - theirs).max()) / scale if scale > 0.0 else 0.0


def checked_chain(model: pin.Model) -> Array | None:
    """Return an arm as a chain if it agrees with Pinocchio, else ``None``."""
    chain = pack_chain(model)
    agrees = chain is not None and deviation(model, chain) <= AGREEMENT
    return chain if agrees else None
