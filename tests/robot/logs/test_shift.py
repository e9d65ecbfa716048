"""Shifts in time are found to a fraction of a row, whatever the motion and the noise."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.logs.shift import find_shift, motion_of, motion_of_log
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError

QUINTIC = pack(
    Experiment.from_document(
        {
            "robot": {"model": "two_links"},
            "trajectory": {"kind": "quintic", "duration": 4.0},
            "lanes": {"A": {"law": "smc"}},
            "simulation": {"horizon": 5.0},
        }
    )
)


@settings(max_examples=40, deadline=None)
@given(shift=st.floats(-3.0, 3.0), period=st.sampled_from([0.002, 0.008, 0.01, 0.04]))
def test_a_known_shift_is_found_finer_than_a_row(shift: float, period: float) -> None:
    motion = motion_of(QUINTIC)
    time = np.arange(0.0, 6.0, period)
    found = find_shift(time, motion(time + shift)[0], motion, 5.0)
    assert found.seconds == pytest.approx(shift, abs=1e-7)
    assert found.rms < 1e-7


@pytest.mark.parametrize("seed", range(5))
def test_noise_costs_no_more_than_it_must(seed: int) -> None:
    motion, random = motion_of(QUINTIC), np.random.default_rng(seed)
    time, noise = np.arange(0.0, 6.0, 0.01), 0.01
    q, v = motion(time + 0.437)
    found = find_shift(time, q + noise * random.standard_normal(q.shape), motion, 5.0)
    deviation = noise / np.sqrt((v**2).sum())  # of the best unbiased estimate (Cramer and Rao)
    assert abs(found.seconds - 0.437) < 4.0 * deviation


def test_uneven_rows_are_no_obstacle() -> None:
    motion, random = motion_of(QUINTIC), np.random.default_rng(7)
    time = np.sort(random.uniform(0.0, 6.0, 700))
    time -= time[0]
    found = find_shift(time, motion(time - 1.234)[0], motion, 5.0)
    assert found.seconds == pytest.approx(-1.234, abs=1e-7)


def test_stillness_before_and_behind_is_no_better_fit() -> None:
    motion = motion_of(QUINTIC)
    time = np.arange(0.0, 30.0, 0.01)
    q, v = motion(time - 20.0)
    late = q - 0.02 * v  # an arm that follows late, and stands where it should
    found = find_shift(time, late, motion, 5.0)
    assert found.seconds == pytest.approx(-20.02, abs=2e-3)


def test_of_a_motion_that_repeats_itself_the_smallest_shift_counts_and_others_are_told() -> None:
    sine = pack(
        Experiment.from_document(
            {
                "robot": {"model": "two_links"},
                "lanes": {"A": {"law": "smc"}},
                "simulation": {"horizon": 20.0},
            }
        )
    )
    motion = motion_of(sine)
    time = np.arange(0.0, 15.0, 0.01)
    found = find_shift(time, motion(time + 0.3)[0], motion, 20.0)
    assert found.seconds == pytest.approx(0.3, abs=1e-6)
    assert any(abs(other - 0.3 - 2.0 * np.pi) < 1e-3 for other in found.others)
    long = np.arange(0.0, 300.0, 0.01)
    assert find_shift(long, motion(long + 0.3)[0], motion, 20.0).seconds == pytest.approx(0.3)


def test_two_logs_are_shifted_against_each_other() -> None:
    motion = motion_of(QUINTIC)
    first, second = np.arange(0.0, 6.0, 0.004), np.arange(0.0, 5.0, 0.01)
    one = Recording("one.csv", first, motion(first - 0.5)[0], True)
    other = Recording("other.csv", second, motion(second + 0.25)[0], True)
    found = find_shift(other.time, other.q, motion_of_log(one), one.duration)
    assert found.seconds == pytest.approx(0.75, abs=1e-5)


TURNING = np.ones(2, dtype=bool)


@settings(max_examples=40, deadline=None)
@given(shift=st.floats(-3.0, 3.0), turns=st.lists(st.integers(-3, 3), min_size=2, max_size=2))
def test_a_shift_is_found_whatever_the_turn(shift: float, turns: list[int]) -> None:
    motion, random = motion_of(QUINTIC), np.random.default_rng(3)
    time = np.arange(0.0, 6.0, 0.01)
    q = motion(time + shift)[0] + 1e-4 * random.standard_normal((len(time), 2))
    found = find_shift(time, q + 2.0 * np.pi * np.array(turns), motion, 5.0, TURNING)
    assert found.seconds == pytest.approx(shift, abs=1e-4)
    np.testing.assert_array_equal(found.turns, turns)


def test_a_joint_that_slides_has_no_turns() -> None:
    motion = motion_of(QUINTIC)
    time = np.arange(0.0, 6.0, 0.01)
    q = motion(time + 0.4)[0] + [0.0, 6.4]
    with pytest.raises(RecordingError, match="is it a log of this motion"):
        find_shift(time, q, motion, 5.0, np.array([True, False]))
    turns = find_shift(time, q, motion, 5.0, TURNING)
    np.testing.assert_array_equal(turns.turns, [0.0, 1.0])


def test_a_log_of_several_turns_that_fits_as_it_is_keeps_them() -> None:
    def spin(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        inside = np.clip(time, 0.0, 20.0)
        moving = ((time > 0.0) & (time < 20.0))[:, None] * np.array([[2.0, 0.0]])
        return np.column_stack([2.0 * inside, 0.0 * inside]), moving

    time = np.arange(0.0, 4.0, 0.01)
    found = find_shift(time, spin(time + 9.5)[0], spin, 20.0, TURNING)
    assert found.seconds == pytest.approx(9.5, abs=1e-6)
    np.testing.assert_array_equal(found.turns, [0.0, 0.0])
    # A turn of it takes pi seconds: what is as good without its turns is told.
    assert any(abs(other - 9.5 + np.pi) < 1e-3 for other in found.others)
    wrapped = spin(time + 9.5)[0] - [6.0 * np.pi, 0.0]
    found = find_shift(time, wrapped, spin, 20.0, TURNING)
    assert found.seconds == pytest.approx(9.5 - 3.0 * np.pi, abs=1e-6)


def test_another_motion_is_told() -> None:
    motion = motion_of(QUINTIC)
    time = np.arange(0.0, 6.0, 0.01)
    rising = np.column_stack([0.2 * time, 0.2 * time]) + 5.0
    with pytest.raises(RecordingError, match="is it a log of this motion"):
        find_shift(time, rising, motion, 5.0)


def test_where_nothing_moves_no_shift_is_guessed() -> None:
    time = np.arange(0.0, 6.0, 0.01)
    with pytest.raises(RecordingError, match="give it by hand"):
        find_shift(time, np.zeros((600, 2)), motion_of(QUINTIC), 5.0)
