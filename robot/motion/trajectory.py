"""Desired motion q_d, v_d, a_d at a time."""

from __future__ import annotations

from math import cos, sin
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from slidetune.robot.fields.quantity import JOINTS, JointVector, Number, PerJoint, Section, field
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import AD, QD, VD
from slidetune.robot.motion.recorded import RecordedTrajectory, recorded_samples

Array = np.ndarray

SINE, QUINTIC, TABLE, RECORDED = 0.0, 1.0, 2.0, 3.0
# Where the numbers of a packed trajectory stand: its kind, then those of that kind.
KIND = 0
SINES = 1  # amplitudes, angular frequencies, phases and offsets, each of all joints
DURATION, ENDS = 1, 2  # then start and end, each of all joints
PERIOD, COUNT, SAMPLES = 1, 2, 3  # then q_d, v_d and a_d of every sample

_DEGREE = np.pi / 180.0


def _degrees(*angles: float) -> tuple[float, ...]:
    return tuple(float(angle * _DEGREE) for angle in angles)


class SineTrajectory(Section):
    """A sine on every joint: the paper's simulation."""

    kind: Literal["sine"] = "sine"
    amplitude: PerJoint = field(
        1.0,
        title="Amplitude",
        symbol="A",
        unit="rad",
        low=-3.0,
        high=3.0,
        step=0.01,
        source="published",
        meaning="Amplitude of the joint's sine.",
    )
    angular_frequency: PerJoint = field(
        1.0,
        title="Angular frequency",
        symbol="ω",
        unit="rad/s",
        low=0.0,
        high=20.0,
        step=0.05,
        source="published",
        meaning="Angular frequency of the sine; 1 rad/s as published.",
    )
    phase: PerJoint = field(
        0.0,
        title="Phase",
        symbol="α₀",
        unit="rad",
        low=-3.1416,
        high=3.1416,
        step=0.01,
        meaning="Phase at t = 0.",
    )
    offset: PerJoint = field(
        0.0,
        title="Offset",
        symbol="q₀",
        unit="rad",
        low=-6.28,
        high=6.28,
        step=0.01,
        meaning="Mean angle of the sine.",
    )


class QuinticTrajectory(Section):
    """A fifth-degree polynomial from one pose to another: the paper's experiment."""

    kind: Literal["quintic"] = "quintic"
    start: JointVector = field(
        _degrees(0, 90, 90, 180, 90, 0),
        title="Start",
        symbol="q_a",
        unit="rad",
        low=-6.2832,
        high=6.2832,
        step=0.01,
        source="published",
        meaning="Pose at t = 0.",
    )
    end: JointVector = field(
        _degrees(90, 45, 30, 60, 36, 30),
        title="End",
        symbol="q_b",
        unit="rad",
        low=-6.2832,
        high=6.2832,
        step=0.01,
        source="published",
        meaning="Pose at the end of the move, held from then on.",
    )
    duration: Number = field(
        10.0,
        title="Duration",
        symbol="T",
        unit="s",
        low=0.2,
        high=60.0,
        step=0.1,
        source="inferred",
        meaning="Time from start to end; not given in the paper.",
    )


class HoldTrajectory(Section):
    """A constant pose: response to an initial error or to a push."""

    kind: Literal["hold"] = "hold"
    position: JointVector = field(
        _degrees(0, 90, 90, 90, -90, 0),
        title="Pose",
        symbol="q_d",
        unit="rad",
        low=-6.2832,
        high=6.2832,
        step=0.01,
        meaning="Joint angles to hold.",
    )


class CircleTrajectory(Section):
    """A circle of the flange at constant orientation, by inverse kinematics."""

    kind: Literal["circle"] = "circle"
    pose: JointVector = field(
        _degrees(0, 90, 90, 90, -90, 0),
        title="Pose on the circle",
        symbol="q_a",
        unit="rad",
        low=-6.2832,
        high=6.2832,
        step=0.01,
        meaning="Joint angles at the start and end of the circle; by default the tool points down.",
    )
    radius: Number = field(
        0.1,
        title="Radius",
        symbol="R",
        unit="m",
        low=0.005,
        high=0.5,
        step=0.005,
        meaning="Radius of the circle; refused if the arm cannot follow it.",
    )
    period: Number = field(
        4.0,
        title="Period",
        symbol="T",
        unit="s",
        low=0.5,
        high=60.0,
        step=0.1,
        meaning="Time for one revolution.",
    )
    plane: Literal["xy", "xz", "yz"] = field(
        "xy", title="Plane", meaning="Plane of the circle in the base frame."
    )


Trajectory = Annotated[
    SineTrajectory | QuinticTrajectory | HoldTrajectory | CircleTrajectory | RecordedTrajectory,
    Field(discriminator="kind"),
]


def _table(kind: float, period: float, samples: Array) -> Array:
    head = np.array([kind, period, float(len(samples) - 1)])
    return np.concatenate([head, samples.ravel()])


def pack_trajectory(
    trajectory: Trajectory, turn: Array | None = None, joints: int = JOINTS
) -> Array:
    """Return a trajectory as numbers for ``reference``.

    Args:
        trajectory: the trajectory.
        turn: for a circle, q_d, v_d and a_d along one turn (``follow_circle``).
            Shape (m + 1, 3, n).
        joints: how many joints the arm has.

    Returns:
        The kind, then its own numbers. Shape (m,).
    """
    if isinstance(trajectory, SineTrajectory):
        block = np.empty((4, joints))
        block[0], block[1] = trajectory.amplitude, trajectory.angular_frequency
        block[2], block[3] = trajectory.phase, trajectory.offset
        return np.concatenate([[SINE], block.ravel()])
    if isinstance(trajectory, QuinticTrajectory):
        return np.array([QUINTIC, trajectory.duration, *trajectory.start, *trajectory.end])
    if isinstance(trajectory, HoldTrajectory):
        return np.array([QUINTIC, 1.0, *trajectory.position, *trajectory.position])
    if isinstance(trajectory, RecordedTrajectory):
        samples = recorded_samples(trajectory, joints)
        return _table(RECORDED, trajectory.spacing * (len(samples) - 1), samples)
    if turn is None:
        raise ValueError("a circle needs its joint motion along one turn")
    return _table(TABLE, trajectory.period, turn)


@kernel
def _sine(t, numbers, work):  # type: ignore[no-untyped-def]
    sine, cosine = 0.0, 1.0
    last = 0.0
    for j in range(JOINTS):
        amplitude, omega = numbers[SINES + j], numbers[SINES + JOINTS + j]
        angle = omega * t + numbers[SINES + 2 * JOINTS + j]
        if angle != last:  # joints that swing together share it, as in the paper
            sine, cosine, last = sin(angle), cos(angle), angle
        work[QD, j] = numbers[SINES + 3 * JOINTS + j] + amplitude * sine
        work[VD, j] = amplitude * omega * cosine
        work[AD, j] = -omega * omega * amplitude * sine


@kernel
def _quintic(t, numbers, work):  # type: ignore[no-untyped-def]
    duration = numbers[DURATION]
    u = min(max(t / duration, 0.0), 1.0)
    blend = u * u * u * (10.0 + u * (6.0 * u - 15.0))
    rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration
    bend = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (duration * duration)
    for j in range(JOINTS):
        start = numbers[ENDS + j]
        span = numbers[ENDS + JOINTS + j] - start
        work[QD, j] = start + span * blend
        work[VD, j] = span * rate
        work[AD, j] = span * bend


@kernel
def _interpolate(turns, numbers, work):  # type: ignore[no-untyped-def]
    """Quintic Hermite interpolation, so that q_d, v_d and a_d belong together."""
    period, count = numbers[PERIOD], int(numbers[COUNT])
    place = turns * count
    index = min(int(place), count - 1)
    u, h = place - index, period / count
    first = SAMPLES + index * 3 * JOINTS
    second = first + 3 * JOINTS
    for j in range(JOINTS):
        q0, q1 = numbers[first + j], numbers[second + j]
        v0, v1 = numbers[first + JOINTS + j], numbers[second + JOINTS + j]
        a0, a1 = numbers[first + 2 * JOINTS + j], numbers[second + 2 * JOINTS + j]
        rise = q1 - q0 - h * v0 - 0.5 * h * h * a0
        slope = h * (v1 - v0) - h * h * a0
        curve = h * h * (a1 - a0)
        c3 = 10.0 * rise - 4.0 * slope + 0.5 * curve
        c4 = -15.0 * rise + 7.0 * slope - curve
        c5 = 6.0 * rise - 3.0 * slope + 0.5 * curve
        work[QD, j] = q0 + u * (h * v0 + u * (0.5 * h * h * a0 + u * (c3 + u * (c4 + u * c5))))
        work[VD, j] = (
            h * v0 + u * (h * h * a0 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))
        ) / h
        work[AD, j] = (h * h * a0 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / (h * h)


@kernel
def _recorded(t, numbers, work):  # type: ignore[no-untyped-def]
    """Follow a recording; before its start and after its end its pose is held."""
    turns = t / numbers[PERIOD]
    _interpolate(min(max(turns, 0.0), 1.0), numbers, work)
    if turns < 0.0 or turns >= 1.0:
        for j in range(JOINTS):
            work[VD, j], work[AD, j] = 0.0, 0.0


@kernel
def reference(t, numbers, work):  # type: ignore[no-untyped-def]
    """Write the desired motion at ``t`` [s] into QD [rad], VD [rad/s] and AD [rad/s^2].

    Args:
        t: time in [s].
        numbers: what ``pack_trajectory`` returned. Shape (m,).
        work: workspace.
    """
    kind = numbers[KIND]
    if kind == SINE:
        _sine(t, numbers, work)
    elif kind == QUINTIC:
        _quintic(t, numbers, work)
    elif kind == RECORDED:
        _recorded(t, numbers, work)
    else:
        turns = t / numbers[PERIOD]
        _interpolate(turns - np.floor(turns), numbers, work)
