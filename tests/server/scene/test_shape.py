"""What an arm looks like, for any arm that is known."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.arm.known import add_arm, known_arms
from slidetune.robot.arm.section import Robot
from slidetune.server.scene.scene import LaneStyle, Scene, SceneFrame
from slidetune.server.scene.shape import Shape, shape_of
from tests.robot.first_experiment.drawn_arms import drawn_arm
from tests.server.scene.viser_client import ViserClient, until

Array = np.ndarray

NAMES = sorted(known_arms())
LANE = (LaneStyle("A", "#0072b2"),)


def angles_of(shape: Shape) -> Array:
    return np.linspace(0.4, -0.3, shape.joints)


def drawn(joints: int, seed: int) -> str:
    """Return the name of a drawn arm, with joints about any axis, some of which slide."""
    arm = drawn_arm(joints, seed, slides=True)
    add_arm(arm)
    return arm.name


@pytest.mark.parametrize("name", [*NAMES, *(drawn(joints, 7 * joints) for joints in (1, 3, 7, 12))])
def test_nodes_one_in_the_other_stand_where_pinocchio_has_the_joints(name: str) -> None:
    shape = shape_of(name)
    q = angles_of(shape)
    turns, places = shape.poses(q[None])
    data, at = shape.model.createData(), pin.SE3.Identity()
    pin.forwardKinematics(shape.model, data, q)
    for joint, ((w, x, y, z), place) in enumerate(zip(turns[0], places[0], strict=True), 1):
        at = at * pin.SE3(pin.Quaternion(w, x, y, z).matrix(), place)
        assert at.isApprox(data.oMi[joint], 1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_every_arm_has_looks(name: str) -> None:
    shape = shape_of(name)
    assert len(shape.pieces) == shape.joints + 1
    assert all(shape.pieces)
    assert all(len(faces) > 4 for _, faces in shape.ghosts)


def test_another_arm_takes_the_place_of_the_one_before_and_that_comes_back() -> None:
    scene = Scene()

    def show(name: str) -> None:
        shape = shape_of(name)
        scene.configure(LANE, "A", Robot(model=name), np.zeros((2, 3)))
        q, point = angles_of(shape), np.zeros((1, 3))
        scene.update(SceneFrame(q, {"A": q}, frozenset(), point, {"A": point}, 0.001))

    try:
        show("jaka_zu5")
        with ViserClient(scene.port) as browser:
            until(lambda: browser.visible.get("/arm", False))
            show("two_links")
            until(lambda: not browser.visible["/arm"])
            assert browser.visible["/arms/1/arm"]
            assert "/arms/1/arm/1/2" in browser.nodes
            assert not any(name.startswith("/arms/1/arm/1/2/3") for name in browser.nodes)
            show("jaka_zu5")
            until(lambda: browser.visible["/arm"] and not browser.visible["/arms/1/arm"])
            nodes = len(browser.nodes)
            show("two_links")
            until(lambda: browser.visible["/arms/1/arm"])
            assert len(browser.nodes) == nodes
    finally:
        scene.close()
