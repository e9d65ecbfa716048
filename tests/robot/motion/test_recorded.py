"""A recorded motion: a spline through waypoints, as an independent one, and what follows it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slidetune.robot.arm.known import arm_named
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.motion.recorded import (
    FEWEST_WAYPOINTS,
    MOST_NUMBERS,
    waypoint_text,
    waypoints_of,
)
from tests.reference.motion import motion as other_motion
from tests.reference.solve import solve
from tests.robot.motion.test_trajectory import motion

Array = np.ndarray


def waypoints(count: int, joints: int = 6, seed: int = 0) -> Array:
    """Return a swing of every joint at the times 0 to 1, rounded as it is written."""
    random = np.random.default_rng(seed)
    u = np.linspace(0.0, 1.0, count)[:, None]
    size, phase = random.uniform(0.2, 1.0, joints), random.uniform(0.0, 2.0 * np.pi, joints)
    return np.round(size * np.sin(4.0 * u + phase), 7)


def recorded(count: int = 20, spacing: float = 0.1, joints: int = 6, seed: int = 0) -> Any:
    return {
        "kind": "recorded",
        "spacing": spacing,
        "waypoints": waypoint_text(waypoints(count, joints, seed)),
    }


@settings(max_examples=30, deadline=None)
@given(
    count=st.integers(FEWEST_WAYPOINTS, 60),
    spacing=st.floats(0.005, 2.0),
    seed=st.integers(0, 1000),
)
def test_it_is_the_spline_of_an_independent_evaluation(
    count: int, spacing: float, seed: int
) -> None:
    trajectory = recorded(count, spacing, seed=seed)
    end = spacing * (count - 1)
    times = np.linspace(0.0, end * (1.0 - 1e-9), 83)
    found, expected = motion(trajectory, times), other_motion(trajectory, 6)[0]
    for order, column in enumerate(found):
        other = np.array([expected(t)[order] for t in times])
        scale = max(1.0, float(np.abs(other).max()))
        np.testing.assert_allclose(column, other, atol=1e-8 * scale)


def test_it_passes_its_waypoints_and_rests_at_the_last() -> None:
    times = 0.1 * np.arange(20)
    q, v, a = motion(recorded(), times)
    np.testing.assert_allclose(q, waypoints(20), atol=1e-12)
    assert not v[-1].any()
    assert not a[-1].any()


def test_its_end_is_held_and_so_is_what_is_before_its_start() -> None:
    q, v, a = motion(recorded(), np.array([-1.0, -1e-9, 1.9, 2.0, 100.0]))
    np.testing.assert_allclose(q[:2], np.tile(waypoints(20)[0], (2, 1)), atol=1e-12)
    np.testing.assert_allclose(q[2:], np.tile(waypoints(20)[-1], (3, 1)), atol=1e-12)
    np.testing.assert_allclose([v, a], 0.0, atol=1e-9)


def test_acceleration_and_jerk_have_no_jumps() -> None:
    times = np.linspace(1e-6, 1.9 - 1e-6, 40_001)
    _, _, a = motion(recorded(), times)
    jerk = np.diff(a, axis=0) / (times[1] - times[0])
    assert np.abs(np.diff(a, axis=0)).max() < 0.05 * np.ptp(a, axis=0).max()
    assert np.abs(np.diff(jerk, axis=0)).max() < 0.05 * np.ptp(jerk, axis=0).max()


@pytest.mark.parametrize("law", ["smc", "computed_torque"])
def test_a_loop_that_follows_it_is_as_right_as_it_says(law: str) -> None:
    document = {
        "trajectory": recorded(14, 0.1),
        "lanes": {"A": {"law": law}},
        "simulation": {"horizon": 1.5, "initial_velocity": "rest"},
    }
    experiment = Experiment.from_document(document)
    (lane,) = simulate(experiment).lanes.values()
    time = np.linspace(0.0, 1.5, 31)
    truth = solve(experiment.document(), time, 1e-9)
    estimate = lane.accuracy.error_estimate
    assert estimate is not None
    assert estimate < 1e-3
    assert np.abs(lane.q[::50] - truth.q).max() <= max(1e-6, 3.0 * estimate)


@pytest.mark.parametrize("arm", ["pendulum", "two_links"])
def test_arms_of_few_joints_follow_one_too(arm: str) -> None:
    joints = arm_named(arm).joints
    document = {
        "robot": {"model": arm},
        "trajectory": recorded(16, 0.1, joints),
        "lanes": {"A": {"law": "computed_torque"}},
        "simulation": {"horizon": 2.0},
    }
    run = simulate(Experiment.from_document(document))
    assert np.abs(run.lanes["A"].e).max() < 1e-3
    assert isinstance(pack(run.experiment).model, pin.Model)


def test_a_preset_keeps_it_readable() -> None:
    experiment = Experiment.from_document({"trajectory": {**recorded(), "origin": "log.csv"}})
    text = experiment_to_yaml(experiment)
    assert experiment_from_yaml(text) == experiment
    first = "  ".join(f"{value:.7f}" for value in waypoints(20)[0])
    assert f"  waypoints: |\n    {first}\n" in text


def test_blanks_make_no_other_motion() -> None:
    plain = recorded()
    loose = {**plain, "waypoints": "\n\n" + plain["waypoints"].replace("  ", " \t ") + "\n"}
    one, other = (Experiment.from_document({"trajectory": t}) for t in (plain, loose))
    assert one == other


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "must be those of a recording"),
        ("1 2 3 4 5 6\n" * 3, "got 3"),
        ("1 2 3 4 5 6\n" * 4 + "1 2 3", "line 5 has 3"),
        ("1 2 3 4 5 6\n" * 4 + "1 2 x 4 5 6", "line 5 holds 'x'"),
        ("1 2 3 4 5 6\n" * 4 + "1 2 nan 4 5 6", "line 5 is not"),
        ("1 2 3 4 5 6\n" * 4 + "1 2 1e9 4 5 6", "line 5 is not"),
        ("1 2 3 4 5 6\n" * (MOST_NUMBERS // 6 + 1), "at most 500 lines"),
    ],
)
def test_wrong_waypoints_are_refused_with_their_line(text: str, said: str) -> None:
    with pytest.raises(InvalidExperimentError) as caught:
        Experiment.from_document({"trajectory": {"kind": "recorded", "waypoints": text}})
    (field,) = caught.value.fields
    assert field.path == "trajectory.waypoints"
    assert said in field.message


def test_the_longest_one_fits_into_a_preset() -> None:
    trajectory = recorded(MOST_NUMBERS // 6, 0.02)
    trajectory["waypoints"] = waypoint_text(waypoints_of(trajectory["waypoints"], 6) - 100.0)
    experiment = Experiment.from_document({"trajectory": trajectory})
    assert experiment_from_yaml(experiment_to_yaml(experiment)) == experiment
