"""Inverse kinematics along a circle of the flange."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.arm import FLANGE, build_model
from slidetune.robot.arm.section import Robot
from slidetune.robot.errors import UnreachableError
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.motion.trajectory import CircleTrajectory

Array = np.ndarray

SAMPLES = 256
"""Samples along one turn (*ours*): the interpolated flange stays within a micrometre."""
_TOLERANCE = 1e-10
_CLOSURE = 1e-6
"""Difference of a joint's angle [rad] after a turn that still counts as closed (*ours*)."""
_SMALLEST_SINGULAR_VALUE = 0.02
"""Below it joint velocities grow past 50 times the flange's: refused (*ours*)."""
_AXES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


def _solve(model: pin.Model, data: pin.Data, frame: int, target: pin.SE3, q: Array) -> Array | None:
    """Return the angles near ``q`` whose flange is at ``target`` (Newton), or ``None``."""
    for _ in range(30):
        pin.framesForwardKinematics(model, data, q)
        jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL)
        if np.linalg.svd(jacobian, compute_uv=False)[-1] < _SMALLEST_SINGULAR_VALUE:
            return None
        error = pin.log6(data.oMf[frame].actInv(target)).vector
        if np.linalg.norm(error) < _TOLERANCE:
            return q
        q = q + np.linalg.solve(jacobian, error)
    return None


@lru_cache(maxsize=32)
def follow_circle(circle: CircleTrajectory) -> Array:
    """Return the joint motion along one turn.

    Args:
        circle: pose, radius, period and plane; the circle passes through the pose's flange.

    Returns:
        q_d [rad], v_d [rad/s], a_d [rad/s^2] at evenly spaced times. Shape (257, 3, 6).

    Raises:
        UnreachableError: if the arm can't follow; says where on the circle, and which field is to
            blame.
    """
    model = build_model(Robot())
    data = model.createData()
    frame = model.getFrameId(FLANGE)
    q = np.array(circle.pose)
    pin.framesForwardKinematics(model, data, q)
    start = data.oMf[frame].copy()
    first, second = _AXES[circle.plane]
    omega, radius = 2.0 * np.pi / circle.period, circle.radius
    turn = np.empty((SAMPLES + 1, 3, JOINTS))
    for n, angle in enumerate(np.linspace(0.0, 2.0 * np.pi, SAMPLES + 1)):
        along, rate, bend = np.zeros(3), np.zeros(3), np.zeros(3)
        along[first], along[second] = radius * (np.cos(angle) - 1.0), radius * np.sin(angle)
        rate[first], rate[second] = -np.sin(angle), np.cos(angle)
        bend[first], bend[second] = -np.cos(angle), -np.sin(angle)
        target = pin.SE3(start.rotation, start.translation + along)
        solution = _solve(model, data, frame, target, q)
        if solution is None:
            raise _out_of_reach(angle, radius)
        q = solution
        turn[n] = _motion(model, data, frame, q, omega * radius * rate, omega**2 * radius * bend)
    if np.abs(turn[-1, 0] - turn[0, 0]).max() > _CLOSURE:
        raise UnreachableError(
            f"radius {radius:g} m takes the flange around an axis of the arm, so a joint winds up "
            "by 360° per turn: choose a smaller radius, or another pose"
        )
    return turn


def _out_of_reach(angle: float, radius: float) -> UnreachableError:
    if angle == 0.0:
        return UnreachableError(
            "the circle's pose is singular (arm stretched, or two axes aligned), so the flange "
            "cannot leave it in every direction: bend joints 3 and 5",
            field="pose",
        )
    return UnreachableError(
        f"the arm can't follow this circle past {np.degrees(angle):.0f}° of the turn: "
        f"radius {radius:g} m is too large for this pose, choose a smaller one"
    )


def _motion(
    model: pin.Model, data: pin.Data, frame: int, q: Array, velocity: Array, acceleration: Array
) -> Array:
    """Return q, v and a of the joints for a flange that moves without turning. Shape (3, 6)."""
    axes = pin.LOCAL_WORLD_ALIGNED
    jacobian = pin.computeFrameJacobian(model, data, q, frame, axes)
    v = np.linalg.solve(jacobian, np.concatenate([velocity, np.zeros(3)]))
    pin.forwardKinematics(model, data, q, v, np.zeros(JOINTS))
    drift = pin.getFrameClassicalAcceleration(model, data, frame, axes).vector
    a = np.linalg.solve(jacobian, np.concatenate([acceleration, np.zeros(3)]) - drift)
    return np.stack([q, v, a])
