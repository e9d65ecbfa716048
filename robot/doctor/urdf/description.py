"""A URDF as it is read: links and joints with their numbers and lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pinocchio as pin

Array = np.ndarray
Vector = tuple[float, float, float]
LONGEST_LINK = 20.0
"""What is longer, in [m], looks like millimetres (*ours*)."""
FREE = ("revolute", "continuous", "prismatic")
"""Kinds of joints that an arm may have."""
KINDS = (*FREE, "fixed", "floating", "planar")
"""Kinds of joints that URDF has (*published*)."""


@dataclass(frozen=True)
class Pose:
    """A place: ``xyz`` in [m], roll, pitch and yaw in [rad]."""

    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)

    def se3(self) -> pin.SE3:
        """Return it as Pinocchio has it."""
        return pin.SE3(pin.rpy.rpyToMatrix(*self.rpy), np.array(self.xyz))


@dataclass(frozen=True)
class Inertial:
    """Mass in [kg], centre of mass, and inertia (xx, xy, xz, yy, yz, zz) about it in [kg·m²]."""

    line: int | None
    pose: Pose
    mass: float
    inertia: tuple[float, ...]

    def tensor(self) -> Array:
        """Return the inertia along the axes of ``pose``. Shape (3, 3)."""
        xx, xy, xz, yy, yz, zz = self.inertia
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@dataclass(frozen=True)
class Shape:
    """A visual or a collision.

    Attributes:
        line: of its geometry.
        pose: its place in the link's frame.
        kind: what it is.
        size: edges of a box; radius and length of a cylinder; radius of a sphere, in [m].
        filename: of a mesh, as the file has it.
        scale: factors on the mesh.
        color: red, green, blue, opacity in 0..1.
    """

    line: int
    pose: Pose
    kind: Literal["mesh", "box", "cylinder", "sphere"]
    size: tuple[float, ...] = ()
    filename: str = ""
    scale: Vector = (1.0, 1.0, 1.0)
    color: tuple[float, float, float, float] | None = None


@dataclass(frozen=True)
class Link:
    """A link."""

    name: str
    line: int
    inertial: Inertial | None
    visuals: tuple[Shape, ...]
    collisions: tuple[Shape, ...]


@dataclass(frozen=True)
class Limit:
    """What an element ``limit`` holds; ``None`` for what it doesn't."""

    line: int
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None


@dataclass(frozen=True)
class Joint:
    """A joint.

    Attributes:
        name: in the file.
        line: where it begins.
        kind: one of ``KINDS``.
        parent: name of the link that carries it.
        child: name of the link that it moves.
        pose: its frame in that of the parent.
        axis: as written, not of length one; ``None`` where the file has none.
        axis_line: of that element, or of the joint.
        limit: what the file has; its line is the joint's where the element is missing.
        mimic: the joint that it follows, with the line of that element.
        losses: damping and friction of ``dynamics``, with the line of that element.
        soft: the limits of ``safety_controller``, as far as it has any.
    """

    name: str
    line: int
    kind: str
    parent: str
    child: str
    pose: Pose
    axis: Vector | None
    axis_line: int
    limit: Limit
    mimic: tuple[str, int] | None
    losses: tuple[float, float, int]
    soft: Limit

    @property
    def free(self) -> bool:
        """Whether it can be one of an arm's."""
        return self.kind in FREE and self.mimic is None


@dataclass(frozen=True)
class Description:
    """All links and joints, by their names, in the file's order."""

    line: int
    links: dict[str, Link]
    joints: dict[str, Joint]
