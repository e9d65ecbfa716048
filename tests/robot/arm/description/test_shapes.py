"""The meshes of the arm: what is committed, how big it is, and the surfaces it is made of."""

import numpy as np
import pytest
import trimesh

from slidetune.robot.arm.description import LINK_NAMES, MESH_DIR, profiles
from slidetune.robot.arm.description.rings import capped_lathe, lathe, placed
from slidetune.robot.arm.description.shapes import FINISHES, link_scene, write_meshes
from slidetune.robot.arm.description.solids import loft

# Measured on the manufacturer's drawing, [mm].
BOUNDS = {
    "base_link": ([-82.0, -79.0, 0.0], [82.0, 79.0, 40.0]),
    "shoulder_link": ([-62.5, -62.5, -80.1], [62.5, 64.0, 77.5]),
    "upper_arm_link": ([-62.5, -62.5, -221.6], [492.5, 62.5, -64.0]),
    "forearm_link": ([-59.0, -59.0, -68.5], [410.7, 59.0, 56.5]),
    "wrist_1_link": ([-42.2, -68.0, -42.2], [42.2, 57.0, 45.5]),
    "wrist_2_link": ([-42.2, -75.1, -45.5], [42.2, 68.0, 42.2]),
    "flange_link": ([-40.5, -41.0, -39.0], [40.5, 40.5, 0.0]),
}
ROOF = [(0, 0), (0, 10), (20, 10), (23, 9), (23, 0)]  # wall, 18 degree bevel, flat top


def committed(link):
    return trimesh.load_scene(MESH_DIR / f"{link}.glb", process=False)


def facets(points, faces):
    a, b, c = (np.asarray(points)[np.asarray(faces)[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


@pytest.mark.parametrize("link", LINK_NAMES)
def test_committed_mesh_is_the_generated_one(link):
    expected, found = link_scene(link).geometry, committed(link).geometry
    assert set(found) == set(expected)
    for name, mesh in expected.items():
        np.testing.assert_array_equal(found[name].faces, mesh.faces)
        np.testing.assert_allclose(found[name].vertices, mesh.vertices, atol=1e-6)
        np.testing.assert_allclose(found[name].vertex_normals, mesh.vertex_normals, atol=1e-6)


def test_writing_twice_gives_the_same_bytes(tmp_path):
    files = []
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        write_meshes(tmp_path / name)
        files.append([(tmp_path / name / f"{link}.glb").read_bytes() for link in LINK_NAMES])
    assert files[0] == files[1]


def test_meshes_together_stay_below_a_megabyte():
    assert sum(path.stat().st_size for path in MESH_DIR.glob("*.glb")) < 1_000_000


@pytest.mark.parametrize("link", LINK_NAMES)
def test_bounds_match_the_measured_arm(link):
    np.testing.assert_allclose(committed(link).bounds * 1e3, BOUNDS[link], atol=1.5)


@pytest.mark.parametrize("link", LINK_NAMES)
def test_faces_look_the_way_their_normals_point(link):
    for mesh in committed(link).geometry.values():
        normals = np.asarray(mesh.vertex_normals)
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)
        across = facets(mesh.vertices, mesh.faces)
        for corner in range(3):
            agreement = np.einsum("ij,ij->i", across, normals[mesh.faces[:, corner]])
            assert agreement.min() > 0


@pytest.mark.parametrize("link", LINK_NAMES)
def test_surfaces_face_outwards(link):
    meshes = committed(link).geometry.values()
    points = np.concatenate([mesh.vertices for mesh in meshes])
    normals = np.concatenate([mesh.vertex_normals for mesh in meshes])
    for direction in np.random.default_rng(0).normal(size=(200, 3)):
        farthest = points[(points @ direction).argmax()]
        there = np.linalg.norm(points - farthest, axis=1) < 1e-7
        assert (normals[there] @ direction).max() > 0


@pytest.mark.parametrize("link", LINK_NAMES)
def test_materials_are_the_finishes_of_the_style(link):
    for name, mesh in committed(link).geometry.items():
        material, finish = mesh.visual.material, FINISHES[name]
        assert material.metallicFactor == pytest.approx(finish.metallic)
        assert material.roughnessFactor == pytest.approx(finish.roughness)
        assert 0.0 <= finish.metallic <= 0.2
        assert 0.4 <= finish.roughness <= 0.6


def test_flange_holes_lie_on_the_iso_bolt_circle():
    points = np.asarray(committed("flange_link").geometry["dark"].vertices) * 1e3
    face = points[points[:, 2] > 0]
    radius = np.linalg.norm(face[:, :2], axis=1)
    np.testing.assert_allclose([radius.min(), radius.max()], [22.0, 28.0], atol=0.1)


def test_a_sharp_turn_of_a_profile_keeps_both_normals():
    surface = lathe(ROOF, 16)
    rim = surface.normals[np.isclose(surface.points[:, 2], 23) & (surface.points[:, 0] > 8.9)]
    assert sorted(rim[:, 2].round(6))[-1] == 1.0
    assert min(rim[:, 2]) < 0.5


def test_a_gentle_turn_of_a_profile_shares_one_normal():
    surface = lathe(ROOF, 16)
    bend = surface.normals[np.isclose(surface.points[:, 2], 20)]
    assert len(bend) == 16
    assert np.ptp(bend[:, 2]) < 1e-12
    # The long wall outweighs the short bevel, whose own normal leans by sin(18 deg) = 0.316.
    assert 0 < bend[0, 2] < 0.1


def test_a_lathe_encloses_the_volume_of_its_profile():
    surface = lathe([(0, 0), (0, 10), (20, 10), (20, 0)], 256)
    mesh = trimesh.Trimesh(surface.points, surface.faces)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(np.pi * 10**2 * 20, rel=1e-3)


@pytest.mark.parametrize("barrel", [profiles.BIG, profiles.SMALL, profiles.WRIST])
def test_cap_and_body_meet_on_the_seam_plane(barrel):
    body, cap = capped_lathe(*barrel, 64)
    start, slope = barrel.seam
    heights = [part.points[:, 2] - start - slope * part.points[:, 0] for part in (body, cap)]
    assert heights[0].max() == pytest.approx(0.0, abs=0.2)
    assert heights[1].min() == pytest.approx(0.0, abs=0.2)
    seam = {tuple(point) for point in body.points[-64:].round(9)}
    assert seam == {tuple(point) for point in cap.points[:64].round(9)}


def test_elbow_loft_passes_through_its_first_and_last_section():
    surface = loft(profiles.ELBOW, 33, 64)
    first, last = surface.points[:64], surface.points[-64:]
    np.testing.assert_allclose(np.linalg.norm(first[:, :2], axis=1), 59.0)
    np.testing.assert_allclose(np.linalg.norm(last[:, 1:], axis=1), 32.0)
    np.testing.assert_allclose(first[:, 2], -63.0)
    np.testing.assert_allclose(last[:, 0], 112.0)


def test_placing_keeps_right_handedness():
    surface = lathe(ROOF, 16)
    moved = placed(surface, (1, 2, 3), (0, -1, 0), (0, 0, -1))
    before, after = (trimesh.Trimesh(s.points, s.faces).volume for s in (surface, moved))
    assert after == pytest.approx(before)
    np.testing.assert_allclose(moved.points[:, 1].min(), 2 - 23, atol=1e-12)
