"""Desired motions: angles, velocities and accelerations that belong together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import AD, QD, VD, WORK_ROWS
from slidetune.robot.motion.trajectory import CircleTrajectory, pack_trajectory, reference

Array = np.ndarray
KINDS: dict[str, dict[str, Any]] = {
    "sine": {
        "kind": "sine",
        "amplitude": [1, 0.5, -0.3, 2, 0, 3],
        "offset": [0, 1, 2, -1, 0.5, 0],
        "angular_frequency": [1, 2, 0.5, 0, 3, 20],
        "phase": [0, 1, -1, 2, 3, -3],
    },
    "quintic": {"kind": "quintic", "duration": 3.0},
    "hold": {"kind": "hold", "position": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]},
    "circle": {"kind": "circle", "radius": 0.12, "period": 2.0},
    "upright circle": {"kind": "circle", "radius": 0.08, "period": 5.0, "plane": "yz"},
}
START, END = np.radians([0, 90, 90, 180, 90, 0]), np.radians([90, 45, 30, 60, 36, 30])


def motion(trajectory: dict[str, Any], times: Array) -> tuple[Array, Array, Array]:
    """Return q_d, v_d, a_d at given times. Shapes (n, 6)."""
    numbers = pack(Experiment.from_document({"trajectory": trajectory})).trajectory
    work, rows = np.zeros((WORK_ROWS, JOINTS)), []
    for t in times:
        reference(float(t), numbers, work)
        rows.append(work[[QD, VD, AD]])
    q, v, a = np.moveaxis(np.array(rows), 1, 0)
    return q, v, a


@pytest.mark.parametrize("name", KINDS)
def test_velocity_and_acceleration_are_the_derivatives(name: str) -> None:
    times, h = np.linspace(0.01, 6.99, 397), 1e-4
    _, v, a = motion(KINDS[name], times)
    ahead, behind = motion(KINDS[name], times + h), motion(KINDS[name], times - h)
    # The quintic's acceleration bends where it begins and ends, the circle's from piece to piece.
    scale_v, scale_a = 1.0 + np.abs(v).max(axis=0), 1.0 + np.abs(a).max(axis=0)
    assert (np.abs(v - (ahead[0] - behind[0]) / (2 * h)) <= 1e-4 * scale_v).all()
    assert (np.abs(a - (ahead[1] - behind[1]) / (2 * h)) <= 2e-3 * scale_a).all()


def test_default_sine_is_the_paper_s() -> None:
    times = np.linspace(0.0, 10.0, 101)
    q, v, a = motion({"kind": "sine"}, times)
    for found, expected in ((q, np.sin(times)), (v, np.cos(times)), (a, -np.sin(times))):
        np.testing.assert_allclose(found, np.tile(expected[:, None], JOINTS), atol=1e-14)


def test_quintic_begins_and_ends_at_rest_in_the_published_poses() -> None:
    q, v, a = motion({"kind": "quintic", "duration": 4.0}, np.array([0.0, 4.0]))
    np.testing.assert_allclose(q, [START, END], atol=1e-12)
    np.testing.assert_allclose(v, 0.0, atol=1e-12)
    np.testing.assert_allclose(a, 0.0, atol=1e-12)


def test_quintic_is_symmetric_and_monotonous() -> None:
    times = np.linspace(0.0, 4.0, 81)
    q, v, _ = motion({"kind": "quintic", "duration": 4.0}, times)
    np.testing.assert_allclose(q + q[::-1], np.tile(START + END, (81, 1)), atol=1e-12)
    assert (v * np.sign(END - START) >= -1e-12).all()
    np.testing.assert_allclose(v.max(axis=0)[0], 1.875 * (END - START)[0] / 4.0, rtol=1e-9)


def test_quintic_is_held_at_its_end() -> None:
    q, v, a = motion({"kind": "quintic", "duration": 1.0}, np.array([1.0, 1.5, 100.0]))
    np.testing.assert_allclose(q, np.tile(END, (3, 1)), atol=1e-12)
    assert (np.abs([v, a]) <= 1e-12).all()


def test_hold_does_not_move() -> None:
    q, v, a = motion(KINDS["hold"], np.array([0.0, 0.5, 1.0, 50.0]))
    np.testing.assert_allclose(q, np.tile(KINDS["hold"]["position"], (4, 1)), atol=1e-15)
    assert not v.any()
    assert not a.any()


@pytest.mark.parametrize("name", ["circle", "upright circle"])
def test_circle_repeats_itself(name: str) -> None:
    times = np.linspace(0.0, 1.9, 50)
    period = KINDS[name]["period"]
    for one, other in zip(
        motion(KINDS[name], times), motion(KINDS[name], times + 3 * period), strict=True
    ):
        np.testing.assert_allclose(one, other, atol=1e-8)


def test_circle_can_not_be_packed_without_its_motion() -> None:
    with pytest.raises(ValueError, match="needs its joint motion"):
        pack_trajectory(CircleTrajectory())
