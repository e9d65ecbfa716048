"""An origin that is turned by a quaternion is where Pinocchio has it, from the raw file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.doctor.urdf.finding import Findings
from slidetune.robot.doctor.urdf.reading import read_description
from slidetune.robot.doctor.urdf.xml_tree import read_tree
from tests.robot.doctor.arm_text import GOOD, changed, examined, only
from tests.robot.doctor.test_model import assert_same_numbers

Array = np.ndarray
JOINT = '<origin xyz="0 0 0.1"/>'
INERTIAL, CYLINDER = '<origin xyz="0 0 0.2"/>\n      <mass', '<origin xyz="0 0 0.2"/>\n      <geom'
BOX = "<collision><geometry>"


def turned(quaternions: Array, version: str) -> str:
    """Return the arm with a joint, an inertial, a visual and a collision that are turned."""
    given = [" ".join(repr(float(part)) for part in parts) for parts in quaternions]
    text = changed('<robot name="two">', f'<robot name="two"{version}>')
    text = changed(JOINT, JOINT.replace("/>", f' quat_xyzw="{given[0]}"/>'), text)
    for place, quaternion in zip((INERTIAL, CYLINDER), given[1:3], strict=True):
        text = changed(place, place.replace("/>", f' quat_xyzw="{quaternion}"/>'), text)
    origin = f'<origin xyz="0.1 0 0" quat_xyzw="{given[3]}"/>'
    return changed(BOX, BOX.replace("<geometry>", f"{origin}<geometry>"), text)


def assert_drawn_alike(folder: Path, text: str) -> None:
    path = folder / "arm.urdf"
    path.write_text(text, encoding="utf-8")
    findings = Findings()
    root = read_tree(path, findings)
    assert root is not None
    links = read_description(root, findings).links
    model = pin.buildModelFromXML(text)
    for kind, shapes in (
        (pin.GeometryType.VISUAL, links["upper"].visuals),
        (pin.GeometryType.COLLISION, links["base"].collisions),
    ):
        whole = pin.buildGeomFromUrdfString(model, text, kind).geometryObjects
        name = "upper" if kind == pin.GeometryType.VISUAL else "base"
        (other,) = (one for one in whole if one.name == f"{name}_0")
        # Both stand in the frame of the first link that the joint carries.
        found = shapes[0].pose.se3().homogeneous
        np.testing.assert_allclose(found, other.placement.homogeneous, atol=1e-12)


HALF = 0.5**0.5
ODD = [
    np.array([[HALF, 0, 0, HALF], [0, HALF, 0, HALF], [0, -HALF, 0, HALF], [0, 0, 0, -1]]),
    # Pitched by a quarter, where roll and yaw are one; of no length; of a square that underflows.
    np.array([[0.5, 0.5, 0.5, 0.5], [0.5, -0.5, 0.5, 0.5], [0, 0, 0, 0], [1e-200, 0, 0, 1e-200]]),
    np.array([[1e20, 2e20, 0, 1e20], [3e-9, 0, 4e-9, 0], [1, 2, 3, 4], [-1, 0, 0, 0]]),
]


@pytest.mark.parametrize("version", ["1.1", "1.2"])
@pytest.mark.parametrize("seed", range(8))
def test_quaternions_turn_as_pinocchio_reads_them(tmp_path: Path, seed: int, version: str) -> None:
    random = np.random.default_rng(seed)
    drawn = random.standard_normal((4, 4)) * 10.0 ** random.uniform(-3.0, 3.0, (4, 1))
    unit = drawn / np.linalg.norm(drawn, axis=1, keepdims=True)
    for quaternions in (drawn, unit, *ODD):
        text = turned(quaternions, f' version="{version}"')
        arm = examined(tmp_path, text).arm
        assert arm is not None
        assert_same_numbers(arm, pin.buildModelFromXML(text))
        assert_drawn_alike(tmp_path, text)
    found = examined(tmp_path, turned(unit, f' version="{version}"'))
    assert found.findings == ()


@pytest.mark.parametrize("version", ["", ' version="1.0"'])
def test_without_version_they_are_ignored_and_told(tmp_path: Path, version: str) -> None:
    text = turned(ODD[0], version)
    found = examined(tmp_path, text)
    assert found.arm is not None
    assert_same_numbers(found.arm, pin.buildModelFromXML(text))
    assert_drawn_alike(tmp_path, text)
    said = [one for one in only(found, "assumed") if "quat_xyzw" in one.text]
    assert [one.where for one in said] == [
        "link base",
        "link upper",
        "link upper",
        "joint shoulder",
    ]
    # What is written instead is the same turn.
    angles = said[-1].remedy.partition('rpy="')[2].rstrip('"')
    instead = changed(JOINT, JOINT.replace("/>", f' rpy="{angles}"/>'))
    meant = changed('<robot name="two">', '<robot name="two" version="1.2">')
    meant = changed(JOINT, JOINT.replace("/>", f' quat_xyzw="{HALF} 0 0 {HALF}"/>'), meant)
    arm = examined(tmp_path, instead).arm
    assert arm is not None
    assert_same_numbers(arm, pin.buildModelFromXML(meant))


def test_a_version_makes_no_difference_without_a_quaternion(tmp_path: Path) -> None:
    assert GOOD.count("quat_xyzw") == 0
    for version in ("1.2", "2.0", "new"):
        text = changed('<robot name="two">', f'<robot name="two" version="{version}">')
        assert examined(tmp_path, text).findings == ()
