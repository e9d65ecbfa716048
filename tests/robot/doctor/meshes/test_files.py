"""Meshes are found where a description says, and where people put them instead."""

from __future__ import annotations

from pathlib import Path

import pytest

from slidetune.robot.doctor.meshes.files import MeshFiles


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Folder of a package `arm_description` with a URDF and a mesh in it."""
    folder = tmp_path / "src" / "arm_description"
    for name in ("urdf/arm.urdf", "meshes/visual/Link1.stl"):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")
    return folder


def mesh_of(package: Path) -> Path:
    return package / "meshes" / "visual" / "Link1.stl"


@pytest.mark.parametrize(
    "name",
    [
        "package://arm_description/meshes/visual/Link1.stl",
        "package:///arm_description/meshes/visual/Link1.stl",
        "model://arm_description/meshes/visual/Link1.stl",
        "../meshes/visual/Link1.stl",
        " ../meshes//visual/./Link1.stl ",
    ],
)
def test_what_lies_as_it_is_named_is_found(name: str, package: Path) -> None:
    found = MeshFiles(package / "urdf" / "arm.urdf", []).find(name)
    assert (found.how, found.path and found.path.resolve()) == ("named", mesh_of(package))


@pytest.mark.parametrize("given", ["", "arm_description", "arm_description/meshes"])
def test_a_package_is_found_in_given_folders_and_beside_them(
    given: str, package: Path, tmp_path: Path
) -> None:
    urdf = tmp_path / "elsewhere" / "arm.urdf"
    files = MeshFiles(urdf, [package.parent / given])
    found = files.find("package://arm_description/meshes/visual/Link1.stl")
    assert (found.how, found.path) == ("named", mesh_of(package))


@pytest.mark.parametrize(
    "name",
    [
        "/opt/robots/src/arm_description/meshes/visual/Link1.stl",
        "file:///opt/robots/arm_description/meshes/visual/Link1.stl",
        "C:\\robots\\arm_description\\meshes\\visual\\Link1.stl",
        "package://other_name/meshes/visual/Link1.stl",
        "../../lost/meshes/visual/Link1.stl",
    ],
)
def test_paths_of_another_machine_lead_to_what_is_called_alike(name: str, package: Path) -> None:
    found = MeshFiles(package / "urdf" / "arm.urdf", []).find(name)
    assert (found.how, found.path) == ("elsewhere", mesh_of(package))


def test_an_absolute_path_is_taken_as_it_is(package: Path, tmp_path: Path) -> None:
    found = MeshFiles(tmp_path / "arm.urdf", []).find(str(mesh_of(package)))
    assert (found.how, found.path) == ("named", mesh_of(package))


def test_meshes_beside_the_file_are_found_by_their_bare_name(tmp_path: Path) -> None:
    (tmp_path / "Link1.stl").write_bytes(b"")
    found = MeshFiles(tmp_path / "arm.urdf", []).find("package://x/meshes/Link1.stl")
    assert (found.how, found.path) == ("elsewhere", tmp_path / "Link1.stl")


@pytest.mark.parametrize(
    "name", ["package://arm_description/Meshes/visual/link1.STL", "../MESHES/visual/Link1.stl"]
)
def test_a_wrong_case_is_found_and_told(name: str, package: Path) -> None:
    found = MeshFiles(package / "urdf" / "arm.urdf", [package]).find(name)
    assert found.path is not None
    assert found.path.samefile(mesh_of(package))
    if not (package / "MESHES").exists():
        assert found.how != "named"


@pytest.mark.parametrize(
    "name",
    ["package://arm_description/meshes/Link2.stl", "", "package://", "meshes", "..", "a\0b",
     "https://example.org/meshes/visual/Link1.stl", "x" * 5000, "package://a/" + "b/" * 600],
)  # fmt: skip
def test_what_is_not_there_is_not_found(name: str, package: Path) -> None:
    assert MeshFiles(package / "urdf" / "arm.urdf", []).find(name).path is None


def test_it_says_where_it_looked(package: Path) -> None:
    found = MeshFiles(package / "urdf" / "arm.urdf", [package]).find("package://b/meshes/c.stl")
    assert package / "b" / "meshes" in found.looked
    assert package / "urdf" in found.looked


def test_nothing_outside_the_folder_is_found_where_one_is_given(tmp_path: Path) -> None:
    inside, outside = tmp_path / "sent", tmp_path / "secret"
    for folder in (inside, outside):
        folder.mkdir()
        (folder / "mesh.stl").write_bytes(b"solid")
    (inside / "link.stl").symlink_to(outside / "mesh.stl")
    files = MeshFiles(inside / "arm.urdf", [inside], within=inside)
    names = ("../secret/mesh.stl", "package://secret/mesh.stl", "link.stl", str(outside / "x.stl"))
    for name in names:
        found = files.find(name)
        assert found.path is None or found.path.resolve().is_relative_to(inside), name
        assert all(folder.is_relative_to(inside) for folder in found.looked), name
    assert files.find(f"file://{outside}/mesh.stl").path == inside / "mesh.stl"
    assert MeshFiles(inside / "arm.urdf", []).find("../secret/mesh.stl").path is not None
