"""Arms by name: whole runs of arms with other numbers of joints, against the reference."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.arm import build_arm, flange_positions
from slidetune.robot.arm.known import SHIPPED, KnownArm, add_arm, arm_named, known_arms
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.motion.along import desired_motion
from tests.reference.solve import solve
from tests.robot.arm.test_chain import described, mixed

ADDED = {"panda": lambda: described("Panda"), "mixed": mixed}
"""An arm with seven joints, and one with six that turn about and slide along oblique axes."""
TIME = np.arange(26) * 0.02


@pytest.fixture(scope="module", autouse=True)
def added() -> None:
    for name, build in ADDED.items():
        model = build()
        place = pin.SE3(pin.exp3(np.array([0.2, -0.1, 0.4])), np.array([0.02, 0.05, 0.1]))
        model.addFrame(pin.Frame("tip", model.nv, 0, place, pin.FrameType.OP_FRAME))
        home = np.linspace(-0.5, 0.6, model.nv)
        add_arm(KnownArm(name, name, "An arm of this test.", model, "tip", tuple(home.tolist())))


def of_arm(name: str, lane: dict[str, Any], **sections: Any) -> Experiment:
    simulation = {"horizon": 0.5, **sections.pop("simulation", {})}
    robot = {"model": name, **sections.pop("robot", {})}
    return Experiment.from_document(
        {"robot": robot, "lanes": {"A": lane}, "simulation": simulation, **sections}
    )


def error_and_estimate(experiment: Experiment) -> tuple[float, float]:
    """Return how far a run is from the reference in [rad], and how far it says it is at most."""
    run = simulate(experiment)
    lane, robot = run.lanes["A"], experiment.robot
    nominal = build_arm(robot, experiment.disturbance.nominal_mismatch, robot.payload.known)
    arms = build_arm(robot).model, nominal.model
    known = solve(experiment.document(), TIME, 1e-10, arms=arms)
    assert lane.freeze is None
    told = lane.accuracy.error_estimate
    assert told is not None
    return float(np.abs(lane.q[::20][: len(TIME)] - known.q).max()), told


LANES: dict[str, dict[str, Any]] = {
    "rbfnn_nftsm": {"k1": 20.0, "k2": 5.0, "learning_rate": 30.0, "width": 0.8},
    "nftsm": {"k1": 12.0, "k2": 3.0, "epsilon": 0.5, "inertia_shaped": True},
    "computed_torque": {},
}


@pytest.mark.parametrize("law", LANES)
@pytest.mark.parametrize("arm", ["pendulum", "two_links", "panda", "mixed"])
def test_a_run_is_the_reference_s_within_what_it_says(arm: str, law: str) -> None:
    random = np.random.default_rng(len(arm))
    joints = arm_named(arm).joints
    experiment = of_arm(
        arm,
        {"law": law, **LANES[law]},
        robot={
            "viscous_friction": random.uniform(0.0, 0.5, joints).tolist(),
            "armature": random.uniform(0.0, 0.2, joints).tolist(),
            "payload": {"mass": 0.5},
        },
        trajectory={
            "kind": "sine",
            "amplitude": random.uniform(0.1, 0.5, joints).tolist(),
            "angular_frequency": random.uniform(0.5, 3.0, joints).tolist(),
        },
        disturbance={
            "constant": random.uniform(-2.0, 2.0, joints).tolist(),
            "nominal_mismatch": 0.9,
        },
        simulation={"initial_error": random.uniform(-0.1, 0.1, joints).tolist()},
    )
    error, told = error_and_estimate(experiment)
    assert error <= told + 1e-9
    assert error < 1e-4


def test_the_flange_is_where_pinocchio_has_it() -> None:
    for name, arm in known_arms().items():
        model, random = arm.model, np.random.default_rng(3)
        data, q = model.createData(), random.uniform(-2.0, 2.0, (20, arm.joints))
        found = flange_positions(q, pack(of_arm(name, {"law": "smc"})).places)
        for row, place in zip(q, found, strict=True):
            pin.framesForwardKinematics(model, data, row)
            known = data.oMf[model.getFrameId(arm.tip)].translation
            np.testing.assert_allclose(place, known, atol=1e-12)


@pytest.mark.parametrize("kind", ["quintic", "hold", "circle", "sine"])
@pytest.mark.parametrize("arm", ["panda", "mixed", "two_links", "pendulum"])
def test_every_trajectory_has_poses_of_its_arm(arm: str, kind: str) -> None:
    trajectory: dict[str, Any] = {"kind": kind}
    if kind == "circle":
        trajectory["radius"] = 0.03
    experiment = of_arm(arm, {"law": "smc"}, trajectory=trajectory)
    joints = arm_named(arm).joints
    if kind == "circle" and joints < 3:
        with pytest.raises(InvalidExperimentError, match="at least 3 joints"):
            pack(experiment)
        return
    packed, h = pack(experiment), 1e-5
    for t in np.linspace(0.1, 3.9, 7):
        q, v = desired_motion(packed.trajectory, np.array([t - h, t, t + h]), joints)
        np.testing.assert_allclose((q[2] - q[0]) / (2.0 * h), v[1], atol=1e-4)
    if kind == "circle":
        q, _ = desired_motion(packed.trajectory, np.linspace(0.0, 4.0, 9), joints)
        places = flange_positions(q, packed.places)
        centre = places[[0, 4]].mean(axis=0)
        np.testing.assert_allclose(np.linalg.norm(places - centre, axis=1), 0.03, atol=1e-6)
        np.testing.assert_allclose(q[0], q[-1], atol=1e-6)


def test_a_preset_keeps_its_arm() -> None:
    experiment = of_arm("panda", {"law": "nftsm", "k1": list(range(1, 8))})
    text = experiment_to_yaml(experiment)
    assert experiment_from_yaml(text) == experiment
    assert "model: panda" in text


@pytest.mark.parametrize(
    ("document", "field", "words"),
    [
        ({"robot": {"model": "pandda"}}, "robot.model", "did you mean panda"),
        ({"robot": {"model": 3}}, "robot.model", "must be the name of an arm"),
        (
            {"robot": {"model": "panda"}, "lanes": {"A": {"law": "smc", "k1": [1.0] * 6}}},
            "lanes.A.k1",
            "a list of 7 numbers",
        ),
        (
            {"robot": {"model": "pendulum"}, "lanes": {"A": {"law": "smc", "k1": [1.0, 2.0]}}},
            "lanes.A.k1",
            "a list of one number",
        ),
        (
            {"robot": {"model": "pendulum", "inertials": "datasheet"}},
            "robot.inertials",
            "no other mass",
        ),
        (
            {
                "robot": {"model": "two_links"},
                "goals": {"x": {"kind": "response", "channel": "e", "joint": 3}},
            },
            "goals.x.joint",
            r"\[0, 2\]",
        ),
    ],
)
def test_what_does_not_fit_an_arm_is_refused_by_field(
    document: dict[str, Any], field: str, words: str
) -> None:
    with pytest.raises(InvalidExperimentError, match=words) as caught:
        Experiment.from_document(document)
    assert [error.path for error in caught.value.fields] == [field]


def test_an_arm_s_flange_is_on_its_last_joint() -> None:
    arm = arm_named("two_links")
    with pytest.raises(ValueError, match="last joint"):
        add_arm(KnownArm("other", "Other", "", arm.model, "upper_rod", arm.home))


def test_no_other_arm_takes_the_name_of_one_that_ships() -> None:
    with pytest.raises(ValueError, match="ships"):
        add_arm(arm_named(SHIPPED))
