"""The flange on a circle, by inverse kinematics."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slidetune.robot.arm.arm import build_model, flange_positions, shipped_places
from slidetune.robot.arm.known import FLANGE, SHIPPED
from slidetune.robot.arm.section import Robot
from slidetune.robot.errors import InvalidExperimentError, UnreachableError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.motion.along import desired_motion
from slidetune.robot.motion.circle import SAMPLES, follow_circle
from slidetune.robot.motion.trajectory import CircleTrajectory

Array = np.ndarray
AXES = {"xy": (0, 1, 2), "xz": (0, 2, 1), "yz": (1, 2, 0)}
STRETCHED = (0.0,) * JOINTS
CIRCLES = [
    CircleTrajectory(),
    CircleTrajectory(plane="xz", radius=0.08),
    CircleTrajectory(plane="yz", radius=0.05, period=0.5),
    CircleTrajectory(radius=0.005, period=60.0),
    CircleTrajectory(pose=(0.5, 1.2, 1.4, 1.0, -1.2, 2.0), radius=0.1),
]


def desired(circle: CircleTrajectory, turns: float = 1.0, rows: int = 3001) -> tuple[Array, ...]:
    """Return times [s], q_d and v_d along a circle, between its samples too."""
    document = {"trajectory": circle.model_dump()}
    times = np.linspace(0.0, turns * circle.period, rows)
    return times, *desired_motion(pack(Experiment.from_document(document)).trajectory, times, 6)


def off_circle(circle: CircleTrajectory, q: Array) -> float:
    """Return how far the flange leaves the circle in [m]."""
    points = flange_positions(q, shipped_places())
    first, second, normal = AXES[circle.plane]
    center = flange_positions(np.array([circle.pose]), shipped_places())[0]
    center[first] -= circle.radius
    away = points - center
    radial = np.hypot(away[:, first], away[:, second]) - circle.radius
    return float(max(np.abs(radial).max(), np.abs(away[:, normal]).max()))


@pytest.mark.parametrize("circle", CIRCLES)
def test_flange_is_on_the_circle(circle: CircleTrajectory) -> None:
    _, q, _ = desired(circle)
    assert off_circle(circle, q) <= 1e-6


@pytest.mark.parametrize("circle", CIRCLES)
def test_flange_runs_evenly_and_keeps_its_direction(circle: CircleTrajectory) -> None:
    times, q, _ = desired(circle)
    first, second, _ = AXES[circle.plane]
    points = flange_positions(q, shipped_places())
    start = points[0].copy()
    angle = 2.0 * np.pi * times / circle.period
    expected = np.tile(start, (len(times), 1))
    expected[:, first] += circle.radius * (np.cos(angle) - 1.0)
    expected[:, second] += circle.radius * np.sin(angle)
    np.testing.assert_allclose(points, expected, atol=1e-6)
    model = build_model(Robot())
    data, frame = model.createData(), model.getFrameId(FLANGE)
    rotations = []
    for row in q[::100]:
        pin.framesForwardKinematics(model, data, row)
        rotations.append(data.oMf[frame].rotation.copy())
    np.testing.assert_allclose(rotations, np.tile(rotations[0], (len(rotations), 1, 1)), atol=1e-6)


@pytest.mark.parametrize("circle", CIRCLES)
def test_circle_is_closed_and_begins_in_its_pose(circle: CircleTrajectory) -> None:
    turn = follow_circle(circle, SHIPPED)
    assert turn.shape == (SAMPLES + 1, 3, JOINTS)
    np.testing.assert_allclose(turn[0, 0], circle.pose, atol=1e-12)
    np.testing.assert_allclose(turn[-1], turn[0], atol=1e-6)


@pytest.mark.parametrize("circle", CIRCLES)
def test_velocity_is_the_derivative_of_the_angle(circle: CircleTrajectory) -> None:
    times, q, v = desired(circle, turns=1.3)
    difference = (q[2:] - q[:-2]) / (times[2:] - times[:-2])[:, None]
    np.testing.assert_allclose(v[1:-1], difference, atol=2e-5 * (1.0 + np.abs(v).max()))


@pytest.mark.parametrize("circle", CIRCLES)
def test_acceleration_is_the_derivative_of_the_velocity(circle: CircleTrajectory) -> None:
    _, v, a = np.moveaxis(follow_circle(circle, SHIPPED), 1, 0)
    h = circle.period / SAMPLES
    # Fourth order, so that the samples are close enough.
    difference = (8.0 * (v[3:-1] - v[1:-3]) - (v[4:] - v[:-4])) / (12.0 * h)
    np.testing.assert_allclose(a[2:-2], difference, atol=1e-3 * (1.0 + np.abs(a).max()))


def test_speed_scales_with_the_period() -> None:
    slow, fast = (follow_circle(CircleTrajectory(period=period), SHIPPED) for period in (4.0, 2.0))
    np.testing.assert_allclose(fast[:, 0], slow[:, 0], atol=1e-9)
    np.testing.assert_allclose(fast[:, 1], 2.0 * slow[:, 1], atol=1e-8)
    np.testing.assert_allclose(fast[:, 2], 4.0 * slow[:, 2], atol=1e-7)


def refusal(**changes: Any) -> str:
    with pytest.raises(UnreachableError) as caught:
        follow_circle(CircleTrajectory(**changes), SHIPPED)
    return str(caught.value)


def test_too_large_a_circle_is_refused_with_the_place_and_the_way_out() -> None:
    text = refusal(radius=0.5)
    assert "0.5 m" in text
    assert "° of the turn" in text
    assert "choose a smaller one" in text


def test_a_singular_pose_is_refused_as_such() -> None:
    assert "singular" in refusal(pose=STRETCHED)
    with pytest.raises(InvalidExperimentError) as caught:
        pack(Experiment.from_document({"trajectory": {"kind": "circle", "pose": STRETCHED}}))
    (field,) = caught.value.fields
    assert (field.path, field.value) == ("trajectory.pose", STRETCHED)


def test_an_unreachable_circle_blames_the_radius() -> None:
    with pytest.raises(InvalidExperimentError) as caught:
        pack(Experiment.from_document({"trajectory": {"kind": "circle", "radius": 0.5}}))
    (field,) = caught.value.fields
    assert (field.path, field.value) == ("trajectory.radius", 0.5)


def test_a_circle_round_the_base_would_wind_a_joint_up() -> None:
    behind = CircleTrajectory().pose
    pose = (np.pi, *behind[1:])
    assert follow_circle(CircleTrajectory(pose=pose), SHIPPED).shape
    assert "winds up by 360°" in refusal(pose=pose, radius=0.45)


def turn_or_field(circle: CircleTrajectory) -> Array | str:
    """Return the joint motion, or the field that is to blame for there being none."""
    try:
        return follow_circle(circle, SHIPPED)
    except UnreachableError as error:
        return error.field


@settings(max_examples=60, deadline=None)
@given(
    pose=st.tuples(*[st.floats(-3.0, 3.0)] * JOINTS),
    radius=st.floats(0.005, 0.5),
    plane=st.sampled_from(["xy", "xz", "yz"]),
)
def test_any_circle_is_followed_or_refused(
    pose: tuple[float, ...], radius: float, plane: str
) -> None:
    circle = CircleTrajectory(pose=pose, radius=radius, plane=plane)
    turn = turn_or_field(circle)
    if isinstance(turn, str):
        assert turn in ("pose", "radius")
        return
    assert np.isfinite(turn).all()
    assert np.abs(np.diff(turn[:, 0], axis=0)).max() < 0.5
    _, q, _ = desired(circle, rows=501)
    assert off_circle(circle, q) <= 1e-6
