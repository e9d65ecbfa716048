r"""The equation of the arm, linear in what is not known.

.. math:: \tau - \tau_{arm}(q, v, a) = Y_{10}\,\varphi + \operatorname{diag}(a) A
    + \operatorname{diag}(v)\,d + \operatorname{diag}(\tanh(v / v_C))\,f_C + F

with Pinocchio's regressor of the last body for a point mass m at x in that body's frame,
:math:`\varphi = (m, m x, m (x^T x\,1 - x x^T))`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.arm import build_model
from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.section import Payload, Robot
from slidetune.robot.environment.external_torque import COULOMB_WIDTH
from slidetune.robot.identification.filtering import Kinematics, thinned

Array = np.ndarray

INERTIAL = 10
"""Parameters of a body in Pinocchio's order: m, m x, Ixx, Ixy, Iyy, Ixz, Iyz, Izz."""
_PLACES = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))


class Equation(NamedTuple):
    """The equation at every row that remains.

    Attributes:
        columns: of the last body's ten, then armature, viscous and Coulomb friction and the
            constant torque of each joint. Shape (r, n, 10 + 4 n).
        torque: measured torque in [N m]. Shape (r, n).
        rate: its derivative in [N m/s]. Shape (r, n).
        known: torque of the arm without all of these in [N m]. Shape (r, n).
        time: of each row in [s]. Shape (r,).
        weight: torque in [N m] that each joint has to hold and to turn with 10 rad/s^2, or its
            effective torque where that is greater: what is much or little of it. Shape (n,).
        inertia: what is much inertia of it: the diagonal of M, or what that torque turns with
            10 rad/s^2, in [kg m^2]. Shape (n,).
    """

    columns: Array
    torque: Array
    rate: Array
    known: Array
    time: Array
    weight: Array
    inertia: Array


_BRISK = 10.0
"""Acceleration in [rad/s^2] that is brisk for an arm (*ours*)."""


def equation_of(robot: Robot, log: Kinematics) -> Equation:
    """Return the equation along a log.

    Args:
        robot: the arm; its payload, armature and friction count for nothing.
        log: its motion.
    """
    bare = robot.model_copy(update={"payload": Payload(), "armature": 0.0})
    model = build_model(bare)
    data, joints, count = model.createData(), model.nv, len(log.time)
    columns = np.zeros((count, joints, INERTIAL + 4 * joints))
    known, gravity, inertia = np.empty((count, joints)), np.zeros(joints), np.zeros(joints)
    for row in range(count):
        q, v, a = log.q[row], log.v[row], log.a[row]
        known[row] = pin.rnea(model, data, q, v, a)
        whole = pin.computeJointTorqueRegressor(model, data, q, v, a)
        columns[row, :, :INERTIAL] = np.reshape(whole, (joints, -1))[:, -INERTIAL:]
    for row in range(0, count, max(count // 50, 1)):
        holds = np.abs(pin.computeGeneralizedGravity(model, data, log.q[row]))
        gravity = np.maximum(gravity, holds)
        inertia = np.maximum(inertia, np.diag(pin.crba(model, data, log.q[row])))
    each = np.arange(joints)
    blocks = (log.a, log.v, np.tanh(log.v / COULOMB_WIDTH), np.ones_like(log.v))
    for part, block in enumerate(blocks):
        columns[:, each, INERTIAL + part * joints + each] = block
    torque = thinned(log, log.torque)
    weight = np.maximum(gravity + _BRISK * inertia, np.sqrt(np.mean(torque**2, axis=0)))
    return Equation(
        thinned(log, columns),
        torque,
        thinned(log, np.gradient(log.torque, 1.0 / log.rate, axis=0)),
        thinned(log, known),
        thinned_time(log),
        weight,
        np.maximum(inertia, weight / _BRISK),
    )


def thinned_time(log: Kinematics) -> Array:
    """Return the times of the rows that remain in [s]."""
    return np.asarray(thinned(log, log.time[:, None])[:, 0])


class Placed(NamedTuple):
    """Where the flange's frame stands in the last body's: rotation (3, 3), place (3,) in [m]."""

    rotation: Array
    place: Array


def flange_of(robot: Robot) -> Placed:
    """Return where the flange stands."""
    arm = arm_named(robot.model)
    placement = arm.model.frames[arm.model.getFrameId(arm.tip)].placement
    return Placed(placement.rotation.copy(), placement.translation.copy())


def payload_columns(flange: Placed, mass: float, center: Array) -> tuple[Array, Array]:
    """Return the last body's ten parameters of a point mass, and their slopes.

    Args:
        flange: where its frame stands.
        mass: in [kg].
        center: in the flange's frame in [m]. Shape (3,).

    Returns:
        Parameters, shape (10,), and slopes over mass and centre, shape (10, 4).
    """
    x = flange.rotation @ center + flange.place
    inertia = x @ x * np.eye(3) - np.outer(x, x)
    of_one = np.concatenate([[1.0], x, [inertia[place] for place in _PLACES]])
    slopes = np.zeros((INERTIAL, 4))
    slopes[:, 0] = of_one
    for axis in range(3):
        e = flange.rotation[:, axis]
        bend = 2.0 * (x @ e) * np.eye(3) - np.outer(x, e) - np.outer(e, x)
        slopes[1:4, 1 + axis] = mass * e
        slopes[4:, 1 + axis] = [mass * bend[place] for place in _PLACES]
    return mass * of_one, slopes
