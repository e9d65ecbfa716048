"""The arms on the screen: the solid one of the selected lane and a ghost for each other.

Each is a chain of nodes, one in the other, so that a picture costs six rotations an arm.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Protocol

import numpy as np
import pinocchio as pin
import viser

from slidetune.robot.arm.arm import build_model
from slidetune.robot.arm.description import LINK_NAMES, MESH_DIR
from slidetune.robot.arm.section import Payload, Robot
from slidetune.robot.fields.quantity import JOINTS
from slidetune.server.scene.ghost_mesh import ghost_mesh

Array = np.ndarray
Color = tuple[int, int, int]

GHOST_OPACITY = 0.3
"""*Ours*: the floor and the arm stay visible behind it."""
PAYLOAD_DENSITY = 7850.0
"""Density that a payload is drawn with in [kg/m^3] (*ours*): steel."""
PAYLOAD_COLOR = (196, 164, 92)
"""*Ours*: brass, a colour that no lane has."""
HIDDEN = 1e-4
"""Size of what is not there, in [m] and as a scale (*ours*)."""

# Height along the flange's z, radius and thickness of the band in the lane's colour [m] (ours).
_FLANGE_BAND = (-0.0205, 0.0417, 0.011)


class _Node(Protocol):
    wxyz: Array
    visible: bool


@cache
def _placements() -> tuple[Array, Array]:
    """Return orientation (wxyz) and position of the joints' frames in their parents' frames.

    Shapes (6, 4) and (6, 3).
    """
    model = build_model(Robot())
    frames = [model.jointPlacements[joint] for joint in range(1, JOINTS + 1)]
    turned = [pin.Quaternion(frame.rotation).coeffs()[[3, 0, 1, 2]] for frame in frames]
    return np.array(turned), np.array([frame.translation for frame in frames])


def joint_orientations(angles: Array) -> Array:
    """Return how each link is turned in the frame of the link before it.

    Args:
        angles: joint angles in [rad]. Shape (n, 6).

    Returns:
        Unit quaternions wxyz. Shape (n, 6, 4).
    """
    w, x, y, z = np.moveaxis(_placements()[0], -1, 0)
    c, s = np.cos(0.5 * angles), np.sin(0.5 * angles)
    return np.stack([w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s], axis=-1)


class _Arm:
    """A chain of six turning nodes."""

    def __init__(self, links: Sequence[_Node]) -> None:
        self._links = links
        self._posed = np.zeros((JOINTS, 4))

    def pose(self, orientations: Array) -> None:
        """Turn the joints. Shape of ``orientations`` (6, 4), unit quaternions wxyz."""
        if np.array_equal(orientations, self._posed):
            return
        self._posed = orientations
        for link, orientation in zip(self._links, orientations, strict=True):
            link.wxyz = orientation

    def show(self, visible: bool) -> None:
        """Show or hide all that moves."""
        self._links[0].visible = visible


def _chain(root: str) -> list[tuple[str, str, Array]]:
    """Return name, link and position of the nodes below ``root``."""
    nodes, path = [], root
    for link, position in zip(LINK_NAMES[1:], _placements()[1], strict=True):
        path = f"{path}/{link}"
        nodes.append((path, link, position))
    return nodes


class SolidArm(_Arm):
    """The arm as it looks, with a band in the lane's colour, and what it carries.

    Attributes:
        links: the moving ones, in the order of the joints.
    """

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        """Add the arm's nodes below ``name``."""

        def add(path: str, link: str, position: Array) -> viser.GlbHandle:
            return scene.add_glb(path, _glb(link), position=position, receive_shadow=False)

        add(name, LINK_NAMES[0], np.zeros(3))
        chain = _chain(name)
        self.links = [add(*node) for node in chain]
        super().__init__(self.links)
        flange = chain[-1][0]
        height, radius, thickness = _FLANGE_BAND
        self._band = scene.add_cylinder(
            f"{flange}/band",
            radius,
            thickness,
            position=(0.0, 0.0, height),
            cast_shadow=False,
            receive_shadow=False,
        )
        self._stem = scene.add_cylinder(
            f"{flange}/stem",
            0.012,
            1.0,
            color=PAYLOAD_COLOR,
            radial_segments=24,
            scale=HIDDEN,
            receive_shadow=False,
            visible=False,
        )
        self._load = scene.add_icosphere(
            f"{flange}/payload",
            radius=HIDDEN,
            color=PAYLOAD_COLOR,
            subdivisions=4,
            receive_shadow=False,
            visible=False,
        )

    def paint(self, color: Color) -> None:
        """Give the band a colour."""
        self._band.color = color

    def carry(self, payload: Payload) -> None:
        """Show the payload as a ball of steel around its centre, or nothing without mass."""
        center = np.asarray(payload.center, dtype=float)
        distance = float(np.linalg.norm(center))
        loaded = payload.mass > 0.0
        self._load.visible = loaded
        self._stem.visible = loaded and distance > 1e-3
        if loaded:
            self._load.radius = payload_radius(payload.mass)
            self._load.position = center
            self._stem.scale = (1.0, 1.0, max(distance, 1e-3))
            self._stem.position = 0.5 * center
            self._stem.wxyz = _turn_of_z(center / max(distance, 1e-3))
        else:
            # A pointer meets what is hidden as well.
            self._load.radius = HIDDEN
            self._stem.scale = HIDDEN


class GhostArm(_Arm):
    """An arm in one translucent colour."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        """Add the arm's nodes below ``name``, hidden; its base is that of the solid arm."""
        self._skins: list[viser.MeshHandle] = []
        for path, link, position in _chain(name):
            vertices, faces = ghost_mesh(link)
            skin = scene.add_mesh_simple(
                path,
                vertices,
                faces,
                opacity=GHOST_OPACITY,
                material="toon5",
                cast_shadow=False,
                receive_shadow=False,
                position=position,
            )
            self._skins.append(skin)
        super().__init__(self._skins)
        self.show(False)

    def paint(self, color: Color) -> None:
        """Give the whole ghost a colour."""
        for skin in self._skins:
            skin.color = color


@cache
def _glb(link: str) -> bytes:
    return (MESH_DIR / f"{link}.glb").read_bytes()


def payload_radius(mass: float) -> float:
    """Return the radius in [m] of a ball of steel of ``mass`` [kg]."""
    return float((3.0 * mass / (4.0 * np.pi * PAYLOAD_DENSITY)) ** (1.0 / 3.0))


def _turn_of_z(direction: Array) -> Array:
    """Return the rotation wxyz that takes z to a unit vector."""
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), direction)
    wxyz: Array = turn.coeffs()[[3, 0, 1, 2]]
    return wxyz
