"""The experiment that comes with an arm: any arm, every law, both modes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.known import SHIPPED, KnownArm, add_arm, arm_named
from slidetune.robot.arm.known_arm import own_arm
from slidetune.robot.doctor.examine import examine
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.first_experiment.first_experiment import (
    SETTLED,
    TRACKED,
    First,
    first_experiment,
    first_lane,
)
from slidetune.robot.first_experiment.gains import GAMMA, first_gains, scale_of
from slidetune.robot.first_experiment.motion import first_motion, rounded_down
from slidetune.robot.laws import SHIPPED as SHIPPED_LAWS
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.margin import loop_margin
from tests.robot.doctor.descriptions import described
from tests.robot.first_experiment.drawn_arms import drawn_arm

LAWS = sorted(SHIPPED_LAWS)
HALVES = (LAWS[:4], LAWS[4:])
"""An experiment has six lanes at most."""
# Their numbers of joints are few: kernels of each are compiled anew.
REAL = {
    "ur5_robot.urdf": 6,
    "ur10_robot.urdf": 6,
    "kinova.urdf": 6,
    "so101.urdf": 6,
    "panda.urdf": 7,
    "xarm7.urdf": 7,
    "double_pendulum.urdf": 2,
}
DRAWN = [(joints, seed) for joints in (1, 2, 6, 7) for seed in range(3)]
SWINGS = 2.0 + 2.0 * np.pi
"""Two seconds and one period of the motion."""


@cache
def real_arm(name: str) -> KnownArm:
    found = examine(described(name))
    assert found.arm is not None
    arm = own_arm(found.arm, found.name, file=name)
    add_arm(arm)
    return arm


@cache
def drawn(joints: int, seed: int) -> KnownArm:
    # Every other one has joints that slide.
    arm = drawn_arm(joints, seed, slides=seed % 2 == 1)
    add_arm(arm)
    return arm


def check_all_laws(arm: KnownArm) -> None:
    """Every law tracks the arm's own motion in both modes, within its torque limits."""
    for laws in HALVES:
        first = first_experiment(arm.name, laws)
        assert first.remarks == ()
        assert len(first.experiment.lanes) == len(laws)
        check_margins(first)
        for mode in ("sampled", "continuous"):
            patch = {"simulation": {"mode": mode, "horizon": float(f"{SWINGS:.3f}")}}
            check_run(first.experiment.patched(patch))


def check_margins(first: First) -> None:
    packed = pack(first.experiment)
    for name in first.experiment.lanes:
        margin = loop_margin(packed, name)
        assert margin.holds
        assert margin.gamma is not None
        assert margin.limit is not None
        assert margin.gamma < min(1.0, 0.5 * margin.limit)


def check_run(experiment: Experiment) -> None:
    run = simulate(experiment)
    amplitude = np.asarray(experiment.trajectory.amplitude)  # type: ignore[union-attr]
    limit = experiment.robot.torque_limit
    for lane in run.lanes.values():
        assert lane.freeze is None
        error = np.abs(lane.e[run.time >= SETTLED]).max(axis=0)
        assert np.all(error <= 1.1 * TRACKED * amplitude)
        if limit is not None:
            assert np.all(np.abs(lane.tau).max(axis=0) < np.array(limit))


@pytest.mark.parametrize("name", REAL)
def test_every_law_tracks_with_a_real_arm(name: str) -> None:
    arm = real_arm(name)
    assert arm.joints == REAL[name]
    check_all_laws(arm)


@pytest.mark.parametrize("name", ["pendulum", "two_links"])
def test_every_law_tracks_with_an_arm_to_learn_with(name: str) -> None:
    check_all_laws(arm_named(name))


@pytest.mark.parametrize(("joints", "seed"), DRAWN)
def test_every_law_tracks_with_a_drawn_arm(joints: int, seed: int) -> None:
    check_all_laws(drawn(joints, seed))


@pytest.mark.parametrize("joints", range(1, 13))
def test_gains_reach_the_margin_and_fit_their_fields_with_any_number_of_joints(joints: int) -> None:
    for seed in range(6):
        arm = drawn(joints, seed)
        swing = first_motion(arm)
        for rate in (100.0, 1000.0, 8000.0):
            scale = scale_of(swing, rate)
            for M in swing.inertias:
                gamma = np.linalg.eigvals(np.diag(scale.damping) @ np.linalg.inv(M)) / rate
                assert np.max(np.abs(gamma)) <= GAMMA * (1.0 + 1e-9)
            lanes = {law: first_gains(law, scale) for law in LAWS}
            for law, lane in lanes.items():
                document = {"robot": {"model": arm.name}, "lanes": {"A": lane}}
                assert Experiment.from_document(document).lanes["A"].law == law


@pytest.mark.parametrize("name", [*REAL, "tiago.urdf"])
def test_the_motion_is_within_all_limits(name: str) -> None:
    arm = real_arm(name)
    swing, section = first_motion(arm), first_motion(arm).trajectory()
    ends = np.vstack([swing.offset - swing.amplitude, swing.offset + swing.amplitude])
    assert np.all(ends > np.array(arm.lower))
    assert np.all(ends < np.array(arm.upper))
    assert np.all(swing.amplitude * section["angular_frequency"] <= 0.5 * np.array(arm.velocity))
    assert np.all(swing.amplitude > 0.0)
    assert np.all(swing.torque < np.array(arm.effort))


def test_the_first_experiment_reads_back_from_yaml() -> None:
    for name in ("pendulum", real_arm("panda.urdf").name):
        experiment = first_experiment(name).experiment
        assert experiment_from_yaml(experiment_to_yaml(experiment)) == experiment
        assert experiment.robot.model == name
    assert first_experiment(SHIPPED).experiment == load_preset("paper")


def test_a_lane_of_a_law_has_gains_of_the_arm() -> None:
    experiment = first_experiment("pendulum").experiment
    lane = first_lane("pendulum", "smc")
    assert experiment.patched({"lanes": {"SMC": lane}}).lanes["SMC"].law == "smc"
    strong, weak = (first_lane("pendulum", "smc", rate)["k1"][0] for rate in (1000.0, 100.0))
    assert strong == pytest.approx(10.0 * weak, rel=0.1)


def test_an_arm_too_weak_for_its_own_weight_is_told_of_and_runs_without_limits() -> None:
    strong = arm_named("two_links")
    model = strong.model.copy()
    model.effortLimit = np.array([60.0, 0.1])
    weak = KnownArm("weak", "Weak", "", model, strong.tip, (1.0, 0.5))
    add_arm(weak)
    first = first_experiment("weak")
    (remark,) = first.remarks
    assert "Joint elbow needs" in remark
    assert "effort limit of 0.1 N·m" in remark
    assert remark in first.experiment.description
    assert first.experiment.robot.torque_limit is None
    check_run(first.experiment)


def test_a_home_of_one_joint_is_found() -> None:
    arm = drawn_arm(1, 0)
    model = arm.model
    assert model.lowerPositionLimit[0] < arm.home[0] < model.upperPositionLimit[0]
    assert np.isfinite(pin.computeGeneralizedGravity(model, model.createData(), np.array(arm.home)))


def test_rounding_never_makes_a_number_larger() -> None:
    values = np.random.default_rng(0).uniform(0.0, 1.0, 500) * 10.0 ** np.arange(-5, 5).repeat(50)
    found = rounded_down(values)
    assert np.all(found <= values * (1.0 + 1e-9))
    assert np.all(found >= 0.9 * values)
    assert rounded_down(np.array([0.0, 1.0, 0.5, 100.0])).tolist() == [0.0, 1.0, 0.5, 100.0]
