"""Inverse kinematics along a circle of the flange."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.known import SHIPPED, KnownArm, arm_named
from slidetune.robot.errors import UnreachableError
from slidetune.robot.motion.trajectory import CircleTrajectory

Array = np.ndarray

SAMPLES = 256
"""Samples along one turn (*ours*): the interpolated flange stays within a micrometre."""
_TOLERANCE = 1e-10
_NEWTON = 60
"""Steps after which a pose counts as out of reach (*ours*)."""
_CLOSURE = 1e-6
"""Difference of a joint's angle [rad] after a turn that still counts as closed (*ours*)."""
_SMALLEST_SINGULAR_VALUE = 0.02
"""Below it joint velocities grow past 50 times the flange's: refused (*ours*)."""
_AXES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


_POSITION, _POSE = 3, 6
"""What of the flange's motion is asked for: its place, or its direction as well."""


def _error(model: pin.Model, data: pin.Data, frame: int, target: pin.SE3) -> Array:
    """Return how far the flange is from where it should be, along its own axes. Shape (3 or 6,)."""
    error: Array = pin.log6(data.oMf[frame].actInv(target)).vector
    if model.nv >= _POSE:
        return error
    return np.asarray(data.oMf[frame].actInv(target).translation)


def _solve(
    model: pin.Model, data: pin.Data, frame: int, target: pin.SE3, q: Array, home: Array
) -> Array | None:
    """Return the angles near ``q`` whose flange is at ``target`` (Newton), or ``None``.

    An arm with joints to spare stays as near to its home as that allows, so that a turn closes.
    """
    for _ in range(_NEWTON):
        pin.framesForwardKinematics(model, data, q)
        jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL)
        error = _error(model, data, frame, target)
        jacobian = jacobian[: len(error)]
        if np.linalg.svd(jacobian, compute_uv=False)[-1] < _SMALLEST_SINGULAR_VALUE:
            return None
        if len(error) == model.nv:
            if np.linalg.norm(error) < _TOLERANCE:
                return q
            q = q + np.linalg.solve(jacobian, error)
            continue
        inverse = np.linalg.pinv(jacobian)
        aside = (home - q) - inverse @ (jacobian @ (home - q))
        if np.linalg.norm(error) < _TOLERANCE and np.linalg.norm(aside) < _TOLERANCE:
            return q
        q = q + inverse @ error + aside
    return None


@lru_cache(maxsize=32)
def follow_circle(circle: CircleTrajectory, arm: str) -> Array:
    """Return the joint motion along one turn.

    The flange keeps its direction; that of an arm with fewer than six joints does not.

    Args:
        circle: pose, radius, period and plane; the circle passes through the pose's flange.
        arm: which arm, by name.

    Returns:
        q_d [rad], v_d [rad/s], a_d [rad/s^2] at evenly spaced times. Shape (257, 3, n).

    Raises:
        UnreachableError: if the arm can't follow; says where on the circle, and which field is to
            blame.
    """
    known = arm_named(arm)
    model, data = known.model, known.model.createData()
    if model.nv < _POSITION:
        raise UnreachableError(
            f"a circle of the flange takes at least {_POSITION} joints, {known.title} has "
            f"{model.nv}: choose another kind of trajectory",
            field="kind",
        )
    frame = model.getFrameId(known.tip)
    q = home = np.array(circle.pose)
    pin.framesForwardKinematics(model, data, q)
    start = data.oMf[frame].copy()
    first, second = _AXES[circle.plane]
    omega, radius = 2.0 * np.pi / circle.period, circle.radius
    turn = np.empty((SAMPLES + 1, 3, model.nv))
    for n, angle in enumerate(np.linspace(0.0, 2.0 * np.pi, SAMPLES + 1)):
        along, rate, bend = np.zeros(3), np.zeros(3), np.zeros(3)
        along[first], along[second] = radius * (np.cos(angle) - 1.0), radius * np.sin(angle)
        rate[first], rate[second] = -np.sin(angle), np.cos(angle)
        bend[first], bend[second] = -np.cos(angle), -np.sin(angle)
        target = pin.SE3(start.rotation, start.translation + along)
        solution = _solve(model, data, frame, target, q, home)
        if solution is None:
            raise _out_of_reach(angle, radius, known)
        q = solution
        turn[n, 0] = q
        if model.nv == _POSE:
            moving = omega * radius * rate, omega**2 * radius * bend
            turn[n] = _motion(model, data, frame, q, *moving)
    if np.abs(turn[-1, 0] - turn[0, 0]).max() > _CLOSURE:
        raise UnreachableError(
            f"radius {radius:g} m takes the flange around an axis of the arm, so a joint winds up "
            "by 360° per turn: choose a smaller radius, or another pose"
        )
    if model.nv != _POSE:
        turn[:, 1:] = _rates(turn[:, 0], omega)
    return turn


def _rates(q: Array, omega: float) -> Array:
    """Return velocities and accelerations along a closed turn, by its Fourier series.

    Args:
        q: angles in [rad], evenly spaced, the first again at the end. Shape (m + 1, n).
        omega: 2 pi over the time of a turn in [rad/s].

    Returns:
        Shape (m + 1, 2, n).
    """
    waves = np.fft.rfft(q[:-1], axis=0)
    rate = 1j * omega * np.arange(len(waves))[:, None]
    found = [np.fft.irfft(waves * rate**power, len(q) - 1, axis=0) for power in (1, 2)]
    open_turn = np.stack(found, axis=1)
    return np.concatenate([open_turn, open_turn[:1]])


def _out_of_reach(angle: float, radius: float, arm: KnownArm) -> UnreachableError:
    if angle == 0.0:
        bend = "bend joints 3 and 5" if arm.name == SHIPPED else "bend the arm"
        return UnreachableError(
            "the circle's pose is singular (arm stretched, or two axes aligned), so the flange "
            f"cannot leave it in every direction: {bend}",
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
    pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
    drift = pin.getFrameClassicalAcceleration(model, data, frame, axes).vector
    a = np.linalg.solve(jacobian, np.concatenate([acceleration, np.zeros(3)]) - drift)
    return np.stack([q, v, a])
