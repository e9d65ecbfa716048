"""Volume and inertia of a link's shapes at a uniform density."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import pi

import numpy as np

from slidetune.robot.doctor.meshes.files import MeshFiles
from slidetune.robot.doctor.meshes.shape import Body, MeshReader
from slidetune.robot.doctor.urdf.description import Link, Shape


@dataclass(frozen=True)
class Meshes:
    """Where meshes are, and what reads them."""

    files: MeshFiles
    reader: MeshReader


def link_body(link: Link, meshes: Meshes) -> tuple[Body, str] | None:
    """Return a link as a body of density one, and what it was made from.

    Its visuals are taken, or its collisions where a visual has no volume; parts that overlap count
    twice.
    """
    best: tuple[Body, str] | None = None
    for name, shapes in (("visuals", link.visuals), ("collisions", link.collisions)):
        bodies = [body for shape in shapes if (body := _shape_body(shape, meshes)) is not None]
        if bodies and (best is None or len(bodies) == len(shapes)):
            best = (_joined(bodies), name)
        if bodies and len(bodies) == len(shapes):
            break
    return best


def _shape_body(shape: Shape, meshes: Meshes) -> Body | None:
    if shape.kind != "mesh":
        return _placed(_primitive(shape), shape)
    path = meshes.files.find(shape.filename).path
    body = meshes.reader.body(path, shape.scale) if path is not None else None
    return _placed(body, shape) if isinstance(body, Body) else None


def _primitive(shape: Shape) -> Body:
    """Return a box, a cylinder along z or a sphere, centred at the origin."""
    size = shape.size
    if shape.kind == "box":
        volume, squares = size[0] * size[1] * size[2], np.square(size)
        inertia = volume / 12.0 * (squares.sum() - squares)
    elif shape.kind == "cylinder":
        radius, length = size
        volume = pi * radius**2 * length
        across = volume * (3.0 * radius**2 + length**2) / 12.0
        inertia = np.array([across, across, volume * radius**2 / 2.0])
    else:
        volume = 4.0 / 3.0 * pi * size[0] ** 3
        inertia = np.full(3, 0.4 * volume * size[0] ** 2)
    return Body(volume, np.zeros(3), np.diag(inertia))


def _placed(body: Body, shape: Shape) -> Body:
    place = shape.pose.se3()
    turn = place.rotation
    return Body(body.volume, place.act(body.centre), turn @ body.inertia @ turn.T)


def _joined(bodies: Iterable[Body]) -> Body:
    """Return several bodies as one (Huygens and Steiner)."""
    parts = list(bodies)
    volume = sum(part.volume for part in parts)
    centre = sum((part.volume * part.centre for part in parts), np.zeros(3)) / volume
    inertia = np.zeros((3, 3))
    for part in parts:
        arm = part.centre - centre
        inertia += part.inertia + part.volume * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Body(volume, centre, inertia)
