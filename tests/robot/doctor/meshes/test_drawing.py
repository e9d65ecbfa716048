"""Every link is drawn: its meshes where they can be, else something plain, and said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trimesh

from slidetune.robot.doctor.examine import Examined, examine
from tests.robot.doctor.arm_text import GOOD, HERE, changed, examined, marked_line, only
from tests.robot.doctor.descriptions import described

CYLINDER = '<cylinder radius="0.04" length="0.4"/>'
COLLISION = '<collision><geometry><sphere radius="0.07"/></geometry></collision>'


def with_mesh(name: str, more: str = "") -> str:
    """Return the arm whose upper link has a mesh."""
    return changed(CYLINDER, f'{HERE}<mesh filename="{name}"{more}/>')


def box_file(folder: Path, name: str, edge: float = 0.1) -> Path:
    """Write a mesh of a box."""
    path = folder / name
    trimesh.creation.box((edge, edge, 2.0 * edge)).export(path)
    return path


def assumed_of_upper(found: Examined, text: str) -> str:
    """Return what was assumed about the upper link's mesh, which must be in its line."""
    (assumed,) = [one for one in only(found, "assumed") if one.where == "link upper"]
    assert assumed.line == marked_line(text)
    assert assumed.remedy
    return assumed.text


@pytest.mark.parametrize("name", ["upper.stl", "upper.obj", "upper.glb", "UPPER.STL"])
def test_a_mesh_is_drawn_in_its_place(name: str, tmp_path: Path) -> None:
    path = box_file(tmp_path, name)
    found = examined(tmp_path, with_mesh(name, ' scale="1 2 3"'))
    assert found.findings == ()
    assert found.arm is not None
    visual = found.arm.visuals[0]
    assert (visual.joint, visual.mesh, visual.scale) == (1, path, (1.0, 2.0, 3.0))
    np.testing.assert_array_equal(visual.placement.translation, [0.0, 0.0, 0.2])


def test_primitives_and_colours_are_drawn(tmp_path: Path) -> None:
    text = changed(
        f"<geometry>{CYLINDER}</geometry>",
        f'<geometry>{CYLINDER}</geometry><material name="red"/>',
        changed(
            '<link name="tool"/>',
            '<link name="tool"><visual><geometry><box size="1 2 3"/></geometry>'
            '<material><color rgba="0 0.5 1 0.25"/></material></visual></link>'
            '<material name="red"><color rgba="1 0 0 1"/></material>',
        ),
    )
    arm = examined(tmp_path, text).arm
    assert arm is not None
    upper, fore, tool = arm.visuals
    assert (upper.cylinder, upper.color) == ((0.04, 0.4), (1.0, 0.0, 0.0, 1.0))
    assert (fore.sphere, fore.color) == (0.05, None)
    assert (tool.joint, tool.box, tool.color) == (2, (1.0, 2.0, 3.0), (0.0, 0.5, 1.0, 0.25))


def test_a_missing_mesh_is_said_with_its_package(tmp_path: Path) -> None:
    text = with_mesh("package://arm_description/meshes/upper.stl")
    found = examined(tmp_path, text)
    words = assumed_of_upper(found, text)
    assert "its mesh package://arm_description/meshes/upper.stl isn't found" in words
    assert f"looked in {tmp_path}" in words
    (assumed,) = only(found, "assumed")
    assert assumed.remedy == "give the folder that holds arm_description: --package-dir"


def test_a_package_folder_that_is_not_there_is_noted(tmp_path: Path) -> None:
    (noted,) = examined(tmp_path, GOOD, package_dirs=[tmp_path / "lost"]).findings
    assert (noted.kind, noted.where) == ("noted", "package folder")
    assert "lost is no folder" in noted.text


def test_a_missing_mesh_is_drawn_as_its_collision(tmp_path: Path) -> None:
    text = with_mesh("upper.stl").replace('<link name="upper">', f'<link name="upper">{COLLISION}')
    arm = examined(tmp_path, text).arm
    assert arm is not None
    assert arm.visuals[0].sphere == 0.07


def test_a_missing_mesh_without_collision_is_drawn_as_a_box_to_the_next_joint(
    tmp_path: Path,
) -> None:
    text = changed(
        '<origin xyz="0 0 0.4" rpy', '<origin xyz="0.3 -0.2 0.1" rpy', with_mesh("u.stl")
    )
    arm = examined(tmp_path, text).arm
    assert arm is not None
    box = arm.visuals[0]
    assert box.box is not None
    end = np.array([0.3, -0.2, 0.1])
    length = float(np.linalg.norm(end))
    assert box.box[2] == pytest.approx(length)
    np.testing.assert_allclose(box.placement.act(np.array([0, 0, length / 2])), end, atol=1e-12)
    np.testing.assert_allclose(box.placement.act(np.array([0, 0, -length / 2])), 0, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("u.stl", b"solid nothing\nendsolid\n", "drawn as its collision, or as a box"),
        ("u.stl", b"\x00" * 90, "drawn as its collision, or as a box"),
        ("u.glb", b"glTF" * 30, "it can't be read"),
        ("u.obj", b"v 0 0 0\n", "drawn as its collision, or as a box"),
        ("u.step", b"ISO-10303-21;", ".step is no format that is read (STL, OBJ, DAE, GLB are)"),
    ],
)
def test_a_mesh_that_cannot_be_read_is_said(
    name: str, data: bytes, words: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(data)
    text = with_mesh(name)
    found = examined(tmp_path, text)
    assert words in assumed_of_upper(found, text)
    assert found.arm is not None
    assert found.arm.visuals[0].mesh is None


def test_a_mesh_in_millimetres_is_noted(tmp_path: Path) -> None:
    box_file(tmp_path, "upper.stl", 100.0)
    text = with_mesh("upper.stl")
    (noted,) = only(examined(tmp_path, text), "noted")
    assert (noted.where, noted.line) == ("link upper", marked_line(text))
    assert noted.text == "its mesh is 200 m large; it looks like millimetres"
    assert noted.remedy == 'write scale="0.001 0.001 0.001" if it is in millimetres'
    scaled = with_mesh("upper.stl", ' scale="0.001 0.001 0.001"')
    assert examined(tmp_path, scaled).findings == ()


def test_a_mesh_elsewhere_is_drawn_and_said(tmp_path: Path) -> None:
    path = box_file(tmp_path, "upper.stl")
    text = with_mesh("/opt/cad/upper.stl")
    found = examined(tmp_path, text)
    assert f"/opt/cad/upper.stl is found elsewhere: {path}" in assumed_of_upper(found, text)
    assert found.arm is not None
    assert found.arm.visuals[0].mesh == path


@pytest.mark.parametrize("name", ["ur5_robot.urdf", "panda.urdf", "xarm7.urdf", "z1.urdf"])
def test_every_link_of_a_real_arm_is_drawn_in_its_place(name: str) -> None:
    path = described(name)
    arm = examine(path).arm
    assert arm is not None
    assert {visual.joint for visual in arm.visuals} == set(range(len(arm.joints) + 1))
    for visual in arm.visuals:
        forms = (visual.mesh, visual.box, visual.cylinder, visual.sphere)
        assert sum(form is not None for form in forms) == 1
        assert visual.mesh is None or visual.mesh.is_file()


@pytest.mark.parametrize("name", ["xarm7.urdf", "so101.urdf", "double_pendulum.urdf"])
def test_meshes_of_a_real_arm_are_where_pinocchio_has_them(name: str) -> None:
    path = described(name)
    arm, whole = examine(path).arm, pin.buildModelFromUrdf(str(path))
    assert arm is not None
    folder = next(one for one in path.parents if one.name == "example-robot-data").parent
    kind = pin.GeometryType.VISUAL
    shapes = pin.buildGeomFromUrdf(whole, str(path), kind, package_dirs=[str(folder)])
    places, q = shapes.createData(), np.full(whole.nq, 0.3)
    pin.updateGeometryPlacements(whole, whole.createData(), shapes, places, q)
    expected = [place.homogeneous for place in places.oMg]
    data = arm.model.createData()
    pin.forwardKinematics(arm.model, data, q)
    found = [(data.oMi[one.joint] * one.placement).homogeneous for one in arm.visuals]
    assert len(found) == len(expected)
    for one in found:
        assert min(float(np.abs(one - other).max()) for other in expected) < 1e-9
