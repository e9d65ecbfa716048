"""What was put into a simulated log comes out of it within its intervals; no rest is guessed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.arm import build_model
from slidetune.robot.arm.known import add_arm
from slidetune.robot.arm.section import Payload, Robot
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.identification.filtering import kinematics_of
from slidetune.robot.identification.identify import Identification, identify, torque_of
from slidetune.robot.identification.numbers import OF_JOINTS, PARTS, unit_of
from slidetune.robot.identification.regressor import equation_of, flange_of, payload_columns
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError
from tests.robot.first_experiment.drawn_arms import drawn_arm

Array = np.ndarray

SIX: dict[str, Any] = {
    "robot": {
        "inertials": "datasheet",
        "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15],
        "viscous_friction": [5, 5, 4, 0.8, 0.8, 0.8],
        "coulomb_friction": [6, 6, 4, 1, 1, 1],
        "payload": {"mass": 1.5, "center": [0.02, -0.03, 0.06]},
    },
    "trajectory": {
        "kind": "sine",
        "amplitude": [1, 0.8, 0.9, 0.7, 1, 1],
        "angular_frequency": [1.0, 1.3, 1.7, 2.1, 2.6, 3.1],
        "phase": [0, 1, 2, 0.5, 1.5, 0.3],
        "offset": [0, 1.57, 1.0, 1.0, -1, 0],
    },
}
TWO: dict[str, Any] = {
    "robot": {
        "model": "two_links",
        "armature": [0.05, 0.03],
        "viscous_friction": [0.8, 0.4],
        "coulomb_friction": [1.2, 0.6],
        "payload": {"mass": 0.7, "center": [0.05, 0.0, 0.04]},
    },
    "trajectory": {
        "kind": "sine",
        "amplitude": [1.0, 0.8],
        "angular_frequency": [2.0, 3.3],
        "phase": [0, 1],
        "offset": [0.3, 0.2],
    },
}
ONE: dict[str, Any] = {
    "robot": {
        "model": "pendulum",
        "armature": 0.02,
        "viscous_friction": 0.1,
        "coulomb_friction": 0.2,
        "payload": {"mass": 0.3},
    },
    "trajectory": {"kind": "sine", "amplitude": 1.0, "angular_frequency": 3.0},
}


SCALES = {"center": 0.05, "constant": 1.0}
"""Of numbers that may be 0: a centre in [m], a constant torque in [N m]."""


def run_of(document: dict[str, Any], **trajectory: Any) -> Run:
    whole = {
        **document,
        "trajectory": {**document["trajectory"], **trajectory},
        "lanes": {"A": {"law": "computed_torque"}},
        "simulation": {"horizon": 20.0},
    }
    return simulate(Experiment.from_document(whole), estimate=False)


def log_of(run: Run, noise: Array | float = 0.0, angles: float = 0.0, seed: int = 0) -> Recording:
    """Return what a real arm's log would be: with white noise on angles and given torques."""
    random, lane = np.random.default_rng(seed), run.lanes["A"]
    q = lane.q + angles * random.standard_normal(lane.q.shape)
    torque = noise if isinstance(noise, np.ndarray) else noise * random.standard_normal(q.shape)
    return Recording("log.csv", run.time, q, True, tau=lane.tau + torque)


def unknowing(run: Run) -> Robot:
    """Return the run's arm without all that is to be found."""
    nothing = {part: 0.0 for part in OF_JOINTS}
    return run.experiment.robot.model_copy(update={**nothing, "payload": Payload()})


def truth(run: Run, path: str) -> float:
    value: Any = run.experiment.model_dump()
    for key in path.split("."):
        if isinstance(value, dict):
            value = value[key]
        elif isinstance(value, list | tuple):
            value = value[int(key)]
    return float(value)


def covered(run: Run, found: Identification) -> list[bool]:
    return [
        one.low - 1e-9 <= truth(run, one.path) <= one.high + 1e-9
        for one in found.estimates
        if one.low is not None and one.high is not None
    ]


@pytest.fixture(scope="module")
def six() -> Run:
    return run_of(SIX)


@pytest.fixture(scope="module")
def two() -> Run:
    return run_of(TWO)


@pytest.mark.parametrize("name", ["six", "two"])
def test_without_noise_everything_comes_out(name: str, request: pytest.FixtureRequest) -> None:
    run: Run = request.getfixturevalue(name)
    found = identify(log_of(run), unknowing(run))
    for one in found.estimates:
        if one.value is not None:
            scale = SCALES.get(one.path.split(".")[-2], 0.0) or truth(run, one.path)
            assert abs(one.value - truth(run, one.path)) < 0.02 * scale, one
    assert (found.rms_residual < 0.01 * found.rms_torque).all()


@pytest.mark.parametrize(("name", "noise"), [("six", 1.0), ("two", 0.1)])
def test_white_noise_leaves_the_truth_within_nineteen_of_twenty_intervals(
    name: str, noise: float, request: pytest.FixtureRequest
) -> None:
    run: Run = request.getfixturevalue(name)
    inside = [
        one
        for seed in range(8)
        for one in covered(run, identify(log_of(run, noise, 1e-4, seed), unknowing(run)))
    ]
    assert len(inside) >= 8 * 9
    assert np.mean(inside) >= 0.9


def test_noise_that_lasts_makes_the_intervals_wider_and_not_wrong(two: Run) -> None:
    inside, ratios = [], []
    for seed in range(12):
        random = np.random.default_rng(seed)
        white = random.standard_normal((len(two.time), 2))
        lasting = np.empty_like(white)
        lasting[0] = white[0]
        for row in range(1, len(white)):  # a second of it is one piece of news
            lasting[row] = 0.995 * lasting[row - 1] + np.sqrt(1.0 - 0.995**2) * white[row]
        log = log_of(two, 0.1 * lasting)
        robot = unknowing(two).model_copy(update={"payload": two.experiment.robot.payload})
        found = identify(log, robot, OF_JOINTS)
        plain = identify(log_of(two, 0.1 * white), robot, OF_JOINTS)
        inside += covered(two, found)
        ratios += [
            (one.high - one.low) / (other.high - other.low)  # type: ignore[operator]
            for one, other in zip(found.estimates, plain.estimates, strict=True)
        ]
    assert np.mean(inside) >= 0.85
    assert np.median(ratios) > 3.0


def test_use_these_is_a_patch_that_brings_the_arm_back(six: Run) -> None:
    found = identify(log_of(six, 0.2, 1e-5), unknowing(six))
    unknown = six.experiment.patched(
        {"robot": {**{part: 0 for part in OF_JOINTS}, "payload": {"mass": 0}}}
    )
    patched = unknown.patched(found.patch)
    assert patched.robot.payload.mass == pytest.approx(1.5, rel=0.01)
    for part in OF_JOINTS:
        np.testing.assert_allclose(
            getattr(patched.robot, part), getattr(six.experiment.robot, part), rtol=0.05
        )
    assert set(found.patch) == {"robot", "disturbance"}
    assert patched.disturbance.constant == pytest.approx([0.0] * 6, abs=0.2)
    assert patched.lanes == unknown.lanes


def test_a_constant_torque_is_no_payload() -> None:
    load = [4.0, -6.0, 3.0, -2.0, 1.0, 0.5]
    run = run_of({**SIX, "disturbance": {"constant": load}})
    log = log_of(run, 0.2, 1e-5)
    found = identify(log, unknowing(run))
    inside = covered(run, found)
    assert np.mean(inside) > 0.85
    assert found.patch["disturbance"]["constant"] == pytest.approx(load, abs=0.15)
    (mass,) = [one.value for one in found.estimates if one.path == "robot.payload.mass"]
    assert mass == pytest.approx(1.5, rel=0.03)
    # What is not asked for is as it is in the experiment.
    kept = identify(log, unknowing(run), PARTS[:4], load=load)
    assert np.mean(covered(run, kept)) > 0.85
    assert "disturbance" not in kept.patch


def test_a_joint_that_stands_still_is_not_guessed() -> None:
    exact = {**SIX["robot"], "viscous_friction": 0.0, "coulomb_friction": 0.0}
    exact["payload"] = {**SIX["robot"]["payload"], "known": True}
    run = run_of({**SIX, "robot": exact}, amplitude=[1, 0.8, 0, 0.7, 1, 1])
    assert np.abs(run.lanes["A"].v[:, 2]).max() < 1e-6
    robot = unknowing(run).model_copy(update={"viscous_friction": 0.25})
    found = identify(log_of(run, 0.5), robot)
    still = [one for one in found.estimates if one.path.endswith(("n.2", "e.2"))]
    assert {one.path.split(".")[1] for one in still} == set(OF_JOINTS)
    for one in still:
        assert one.told == "no"
        assert one.value is None
        assert one.low is None
        assert "present value is kept" in one.reason
    assert found.patch["robot"]["viscous_friction"][2] == 0.25
    moving = [one for one in found.estimates if one.path.endswith("n.3")]
    assert moving
    assert all(one.told == "yes" for one in moving)


def test_what_lies_along_the_axis_is_not_guessed(two: Run) -> None:
    found = identify(log_of(two, 0.1), unknowing(two))
    (across,) = [one for one in found.estimates if one.path == "robot.payload.center.1"]
    assert across.told == "no"
    assert "does not excite" in across.reason


def test_what_can_not_be_told_apart_is_said_together() -> None:
    run = run_of(ONE)
    found = {one.path: one for one in identify(log_of(run, 0.05), unknowing(run)).estimates}
    assert found["robot.payload.center.2"].told == "no"
    assert "can't tell it from" in found["robot.payload.center.2"].reason
    mass = found["robot.payload.mass"]
    assert mass.told == "given"
    # A centre beside the rod asks for nearly a constant torque.
    assert mass.reason == "given the present value of payload centre y and payload centre z"
    assert mass.value == pytest.approx(0.3, abs=0.02)


def test_a_payload_that_is_none_is_none(two: Run) -> None:
    bare = run_of({**TWO, "robot": {**TWO["robot"], "payload": {"mass": 0.0}}})
    found = {one.path: one for one in identify(log_of(bare, 0.1), unknowing(bare)).estimates}
    mass = found["robot.payload.mass"]
    assert mass.value is not None
    assert mass.low == 0.0
    assert mass.value < 0.02
    assert mass.high is not None
    assert mass.high < 0.05


def test_a_bound_holds_and_what_the_log_asks_for_beyond_it_is_told(two: Run) -> None:
    lane = two.lanes["A"]
    against = Recording("log.csv", two.time, lane.q, True, tau=lane.tau - 3.0 * lane.v)
    found = {one.path: one for one in identify(against, unknowing(two)).estimates}
    friction = found["robot.viscous_friction.0"]
    assert friction.value == 0.0
    assert (friction.low, friction.high) == (0.0, 0.0)
    assert "without its bounds the log asks for -2" in friction.reason


def test_what_the_fit_pushes_to_the_most_that_is_allowed_is_not_used(two: Run) -> None:
    lane = two.lanes["A"]
    speeding = np.gradient(lane.v, two.time, axis=0)
    torque = lane.tau + np.array([0.0, 30.0]) * speeding
    robot = unknowing(two)
    found = identify(Recording("log.csv", two.time, lane.q, True, tau=torque), robot)
    inertia = {one.path: one for one in found.estimates}["robot.armature.1"]
    assert (inertia.told, inertia.value) == ("no", None)
    assert "beyond what is allowed" in inertia.reason
    kept = np.broadcast_to(robot.armature, 2)[1]
    assert found.patch["robot"].get("armature", [0.0, kept])[1] == kept


def test_units_are_those_of_each_joint() -> None:
    arm = drawn_arm(3, 0, slides=True)
    add_arm(arm)
    assert set(arm.slides) == {True, False}
    robot = Robot(model=arm.name)
    for joint, slides in enumerate(arm.slides):
        friction = unit_of(robot, f"robot.viscous_friction.{joint}")
        assert friction == ("N·s/m" if slides else "N·m·s/rad")
    assert unit_of(robot, "robot.payload.center.0") == "m"


def test_only_what_is_asked_for_is_fitted(two: Run) -> None:
    robot = two.experiment.robot.model_copy(update={"viscous_friction": 0.0})
    found = identify(log_of(two, 0.1), robot, ("viscous_friction",))
    assert [one.path for one in found.estimates] == [f"robot.viscous_friction.{j}" for j in (0, 1)]
    assert all(covered(two, found))
    assert set(found.patch["robot"]) == {"viscous_friction"}


def test_currents_and_their_constants_are_torques(two: Run) -> None:
    log = log_of(two, 0.1)
    assert log.tau is not None
    constants = np.array([2.0, -0.5])
    currents = replace(log, tau=None, current=log.tau / constants)
    one, other = (
        identify(log, unknowing(two)),
        identify(currents, unknowing(two), constants=[2.0, -0.5]),
    )
    for first, second in zip(one.estimates, other.estimates, strict=True):
        assert (first.value or 0.0) == pytest.approx(second.value or 0.0, rel=1e-6)
    for wrong, given, said in (
        (currents, None, "per ampere"),
        (replace(log, tau=None), None, "has no torques"),
        (log, [1.0], "has no currents"),
        (currents, [1.0, 2.0, 3.0], "one number or 2"),
        (currents, [0.0], "none of them 0"),
    ):
        with pytest.raises(RecordingError, match=said):
            torque_of(wrong, given)


def test_another_arm_is_told(two: Run) -> None:
    log = log_of(two, 0.1)
    assert log.tau is not None
    random = np.random.default_rng(1)
    other = replace(log, tau=5.0 * np.cumsum(random.standard_normal(log.tau.shape), axis=0) / 50.0)
    assert any(
        "of the torque is explained" in said for said in identify(other, unknowing(two)).remarks
    )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"measured": False}, "no measured angles"),
        ({"rows": 300}, "s are needed"),
        ({"bandwidth": 200.0}, r"must be in \[0.5, 100\] Hz"),
        ({"parts": ("mass",)}, "some of payload, armature"),
        ({"slower": True}, "at most 300 s"),
    ],
)
def test_what_can_not_be_fitted_is_refused(two: Run, change: dict[str, Any], said: str) -> None:
    log = log_of(two)
    assert log.tau is not None
    if "measured" in change:
        log = replace(log, measured=False)
    if "rows" in change:
        rows = slice(0, change["rows"])
        log = replace(log, time=log.time[rows], q=log.q[rows], tau=log.tau[rows])
    if "slower" in change:
        count = 40 * len(log.time)
        time = np.linspace(0.0, 301.0, count)
        log = replace(log, time=time, q=np.resize(log.q, (count, 2)), tau=np.zeros((count, 2)))
    parts = change.get("parts", PARTS)
    with pytest.raises(RecordingError, match=said):
        identify(log, unknowing(two), parts, bandwidth=change.get("bandwidth"))


def test_the_columns_of_a_payload_are_pinocchios(six: Run) -> None:
    robot, random = six.experiment.robot, np.random.default_rng(4)
    loaded = build_model(robot)
    bare = build_model(unknowing(six))
    loaded.armature[:] = 0.0
    body, slopes = payload_columns(
        flange_of(robot), robot.payload.mass, np.array(robot.payload.center)
    )
    for _ in range(10):
        q, v, a = random.uniform(-1.0, 1.0, (3, 6))
        data = bare.createData()
        columns = pin.computeJointTorqueRegressor(bare, data, q, v, a)[:, -10:]
        difference = pin.rnea(loaded, loaded.createData(), q, v, a) - pin.rnea(bare, data, q, v, a)
        np.testing.assert_allclose(columns @ body, difference, atol=1e-10)
    h = 1e-6
    for number in range(4):
        ends = []
        for sign in (1.0, -1.0):
            whole = np.array([robot.payload.mass, *robot.payload.center])
            whole[number] += sign * h
            ends.append(payload_columns(flange_of(robot), whole[0], whole[1:])[0])
        np.testing.assert_allclose((ends[0] - ends[1]) / (2.0 * h), slopes[:, number], atol=1e-8)


def test_below_the_cutoff_nothing_is_changed(two: Run) -> None:
    log = log_of(two)
    assert log.tau is not None
    found = kinematics_of(log, log.tau, None)
    inner = slice(100, -100)
    expected = np.interp(found.time, two.time, two.lanes["A"].v[:, 0])
    np.testing.assert_allclose(found.v[inner, 0], expected[inner], atol=3e-3)
    equation = equation_of(two.experiment.robot, found)
    assert len(equation.time) == len(equation.torque) == len(equation.columns)
