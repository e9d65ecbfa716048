"""What an arm looks like: one piece for its base and one for each joint, in that joint's frame."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import pinocchio as pin
import trimesh

from slidetune.robot.arm.arm import build_arm
from slidetune.robot.arm.chain import turned_axis
from slidetune.robot.arm.description import LINK_NAMES, MESH_DIR
from slidetune.robot.arm.known import SHIPPED, KnownArm, arm_named
from slidetune.robot.arm.section import Robot
from slidetune.robot.arm.serial import Visual
from slidetune.robot.doctor.meshes.shape import MeshReader
from slidetune.server.scene.ghost_mesh import ghost_mesh

Array = np.ndarray

log = logging.getLogger("slidetune.scene")

KEPT = 8
"""How many arms' looks are kept (*ours*)."""
PLAIN = (0.72, 0.74, 0.78, 1.0)
"""Colour of what has none (*ours*): light grey."""
ROUND = 32
"""Sides of a cylinder (*ours*)."""
_Material: Any = trimesh.visual.material.PBRMaterial
_Textured: Any = trimesh.visual.TextureVisuals
SHORTEST = 0.2
"""Reach in [m] that an arm is taken to have at least (*ours*)."""


@dataclass(frozen=True, eq=False)
class Shape:
    """An arm as it is drawn.

    Attributes:
        name: value of ``model`` in the section ``robot``.
        model: its kinematics.
        tip: the frame of the model that is its flange.
        places: for ``flange_positions``. Shape (n + 1, 13).
        turned: orientation wxyz of each joint's frame in the one before. Shape (n, 4).
        positions: place of each joint's frame in the one before in [m]. Shape (n, 3).
        axes: unit vector along each joint's axis in its own frame. Shape (n, 3).
        slides: whether a joint slides. Shape (n,).
        pieces: GLB of the base and of what each joint moves; empty for nothing.
    """

    name: str
    model: pin.Model
    tip: str
    places: Array
    turned: Array
    positions: Array
    axes: Array
    slides: Array
    pieces: tuple[bytes, ...]

    @property
    def joints(self) -> int:
        """How many joints it has."""
        return len(self.slides)

    @cached_property
    def ghosts(self) -> tuple[tuple[Array, Array], ...]:
        """Vertices in [m] and faces of what each joint moves, coarse; see ``ghost_mesh``."""
        return tuple(ghost_mesh(piece) for piece in self.pieces[1:])

    @cached_property
    def reach(self) -> float:
        """How far the flange gets from the first joint at most in [m], but for what slides."""
        lengths = np.linalg.norm(self.places[1:, 9:12], axis=1)
        return max(float(lengths.sum()), SHORTEST)

    @property
    def shoulder(self) -> Array:
        """Where the first joint is in [m]. Shape (3,)."""
        shoulder: Array = self.positions[0]
        return shoulder

    @cached_property
    def flange(self) -> pin.SE3:
        """Where the flange is in the last joint's frame."""
        return self.model.frames[self.model.getFrameId(self.tip)].placement

    def poses(self, angles: Array) -> tuple[Array, Array]:
        """Return how each joint's frame lies in the one before.

        Args:
            angles: joint angles in [rad], or displacements in [m]. Shape (m, n).

        Returns:
            Unit quaternions wxyz, shape (m, n, 4), and places in [m], shape (m, n, 3).
        """
        half = np.where(self.slides, 0.0, 0.5 * angles)
        c, (x, y, z) = np.cos(half), np.moveaxis(np.sin(half)[..., None] * self.axes, -1, 0)
        a, i, j, k = np.moveaxis(self.turned, -1, 0)
        quaternions = np.stack(
            [
                a * c - i * x - j * y - k * z,
                a * x + i * c + j * z - k * y,
                a * y - i * z + j * c + k * x,
                a * z + i * y - j * x + k * c,
            ],
            axis=-1,
        )
        way = np.where(self.slides, angles, 0.0)[..., None] * self._ways
        return quaternions, self.positions + way

    @cached_property
    def _ways(self) -> Array:
        """Direction in which each joint slides, in the frame before. Shape (n, 3)."""
        turns = [pin.Quaternion(w, x, y, z).matrix() for w, x, y, z in self.turned]
        ways: Array = np.einsum("nij,nj->ni", np.array(turns), self.axes)
        return ways


@lru_cache(maxsize=KEPT)
def shape_of(name: str) -> Shape:
    """Return the looks of an arm; the first time takes as long as reading its meshes.

    Raises:
        ValueError: if no arm has that name.
    """
    arm = arm_named(name)
    model = arm.model
    frames = [model.jointPlacements[joint] for joint in range(1, arm.joints + 1)]
    axes, slides = _axes(model)
    shape = Shape(
        name=name,
        model=model,
        tip=arm.tip,
        places=build_arm(Robot(model=name)).places,
        turned=np.array([pin.Quaternion(f.rotation).coeffs()[[3, 0, 1, 2]] for f in frames]),
        positions=np.array([frame.translation for frame in frames]),
        axes=axes,
        slides=slides,
        pieces=_shipped_pieces() if name == SHIPPED else _pieces(arm),
    )
    _ = shape.ghosts  # now, and not on the session's thread when a lane comes
    return shape


def _axes(model: pin.Model) -> tuple[Array, Array]:
    axes, slides = [], []
    for joint in range(1, model.nv + 1):
        found = turned_axis(model, joint)
        if found is None:
            raise ValueError(f"joint {joint} neither turns about nor slides along one axis")
        axes.append(found[0][:, 2])
        slides.append(bool(found[1]))
    return np.array(axes), np.array(slides)


def _shipped_pieces() -> tuple[bytes, ...]:
    return tuple((MESH_DIR / f"{link}.glb").read_bytes() for link in LINK_NAMES)


def _pieces(arm: KnownArm) -> tuple[bytes, ...]:
    reader = MeshReader()
    pieces = []
    for joint in range(arm.joints + 1):
        pieces.append(_piece([one for one in arm.visuals if one.joint == joint], reader))
    return tuple(pieces)


def _piece(visuals: list[Visual], reader: MeshReader) -> bytes:
    """Return the GLB of visuals; empty where there is nothing, or nothing that can be drawn."""
    try:
        drawn = [part for visual in visuals if (part := _part(visual, reader)) is not None]
        return _glb(drawn) if drawn else b""
    except Exception:
        # What a mesh may hold knows no bounds; an arm that isn't drawn can still be tuned.
        log.exception("a piece of an arm can't be drawn")
        return b""


def _part(visual: Visual, reader: MeshReader) -> trimesh.Trimesh | None:
    """Return a part in its joint's frame, ``None`` where its file has gone."""
    mesh: trimesh.Trimesh
    if visual.mesh is not None:
        found = reader.read(visual.mesh)
        if isinstance(found, str):
            return None
        mesh = found[0].copy()
        mesh.apply_transform(np.diag([*visual.scale, 1.0]))
    elif visual.box is not None:
        mesh = trimesh.creation.box(extents=visual.box)
    elif visual.cylinder is not None:
        radius, length = visual.cylinder
        mesh = trimesh.creation.cylinder(radius=radius, height=length, sections=ROUND)
    elif visual.sphere is not None:
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=visual.sphere)
    else:
        return None
    mesh.apply_transform(visual.placement.homogeneous)
    _paint(mesh, visual.color)
    return mesh


def _paint(mesh: trimesh.Trimesh, color: tuple[float, float, float, float] | None) -> None:
    """Give a mesh the colour of its description, else that of its file, else a plain one."""
    own: Any = mesh.visual
    if color is None and getattr(own, "kind", None) == "texture":
        mesh.visual = own.to_color()
    elif color is not None or not getattr(own, "defined", False):
        material = _Material(
            baseColorFactor=color or PLAIN, metallicFactor=0.1, roughnessFactor=0.6
        )
        mesh.visual = _Textured(material=material)


def _glb(parts: list[trimesh.Trimesh]) -> bytes:
    scene: Any = trimesh.Scene(parts)
    return bytes(scene.export(file_type="glb"))
