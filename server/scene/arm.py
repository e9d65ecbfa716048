"""The arms on the screen: the solid one of the selected lane and a ghost for each other.

Each is a chain of nodes, one in the other, so that a picture costs one rotation a joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import pinocchio as pin
import viser

from slidetune.robot.arm.section import Payload
from slidetune.server.scene.shape import Shape

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


Link = viser.GlbHandle | viser.FrameHandle
"""What moves with a joint: its looks, or a frame where it has none."""


class _Node(Protocol):
    wxyz: Array
    position: Array
    visible: bool


class _Arm:
    """A chain of moving nodes."""

    def __init__(self, links: Sequence[_Node], slides: Array) -> None:
        self._links, self._slides = links, slides
        self._posed: tuple[Array, Array] | None = None

    def pose(self, turns: Array, places: Array) -> None:
        """Move the joints.

        Args:
            turns: unit quaternions wxyz. Shape (n, 4).
            places: in the frame of the joint before in [m]. Shape (n, 3).
        """
        posed = self._posed
        if posed and np.array_equal(turns, posed[0]) and np.array_equal(places, posed[1]):
            return
        self._posed = turns, places
        for link, turn, place, slides in zip(self._links, turns, places, self._slides, strict=True):
            if slides:
                link.position = place
            else:
                link.wxyz = turn

    def show(self, visible: bool) -> None:
        """Show or hide all that moves."""
        self._links[0].visible = visible


def _chain(root: str, shape: Shape) -> list[tuple[str, Array, Array]]:
    """Return name, orientation and position of the nodes below ``root``."""
    nodes, path = [], root
    for number, (turned, position) in enumerate(zip(shape.turned, shape.positions, strict=True), 1):
        path = f"{path}/{number}"
        nodes.append((path, turned, position))
    return nodes


class SolidArm(_Arm):
    """The arm as it looks, with a band in the lane's colour, and what it carries.

    Attributes:
        links: the moving ones, in the order of the joints.
    """

    def __init__(self, scene: viser.SceneApi, name: str, shape: Shape) -> None:
        """Add the arm's nodes below ``name``.

        Args:
            scene: where to draw.
            name: of the node of its base.
            shape: what it looks like.
        """

        def add(path: str, piece: bytes, turned: Array, position: Array) -> Link:
            if not piece:
                return scene.add_frame(path, show_axes=False, wxyz=turned, position=position)
            return scene.add_glb(path, piece, wxyz=turned, position=position, receive_shadow=False)

        self._base = add(name, shape.pieces[0], np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3))
        chain = _chain(name, shape)
        self.links = [
            add(path, piece, turned, position)
            for (path, turned, position), piece in zip(chain, shape.pieces[1:], strict=True)
        ]
        super().__init__(self.links, shape.slides)
        flange = f"{chain[-1][0]}/flange"
        scene.add_frame(
            flange,
            show_axes=False,
            wxyz=pin.Quaternion(shape.flange.rotation).coeffs()[[3, 0, 1, 2]],
            position=shape.flange.translation,
        )
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

    def stand(self, there: bool) -> None:
        """Let it be in the room, or take it out, its base as well."""
        self._base.visible = there

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

    def __init__(self, scene: viser.SceneApi, name: str, shape: Shape) -> None:
        """Add the arm's nodes below ``name``, hidden; its base is that of the solid arm."""
        self._skins: list[viser.MeshHandle] = []
        for (path, turned, position), ghost in zip(_chain(name, shape), shape.ghosts, strict=True):
            skin = scene.add_mesh_simple(
                path,
                *ghost,
                opacity=GHOST_OPACITY,
                material="toon5",
                cast_shadow=False,
                receive_shadow=False,
                wxyz=turned,
                position=position,
            )
            self._skins.append(skin)
        super().__init__(self._skins, shape.slides)
        self.show(False)

    def paint(self, color: Color) -> None:
        """Give the whole ghost a colour."""
        for skin in self._skins:
            skin.color = color


def payload_radius(mass: float) -> float:
    """Return the radius in [m] of a ball of steel of ``mass`` [kg]."""
    return float((3.0 * mass / (4.0 * np.pi * PAYLOAD_DENSITY)) ** (1.0 / 3.0))


def _turn_of_z(direction: Array) -> Array:
    """Return the rotation wxyz that takes z to a unit vector."""
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), direction)
    wxyz: Array = turn.coeffs()[[3, 0, 1, 2]]
    return wxyz
