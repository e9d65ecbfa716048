"""What the bound of one number moves of others is told, and not used."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.arm import build_model
from slidetune.robot.identification.identify import identify
from slidetune.robot.loop.simulate import Run
from slidetune.robot.recordings.recording import Recording
from tests.robot.identification.test_identify import TWO, log_of, run_of, truth, unknowing


@pytest.fixture(scope="module")
def two() -> Run:
    return run_of(TWO)


def test_what_a_bound_of_another_number_moves_is_not_used(two: Run) -> None:
    # As much payload less as there is more: what no bound allows, and others can't make up for.
    lane, random = two.lanes["A"], np.random.default_rng(6)
    loaded, bare = (build_model(two.experiment.robot, payload=there) for there in (True, False))
    data, a = loaded.createData(), np.gradient(lane.v, two.time, axis=0)
    payload = [
        pin.rnea(loaded, data, *state) - pin.rnea(bare, data, *state)
        for state in zip(lane.q, lane.v, a, strict=True)
    ]
    torque = lane.tau - 2.0 * np.array(payload) + 0.1 * random.standard_normal(lane.tau.shape)
    found = identify(Recording("log.csv", two.time, lane.q, True, tau=torque), unknowing(two))
    by_path = {one.path: one for one in found.estimates}
    assert "without its bounds the log asks for -0.7" in by_path["robot.payload.mass"].reason
    for one in found.estimates:
        if "payload" in one.path:
            continue
        if one.told == "yes" and not one.reason:  # not moved
            assert one.value == pytest.approx(truth(two, one.path), abs=0.05)
            continue
        # What the bound moves is not used, and what is used is right and says how far.
        assert one.told in ("given", "no")
        assert "the bound of payload mass" in one.reason
        if one.told == "no":
            assert "its present value is kept" in one.reason
            part, joint = one.path.split(".")[1:]
            assert found.patch["robot"].get(part, [0.0, 0.0])[int(joint)] == 0.0
        else:
            assert one.low is not None
            assert one.high is not None
            assert one.low <= truth(two, one.path) <= one.high
    kept = [one.path for one in found.estimates if one.told == "no" and "moves it" in one.reason]
    assert len(kept) >= 3
    assert "robot.armature.1" in kept


def test_without_noise_what_a_filter_leaves_is_no_bound_to_speak_of() -> None:
    # Rotors of no inertia come out as -3e-5 with intervals of 1e-6.
    robot = {"inertials": "datasheet", "viscous_friction": [6.0, 6.0, 4.0, 2.0, 1.5, 1.0]}
    run = run_of({"robot": robot, "trajectory": {"kind": "sine"}})
    found = identify(log_of(run), unknowing(run))
    assert not [one.path for one in found.estimates if "the bound of" in one.reason]
    friction = found.patch["robot"]["viscous_friction"]
    assert friction == pytest.approx(robot["viscous_friction"], rel=0.01)


def test_no_friction_in_one_joint_says_nothing_of_others(two: Run) -> None:
    changes = {"coulomb_friction": [0.0, 0.6], "viscous_friction": [0.0, 0.4]}
    run = run_of({**TWO, "robot": {**TWO["robot"], **changes}})
    for noise, seed in ((0.0, 0), (1e-5, 1), (0.1, 1), (0.1, 2)):
        found = identify(log_of(run, noise, seed=seed), unknowing(run))
        assert not [one.path for one in found.estimates if "the bound of" in one.reason]
        assert found.patch["robot"]["coulomb_friction"] == pytest.approx([0.0, 0.6], abs=0.05)
