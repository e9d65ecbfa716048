"""The desired motion of the reference: q_d, v_d and a_d as functions of time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.interpolate import make_interp_spline

from tests.reference.arm import arm

Array = np.ndarray
Motion = Callable[[float], tuple[Array, Array, Array]]

_SAMPLES = 720
"""Poses on a circle, between which a periodic spline of degree five runs."""
_PLAIN_ARM = {
    "inertials": "vendor",
    "inertia_scale": 1.0,
    "armature": 0.0,
    "payload": {"mass": 0.0, "center": [0, 0, 0]},
}


def motion(trajectory: dict[str, Any], joints: int) -> tuple[Motion, list[float]]:
    """Return the motion of the section ``trajectory``, and the times at which it is not smooth."""
    kind = trajectory["kind"]
    if kind == "sine":
        return _sine(trajectory, joints), []
    if kind == "quintic":
        return _quintic(trajectory), [trajectory["duration"]]
    if kind == "hold":
        pose, still = np.array(trajectory["position"], dtype=float), np.zeros(joints)
        return lambda t: (pose, still, still), []
    if kind == "recorded":
        return _recorded(trajectory, joints)
    return _circle(trajectory), []


def _sine(trajectory: dict[str, Any], joints: int) -> Motion:
    def wide(value: Any) -> Array:
        return np.broadcast_to(np.array(value, dtype=float), joints).copy()

    size, omega = wide(trajectory["amplitude"]), wide(trajectory["angular_frequency"])
    phase, offset = wide(trajectory["phase"]), wide(trajectory["offset"])

    def at(t: float) -> tuple[Array, Array, Array]:
        angle = omega * t + phase
        swing = size * np.sin(angle)
        return offset + swing, size * omega * np.cos(angle), -omega * omega * swing

    return at


def _quintic(trajectory: dict[str, Any]) -> Motion:
    start, end = np.array(trajectory["start"]), np.array(trajectory["end"])
    duration = trajectory["duration"]
    blend = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6])
    rate, bend = blend.deriv(), blend.deriv(2)

    def at(t: float) -> tuple[Array, Array, Array]:
        u = min(max(t / duration, 0.0), 1.0)
        span = end - start
        return start + span * blend(u), span * rate(u) / duration, span * bend(u) / duration**2

    return at


def _circle(trajectory: dict[str, Any]) -> Motion:
    """Follow a circle of the last frame, whose direction is kept, by Newton's method."""
    model = arm(_PLAIN_ARM)
    data, tip = model.createData(), model.njoints - 1
    q = np.array(trajectory["pose"], dtype=float)
    pin.forwardKinematics(model, data, q)
    start = data.oMi[tip].copy()
    first, second = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}[trajectory["plane"]]
    poses = []
    for angle in np.linspace(0.0, 2.0 * np.pi, _SAMPLES + 1):
        along = np.zeros(3)
        along[first] = trajectory["radius"] * (np.cos(angle) - 1.0)
        along[second] = trajectory["radius"] * np.sin(angle)
        goal = pin.SE3(start.rotation, start.translation + along)
        for _ in range(50):
            pin.computeJointJacobians(model, data, q)
            error = pin.log6(data.oMi[tip].actInv(goal)).vector
            if np.abs(error).max() < 1e-13:
                break
            q = q + np.linalg.solve(pin.getJointJacobian(model, data, tip, pin.LOCAL), error)
        poses.append(q)
    poses[-1] = poses[0]
    period = trajectory["period"]
    time = np.linspace(0.0, period, _SAMPLES + 1)
    spline = make_interp_spline(time, np.array(poses), k=5, bc_type="periodic")
    speed, bend = spline.derivative(1), spline.derivative(2)

    def at(t: float) -> tuple[Array, Array, Array]:
        turn = t % period
        return spline(turn), speed(turn), bend(turn)

    return at


def _recorded(trajectory: dict[str, Any], joints: int) -> tuple[Motion, list[float]]:
    """Follow the spline of degree five through the waypoints, at rest at the last one."""
    rows = [line.split() for line in trajectory["waypoints"].split("\n") if line]
    poses, spacing = np.array(rows, dtype=float), trajectory["spacing"]
    time = np.arange(len(poses)) * spacing
    knots = np.concatenate([[0.0] * 6, time[3:-1], [time[-1]] * 6])
    rest = [(1, np.zeros(joints)), (2, np.zeros(joints))]
    spline = make_interp_spline(time, poses, k=5, t=knots, bc_type=(None, rest))
    speed, bend, still = spline.derivative(1), spline.derivative(2), np.zeros(joints)

    def at(t: float) -> tuple[Array, Array, Array]:
        if t >= time[-1]:
            return poses[-1], still, still
        return spline(t), speed(t), bend(t)

    return at, [float(time[-1])]
