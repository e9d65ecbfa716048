"""The URDF of the arm: kinematics, limits, inertials, collision geometry and named poses."""

import xml.etree.ElementTree as ElementTree
from math import pi

import numpy as np
import pinocchio as pin
import pytest
import trimesh

from slidetune.robot.arm.description import (
    DATASHEET_MASS,
    JOINT_NAMES,
    LINK_NAMES,
    MESH_DIR,
    POSES,
    URDF_PATH,
    VENDOR_MASS,
)
from slidetune.robot.arm.description.urdf import urdf_text

# Standard Denavit-Hartenberg: d [m], a [m], alpha [rad]; offsets of theta are zero.
DH = [
    (0.12015, 0.0, pi / 2),
    (0.0, 0.430, 0.0),
    (0.0, 0.3685, 0.0),
    (-0.114, 0.0, pi / 2),
    (0.1135, 0.0, -pi / 2),
    (0.107, 0.0, 0.0),
]
MASSES = [4.0392, 15.135, 45.847, 18.069, 5.5525, 6.3339, 1.4169]
LOWER = [-6.28, -1.48, -3.05, -1.48, -6.28, -6.28]
UPPER = [6.28, 4.62, 3.05, 4.62, 6.28, 6.28]
SHOULDER = np.array([0.0, 0.0, 0.12015])  # where the axes of joints 1 and 2 cross


@pytest.fixture(scope="module")
def model():
    return pin.buildModelFromUrdf(str(URDF_PATH))


@pytest.fixture(scope="module")
def collision(model):
    geometry = pin.buildGeomFromUrdf(model, str(URDF_PATH), pin.GeometryType.COLLISION)
    links = [item.parentJoint for item in geometry.geometryObjects]
    for i, first in enumerate(links):
        for j, second in enumerate(links[:i]):
            if abs(first - second) > 1:
                geometry.addCollisionPair(pin.CollisionPair(j, i))
    return geometry


def links():
    return ElementTree.parse(URDF_PATH).getroot().findall("link")


def configurations(count, seed=0):
    return np.random.default_rng(seed).uniform(LOWER, UPPER, (count, 6))


def flange(model, data, q):
    pin.framesForwardKinematics(model, data, np.asarray(q))
    return data.oMf[model.getFrameId("flange_link")]


def collides(model, collision, q):
    return pin.computeCollisions(
        model, model.createData(), collision, collision.createData(), np.asarray(q), True
    )


def inertia_tensor(link):
    entries = link.find("inertial/inertia").attrib
    xx, xy, xz, yy, yz, zz = (
        float(entries[key]) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def mass_matrix(model, data, q):
    """Column by column from inverse dynamics, so that nothing symmetrises it on the way."""
    still = np.zeros(6)
    gravity = pin.rnea(model, data, q, still, still).copy()
    return np.column_stack([pin.rnea(model, data, q, still, a) - gravity for a in np.eye(6)])


def test_committed_urdf_is_the_generated_one():
    assert URDF_PATH.read_text(encoding="utf-8") == urdf_text()


def test_names_run_from_the_base_to_the_flange(model):
    assert tuple(link.get("name") for link in links()) == LINK_NAMES
    assert tuple(model.names)[1:] == JOINT_NAMES


def test_flange_follows_the_dh_table(model):
    data = model.createData()
    for q in configurations(200):
        expected = np.eye(4)
        for theta, (d, a, alpha) in zip(q, DH, strict=True):
            c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
            expected = expected @ [
                [c, -s * ca, s * sa, a * c],
                [s, c * ca, -c * sa, a * s],
                [0, sa, ca, d],
                [0, 0, 0, 1],
            ]
        np.testing.assert_allclose(flange(model, data, q).homogeneous, expected, atol=1e-9)


def test_joint_limits_are_the_published_ones(model):
    np.testing.assert_array_equal(model.lowerPositionLimit, LOWER)
    np.testing.assert_array_equal(model.upperPositionLimit, UPPER)
    np.testing.assert_array_equal(model.velocityLimit, np.full(6, 3.14))
    np.testing.assert_array_equal(model.effortLimit, [150, 150, 150, 28, 28, 28])


def test_link_masses_are_the_manufacturers():
    masses = [float(link.find("inertial/mass").get("value")) for link in links()]
    assert masses == MASSES
    assert sum(masses) == pytest.approx(VENDOR_MASS, abs=1e-9)
    np.testing.assert_allclose(DATASHEET_MASS / VENDOR_MASS, 0.2386053, atol=1e-7)


def test_pinocchio_carries_every_moving_mass(model):
    assert [inertia.mass for inertia in model.inertias][1:] == MASSES[1:]


@pytest.mark.parametrize("link", links(), ids=lambda link: link.get("name"))
def test_inertia_tensor_belongs_to_a_body(link):
    moments = np.linalg.eigvalsh(inertia_tensor(link))
    assert moments[0] > 0
    assert moments[2] < moments[0] + moments[1]


@pytest.mark.parametrize("link", links(), ids=lambda link: link.get("name"))
def test_centre_of_mass_lies_inside_the_mesh_bounds(link):
    low, high = trimesh.load_scene(MESH_DIR / f"{link.get('name')}.glb").bounds
    com = np.array([float(x) for x in link.find("inertial/origin").get("xyz").split()])
    assert np.all(low < com)
    assert np.all(com < high)


def test_mass_matrix_is_symmetric_and_positive_definite(model):
    data = model.createData()
    for q in configurations(50, seed=1):
        mass = mass_matrix(model, data, q)
        np.testing.assert_allclose(mass, mass.T, atol=1e-12)
        assert np.linalg.eigvalsh(mass).min() > 0


def test_mass_matrix_rate_minus_twice_coriolis_is_skew(model):
    data = model.createData()
    step = 1e-6
    for q, v in zip(configurations(50, seed=2), configurations(50, seed=3), strict=True):
        coriolis = pin.computeCoriolisMatrix(model, data, q, v).copy()
        after = mass_matrix(model, data, q + step * v)
        rate = (after - mass_matrix(model, data, q - step * v)) / (2 * step)
        skew = rate - 2 * coriolis
        np.testing.assert_allclose(skew + skew.T, 0.0, atol=1e-5)
        assert np.abs(skew).max() > 1e-3


def test_reach_of_the_flange_is_962_6_mm(model):
    data = model.createData()

    def distance(q):
        return np.linalg.norm(flange(model, data, q).translation - SHOULDER)

    sample = configurations(4000, seed=4)
    best = max(sample, key=distance)
    rng = np.random.default_rng(5)
    for width in np.geomspace(0.5, 1e-3, 1500):
        best = max(best, np.clip(best + rng.normal(0, width, 6), LOWER, UPPER), key=distance)
    assert 0.9625 < distance(best) < 0.9627


def test_published_reach_is_the_outstretched_wrist_housing(model):
    offsets = [abs(placement.translation).max() for placement in model.jointPlacements]
    housing = trimesh.load_scene(MESH_DIR / "wrist_2_link.glb").bounds[1, 0]
    rule = offsets[3] + offsets[4] + offsets[5] + housing
    assert rule == pytest.approx(0.9542, abs=5e-4)


@pytest.mark.parametrize(
    ("pose", "position", "tool"),
    [
        ("zero", (0.7985, 0.0070, 0.00665), (0, -1, 0)),
        ("experiment_start", (-0.4755, 0.1140, 0.43665), (-1, 0, 0)),
        ("tool_down_back", (-0.482, 0.114, 0.44315), (0, 0, -1)),
        ("tool_down_front", (0.482, 0.114, 0.44315), (0, 0, -1)),
    ],
)
def test_named_poses_put_the_flange_where_they_say(model, pose, position, tool):
    placed = flange(model, model.createData(), POSES[pose])
    np.testing.assert_allclose(placed.translation, position, atol=1e-9)
    np.testing.assert_allclose(placed.rotation[:, 2], tool, atol=1e-12)


def test_experiment_poses_are_the_published_degrees():
    start = np.degrees(POSES["experiment_start"])
    end = np.degrees(POSES["experiment_end"])
    np.testing.assert_allclose(start, [0, 90, 90, 180, 90, 0], atol=1e-12)
    np.testing.assert_allclose(end, [90, 45, 30, 60, 36, 30], atol=1e-12)


@pytest.mark.parametrize("pose", POSES)
def test_named_poses_are_reachable_and_free_of_collision(model, collision, pose):
    q = np.array(POSES[pose])
    assert np.all(q > LOWER)
    assert np.all(q < UPPER)
    assert not collides(model, collision, q)


@pytest.mark.parametrize("link", LINK_NAMES)
def test_collision_geometry_fills_the_mesh_bounds(collision, link):
    corners = []
    for item in collision.geometryObjects:
        if item.parentJoint == LINK_NAMES.index(link):
            item.geometry.computeLocalAABB()
            box = item.geometry.aabb_local
            corners += [item.placement.act(corner) for corner in (box.min_, box.max_)]
    bounds = trimesh.load_scene(MESH_DIR / f"{link}.glb").bounds.copy()
    found = np.array([np.min(corners, axis=0), np.max(corners, axis=0)])
    if link == "forearm_link":
        # The elbow's lowest sphere bulges into the upper arm, its neighbour.
        found[0, 2] = bounds[0, 2]
    np.testing.assert_allclose(found, bounds, atol=2.5e-3)


def test_a_forearm_folded_into_the_base_collides(model, collision):
    # Upper arm just above the horizontal, elbow shut: the wrist ends inside the shoulder.
    assert collides(model, collision, np.radians([0, 0, 174, 0, 0, 0]))


def test_every_mesh_name_is_relative_to_the_urdf():
    names = [link.find("visual/geometry/mesh").get("filename") for link in links()]
    assert [URDF_PATH.parent / name for name in names] == [
        MESH_DIR / f"{link}.glb" for link in LINK_NAMES
    ]
    assert all((URDF_PATH.parent / name).is_file() for name in names)
