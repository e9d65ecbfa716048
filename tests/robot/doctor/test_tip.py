"""Where an arm ends, and what is no arm."""

from __future__ import annotations

from pathlib import Path

import pytest

from slidetune.robot.doctor.examine import examine
from tests.robot.doctor.arm_text import GOOD, added, chain, examined, joint, link, only
from tests.robot.doctor.descriptions import described

LEGGED = [
    "talos_full_v2.urdf", "talos_reduced.urdf", "solo12.urdf", "a1.urdf", "anymal-kinova.urdf",
    "hyq_no_sensors.urdf", "romeo.urdf", "icub.urdf", "simple_humanoid.urdf", "bolt.urdf",
    "g1_29dof_rev_1_0.urdf", "human.urdf",
]  # fmt: skip


def test_a_tip_may_be_any_link_beyond_a_joint(tmp_path: Path) -> None:
    arm = examined(tmp_path, GOOD, tip="upper").arm
    assert arm is not None
    assert (arm.tip, arm.joints, arm.held) == ("upper", ("shoulder",), ("elbow",))


def test_an_unknown_tip_is_refused_with_the_closest_first(tmp_path: Path) -> None:
    found = examined(tmp_path, GOOD, tip="tol")
    (refused,) = only(found, "refused")
    assert refused.where == "tip tol"
    assert refused.text == "no link is named tol, which is to be the tip"
    assert refused.remedy.startswith("choose one of the links: tool")
    assert "base" in refused.remedy


def test_a_tip_that_does_not_move_is_refused_with_the_joints_there_are(tmp_path: Path) -> None:
    (refused,) = only(examined(tmp_path, GOOD, tip="base"), "refused")
    assert refused.text == "no joint moves between the base base and the tip base"
    assert "shoulder, elbow" in refused.remedy


def test_chains_as_long_are_named(tmp_path: Path) -> None:
    other = [link("left"), link("hand"), joint("a", "base", "left"), joint("b", "left", "hand")]
    found = examined(tmp_path, added(*other))
    assert found.arm is not None
    assert found.arm.tip == "tool"
    (noted,) = only(found, "noted")
    assert noted.where == "link tool"
    assert "hand would be as far from the base" in noted.text
    assert found.arm.held == ("a", "b")


def test_frames_as_far_from_the_last_joint_are_named() -> None:
    noted = only(examine(described("ur5_robot.urdf")), "noted")
    assert any("the tip is ee_link; tool0 would be as far" in one.text for one in noted)


def test_a_gripper_is_not_the_arm_s() -> None:
    found = examine(described("panda.urdf"))
    assert any("panda_finger_joint1, panda_finger_joint2 look like" in f.text
               for f in only(found, "noted"))  # fmt: skip


def test_a_joint_beside_the_wrist_ends_no_arm(tmp_path: Path) -> None:
    text = chain(6).replace("</robot>", link("dresser") + joint("d", "l3", "dresser") + "</robot>")
    arm = examined(tmp_path, text).arm
    assert arm is not None
    assert len(arm.joints) == 6
    assert arm.held == ("d",)


def test_twelve_joints_are_an_arm(tmp_path: Path) -> None:
    arm = examined(tmp_path, chain(12)).arm
    assert arm is not None
    assert arm.model.nv == 12


def test_one_joint_too_many_names_the_tip_that_goes(tmp_path: Path) -> None:
    (refused,) = only(examined(tmp_path, chain(13)), "refused")
    assert "l12" in refused.remedy
    assert examined(tmp_path, chain(13), tip="l12").arm is not None


@pytest.mark.parametrize("name", LEGGED)
def test_a_robot_on_legs_is_no_arm(name: str) -> None:
    found = examine(described(name))
    assert found.arm is None
    legs = [one for one in only(found, "refused") if "a robot on legs has a floating" in one.text]
    assert len(legs) == 1
    assert "only arms on a fixed base can be simulated here" in legs[0].text
    assert "--tip" in legs[0].remedy


def test_an_arm_of_a_robot_on_legs_is_one_when_asked_for() -> None:
    found = examine(described("anymal-kinova.urdf"), tip="j2s6s200_end_effector")
    assert found.arm is not None
    assert len(found.arm.joints) == 6
    assert any("the base base is held fixed" in one.text for one in only(found, "assumed"))


def test_a_robot_that_flies_has_no_joints() -> None:
    (refused,) = only(examine(described("quadrotor_base.urdf")), "refused")
    assert refused.text.startswith("no joint moves between the base")
