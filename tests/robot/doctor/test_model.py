"""Numbers of a chain are those of Pinocchio's model of the whole file, other joints held."""

from __future__ import annotations

from math import cos, sin
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.chain import AGREEMENT
from slidetune.robot.arm.serial import SerialArm
from slidetune.robot.doctor.examine import examine
from tests.robot.doctor.arm_text import GOOD, added, changed, examined, joint, link
from tests.robot.doctor.descriptions import described

Array = np.ndarray
STATES = 20
ARMS = {
    "ur5_robot.urdf": (6, "ee_link"),
    "ur10_robot.urdf": (6, "ee_link"),
    "panda.urdf": (7, "panda_hand_tcp"),
    "xarm7.urdf": (7, "link_eef"),
    "kinova.urdf": (6, "j2s6s200_link_finger_tip_1"),
    "z1.urdf": (7, "gripperMover"),
    "double_pendulum.urdf": (2, "link2"),
    "double_pendulum_continuous.urdf": (2, "link2"),
    "talos_left_arm.urdf": (7, "gripper_left_motor_double_link"),
    "baxter.urdf": (7, "right_gripper"),
}


def arm_of(path: Path, tip: str | None = None) -> SerialArm:
    found = examine(path, tip=tip)
    assert found.arm is not None, found.findings
    return found.arm


def whole_state(full: pin.Model, arm: SerialArm, q: Array, v: Array) -> tuple[Array, Array, Array]:
    """Return the state of the whole file's model, and where the arm's joints are in it."""
    whole_q, whole_v, places = pin.neutral(full), np.zeros(full.nv), []
    for angle, rate, name in zip(q, v, arm.joints, strict=True):
        moved = full.joints[full.getJointId(name)]
        whole_v[moved.idx_v] = rate
        places.append(moved.idx_v)
        if moved.nq == 2:
            whole_q[moved.idx_q : moved.idx_q + 2] = cos(angle), sin(angle)
        else:
            whole_q[moved.idx_q] = angle
    return whole_q, whole_v, np.array(places)


def relative(found: Array, expected: Array) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def assert_same_numbers(arm: SerialArm, full: pin.Model) -> None:
    model, random = arm.model, np.random.default_rng(0)
    data, full_data = model.createData(), full.createData()
    assert model.nq == model.nv == len(arm.joints)
    tip = model.getFrameId(arm.tip)
    full_tip = full.getFrameId(arm.tip, pin.FrameType.BODY)
    for q, v in random.uniform(-3.0, 3.0, (STATES, 2, model.nv)):
        whole_q, whole_v, places = whole_state(full, arm, q, v)
        inertia = np.triu(pin.crba(full, full_data, whole_q))[np.ix_(places, places)]
        assert relative(np.triu(pin.crba(model, data, q)), inertia) < AGREEMENT
        bias = pin.nonLinearEffects(full, full_data, whole_q, whole_v)[places]
        assert relative(pin.nonLinearEffects(model, data, q, v), bias) < AGREEMENT
        pin.framesForwardKinematics(model, data, q)
        pin.framesForwardKinematics(full, full_data, whole_q)
        difference = data.oMf[tip].inverse() * full_data.oMf[full_tip]
        np.testing.assert_allclose(difference.homogeneous, np.eye(4), atol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_numbers_of_real_arms_are_those_of_the_whole_file(name: str) -> None:
    path, (count, tip) = described(name), ARMS[name]
    arm = arm_of(path)
    assert (len(arm.joints), arm.tip) == (count, tip)
    assert_same_numbers(arm, pin.buildModelFromUrdf(str(path)))


@pytest.mark.parametrize("tip", ["panda_link5", "panda_hand", "panda_leftfinger"])
def test_numbers_hold_for_any_tip(tip: str) -> None:
    path = described("panda.urdf")
    assert_same_numbers(arm_of(path, tip), pin.buildModelFromUrdf(str(path)))


def test_limits_are_those_of_the_whole_file() -> None:
    path = described("panda.urdf")
    arm, full = arm_of(path), pin.buildModelFromUrdf(str(path))
    np.testing.assert_array_equal(arm.lower, full.lowerPositionLimit[:7])
    np.testing.assert_array_equal(arm.upper, full.upperPositionLimit[:7])
    np.testing.assert_array_equal(arm.model.velocityLimit, full.velocityLimit[:7])
    np.testing.assert_array_equal(arm.model.effortLimit, full.effortLimit[:7])
    assert arm.held == ("panda_finger_joint1", "panda_finger_joint2")


def test_a_long_axis_gives_the_same_arm_as_one_of_length_one(tmp_path: Path) -> None:
    short = changed('<axis xyz="0 1 0"/>', '<axis xyz="0 0.6 0.8"/>')
    long = examined(tmp_path, changed("0.6 0.8", "3 4", short)).arm
    assert long is not None
    assert_same_numbers(long, pin.buildModelFromXML(short))


def test_a_joint_may_be_called_like_a_link(tmp_path: Path) -> None:
    text = GOOD.replace('joint name="elbow"', 'joint name="fore"').replace(
        'joint name="wrist"', 'joint name="tool"'
    )
    arm = examined(tmp_path, text).arm
    assert arm is not None
    assert arm.joints == ("shoulder", "fore")
    assert_same_numbers(arm, pin.buildModelFromXML(GOOD.replace('"elbow"', '"fore"')))


def test_a_held_joint_of_any_kind_carries_its_mass_along(tmp_path: Path) -> None:
    kinds = ("revolute", "continuous", "prismatic", "floating", "planar")
    parts = [link(kind) + joint(f"{kind} one", "upper", kind, kind) for kind in kinds]
    text = added(*parts)
    arm = examined(tmp_path, text, tip="tool").arm
    assert arm is not None
    assert arm.held == tuple(f"{kind} one" for kind in kinds)
    assert_same_numbers(arm, pin.buildModelFromXML(text))
