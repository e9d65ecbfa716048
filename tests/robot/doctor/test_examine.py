"""Every wrong thing gets its words and its line; nothing wrong becomes a model."""

from __future__ import annotations

from math import inf
from pathlib import Path

import numpy as np
import pytest

from slidetune.robot.arm.description import JOINT_NAMES, URDF_PATH
from slidetune.robot.doctor.examine import Examined, examine
from tests.robot.doctor.arm_text import (
    GOOD,
    SHOULDER_LIMIT,
    agrees,
    changed,
    examined,
    marked_line,
    only,
)
from tests.robot.doctor.wrong_arms import ASSUMED, AXIS, NOTED, REFUSED


def assert_said(found: Examined, kind: str, where: str, words: str, line: int | None) -> None:
    said = [one for one in only(found, kind) if one.where == where and words in one.text]
    assert said, found.findings
    assert said[0].line == line
    assert said[0].remedy
    assert agrees(found)


def test_a_sound_arm_needs_no_words(tmp_path: Path) -> None:
    found = examined(tmp_path, GOOD)
    assert found.findings == ()
    assert found.name == "two"
    arm = found.arm
    assert arm is not None
    assert arm.joints == ("shoulder", "elbow")
    assert arm.held == ()
    assert arm.tip == "tool"
    assert (arm.lower, arm.upper) == ((-2.0, -2.5), (2.0, 1.5))
    assert (arm.velocity, arm.effort) == ((3.0, 4.0), (50.0, 20.0))
    assert list(arm.model.names) == ["universe", "shoulder", "elbow"]
    assert arm.model.existFrame("tool")
    np.testing.assert_array_equal(arm.model.upperPositionLimit, arm.upper)


def test_the_shipped_arm_needs_no_words() -> None:
    found = examine(URDF_PATH)
    assert found.findings == ()
    assert found.arm is not None
    assert found.arm.joints == tuple(JOINT_NAMES)
    assert [visual.joint for visual in found.arm.visuals] == list(range(7))


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_refused_in_its_line(name: str, tmp_path: Path) -> None:
    text, where, words = REFUSED[name]
    assert_said(examined(tmp_path, text), "refused", where, words, marked_line(text))


@pytest.mark.parametrize("name", ASSUMED)
def test_what_was_assumed_is_said_in_its_line(name: str, tmp_path: Path) -> None:
    text, where, words = ASSUMED[name]
    found = examined(tmp_path, text)
    assert only(found, "refused") == []
    assert_said(found, "assumed", where, words, marked_line(text))


@pytest.mark.parametrize("name", NOTED)
def test_what_is_odd_is_noted_in_its_line(name: str, tmp_path: Path) -> None:
    text, where, words = NOTED[name]
    found = examined(tmp_path, text)
    assert only(found, "refused") == []
    assert_said(found, "noted", where, words, marked_line(text))


def test_what_is_missing_is_no_limit(tmp_path: Path) -> None:
    arm = examined(tmp_path, changed(SHOULDER_LIMIT, '<limit velocity="0" effort="-1"/>')).arm
    assert arm is not None
    assert (arm.lower[0], arm.upper[0]) == (-inf, inf)
    assert (arm.velocity[0], arm.effort[0]) == (inf, inf)


def test_a_continuous_joint_has_one_angle_and_no_limits(tmp_path: Path) -> None:
    text = changed('name="shoulder" type="revolute"', 'name="shoulder" type="continuous"')
    arm = examined(tmp_path, text).arm
    assert arm is not None
    assert arm.model.nq == arm.model.nv == 2
    assert (arm.lower[0], arm.upper[0]) == (-inf, inf)
    assert arm.model.upperPositionLimit[0] == inf


def test_an_endless_limit_is_refused_with_its_way_out(tmp_path: Path) -> None:
    text = changed(SHOULDER_LIMIT, '<limit lower="-inf" upper="inf" effort="inf"/>')
    ways = {one.text.split()[0]: one.remedy for one in only(examined(tmp_path, text), "refused")}
    assert ways["lower"].endswith("where there is no limit leave out lower and upper")
    assert ways["upper"] == ways["lower"]
    assert ways["effort"].endswith("where there is no limit leave it out")
    arm = examined(tmp_path, changed(SHOULDER_LIMIT, "<limit/>")).arm
    assert arm is not None
    assert (arm.lower[0], arm.upper[0], arm.effort[0]) == (-inf, inf, inf)


def test_soft_limits_that_allow_as_much_need_no_words(tmp_path: Path) -> None:
    soft = '<safety_controller soft_lower_limit="-2" soft_upper_limit="2.5" k_velocity="1"/>'
    assert examined(tmp_path, changed(SHOULDER_LIMIT, SHOULDER_LIMIT + soft)).findings == ()


def test_everything_wrong_is_said_at_once(tmp_path: Path) -> None:
    text = changed(AXIS, '<axis xyz="0 0 0"/>', changed('<mass value="1.0"/>', '<mass value="x"/>'))
    text = changed('izz="0.004"', 'izz="0.4"', text)
    wheres = {finding.where for finding in only(examined(tmp_path, text), "refused")}
    assert wheres == {"link upper", "link fore", "joint shoulder"}


def test_names_that_markup_or_files_could_misread_are_names(tmp_path: Path) -> None:
    odd = "a&amp;b &lt;c&gt; [red] ü 肘"
    arm = examined(tmp_path, GOOD.replace('"elbow"', f'"{odd}"')).arm
    assert arm is not None
    assert arm.joints[1] == "a&b <c> [red] ü 肘"
