"""A recording becomes a desired motion: close to it, smooth, and checked against the limits."""

from __future__ import annotations

import numpy as np
import pytest

from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.motion.along import desired_motion
from slidetune.robot.motion.recorded import MOST_NUMBERS
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.reference import STOP, motion_at, reference_of
from slidetune.robot.recordings.refused import RecordingError

Array = np.ndarray
ARM = arm_named("two_links")


def move(time: Array, end: float) -> tuple[Array, Array, Array]:
    """Return a move of both joints from rest to rest, with its derivatives. Shapes (n, 2)."""
    u = np.clip(time / end, 0.0, 1.0)[:, None]
    span = np.array([1.2, -0.7])
    q = span * u**3 * (10.0 + u * (6.0 * u - 15.0))
    v = span * 30.0 * u**2 * (1.0 - u) ** 2 / end
    a = span * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / end**2
    return q, v, a


def recording(q: Array, time: Array) -> Recording:
    return Recording("log.csv", time, q, measured=True)


def test_a_move_without_noise_is_met_with_its_derivatives() -> None:
    time = np.arange(0.0, 3.0 + 1e-9, 0.01)
    q, v, a = move(time, 3.0)
    found = reference_of(recording(q, time), ARM)
    assert (found.rms < 2e-5).all()
    assert not found.remarks
    for column, other, atol in zip(
        motion_at(found.trajectory, time, 2), (q, v, a), (1e-4, 1e-3, 2e-2), strict=True
    ):
        np.testing.assert_allclose(column, other, atol=atol)


@pytest.mark.parametrize("noise", [1e-4, 1e-3])
def test_noise_is_taken_off_and_told(noise: float) -> None:
    time = np.arange(0.0, 4.0, 0.002)
    q, v, a = move(time, 4.0)
    random = np.random.default_rng(2)
    found = reference_of(recording(q + noise * random.standard_normal(q.shape), time), ARM)
    np.testing.assert_allclose(found.rms, noise, rtol=0.1)
    smooth_q, smooth_v, smooth_a = motion_at(found.trajectory, time, 2)
    # A twentieth of the rows' noise is left, and no derivative of differences of rows.
    assert np.sqrt(np.mean((smooth_q - q) ** 2)) < 0.3 * noise
    assert np.sqrt(np.mean((smooth_v - v) ** 2)) < 10.0 * noise
    assert np.sqrt(np.mean((smooth_a - a) ** 2)) < 200.0 * noise


def test_the_residual_is_that_of_the_motion_as_it_is_run() -> None:
    time = np.arange(0.0, 3.0, 0.004)
    random = np.random.default_rng(3)
    rows = move(time, 3.0)[0] + 1e-3 * random.standard_normal((len(time), 2))
    found = reference_of(recording(rows, time), ARM)
    document = {"robot": {"model": "two_links"}, **found.patch()}
    numbers = pack(Experiment.from_document(document)).trajectory
    q_d, v_d = desired_motion(numbers, time, 2)
    np.testing.assert_allclose(np.abs(rows - q_d).max(axis=0), found.greatest, rtol=1e-9)
    np.testing.assert_allclose(np.sqrt(np.mean((rows - q_d) ** 2, axis=0)), found.rms, rtol=1e-9)
    np.testing.assert_allclose(v_d, motion_at(found.trajectory, time, 2)[1], atol=1e-9)


def test_uneven_rows_make_the_same_motion() -> None:
    random = np.random.default_rng(4)
    time = np.sort(random.uniform(0.0, 3.0, 900))
    time[0], time[-1] = 0.0, 3.0
    found = reference_of(recording(move(time, 3.0)[0], time), ARM)
    even = np.linspace(0.0, 3.0, 301)
    np.testing.assert_allclose(
        motion_at(found.trajectory, even, 2)[0], move(even, 3.0)[0], atol=2e-4
    )


def test_a_recording_that_ends_while_it_moves_comes_to_rest_behind_it() -> None:
    time = np.arange(0.0, 2.0 + 1e-9, 0.005)
    q = np.column_stack([np.sin(2.0 * time), 0.5 * np.cos(3.0 * time)])
    found = reference_of(recording(q, time), ARM)
    assert any("comes to rest in 0.5 s more" in remark for remark in found.remarks)
    assert (found.rms < 1e-3).all()
    end = 2.0 + STOP
    after, v, a = motion_at(found.trajectory, np.array([end + 0.1, end + 5.0]), 2)
    np.testing.assert_array_equal(after[0], after[1])
    assert not v.any()
    assert not a.any()
    behind = np.linspace(2.0, end, 51)
    assert np.abs(motion_at(found.trajectory, behind, 2)[1]).max() < 3.0


def test_limits_of_angle_and_velocity_are_told_with_joint_and_time() -> None:
    time = np.arange(0.0, 2.0 + 1e-9, 0.005)
    q = np.column_stack([8.0 * move(time, 2.0)[0][:, 0], np.zeros(len(time))])
    remarks = reference_of(recording(q, time), ARM).remarks
    assert any(remark.startswith("shoulder is at 9.6 after") for remark in remarks)
    assert any(
        "shoulder moves at 9 per s after 1 s, its limit is 8" in remark for remark in remarks
    )
    assert not any("elbow" in remark for remark in remarks)


def test_the_longest_motion_has_as_many_waypoints_as_an_experiment_may_hold() -> None:
    time = np.arange(0.0, 120.0, 0.02)
    q = np.column_stack([np.sin(9.0 * time + j) for j in range(6)])
    found = reference_of(Recording("log.csv", time, q, True), arm_named("jaka_zu5"))
    assert len(found.trajectory.waypoints.splitlines()) <= MOST_NUMBERS // 6
    assert (found.greatest > 0.05).all()  # too few for it: told, not hidden


def test_a_spacing_can_be_chosen_within_its_bounds() -> None:
    time = np.arange(0.0, 3.0, 0.01)
    rows = recording(move(time, 3.0)[0], time)
    assert reference_of(rows, ARM, 0.25).trajectory.spacing == 0.25
    for wrong in (1e-4, 2.0):
        with pytest.raises(RecordingError, match=r"spacing must be in \[0.01, 0.997\] s"):
            reference_of(rows, ARM, wrong)


def test_an_instant_is_no_motion() -> None:
    time = 1e-4 * np.arange(20)
    with pytest.raises(RecordingError, match="can't be a desired motion"):
        reference_of(recording(np.zeros((20, 2)), time), ARM)
