"""Smooth surfaces through rings of points, with crisp edges where their profile has corners.

A ring is a row of points around something: a lathe's circle, a section of a loft, the outline
of a box. Seen from outside, points run anticlockwise about the direction in which the rings
follow each other, so that faces and normals point outwards.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Profile = Sequence[tuple[float, float]]

CREASE_ANGLE = pi / 6
"""A profile that turns by more than this, in [rad], makes an edge instead of a curve (ours)."""


class Surface(NamedTuple):
    """Triangles with a normal at every vertex.

    Attributes:
        points: Shape (n, 3).
        normals: Outward unit vectors. Shape (n, 3).
        faces: Indices into ``points``, anticlockwise from outside. Shape (m, 3).
    """

    points: Array
    normals: Array
    faces: NDArray[np.int64]


def skin(rings: Array, *, closed: bool = True) -> Surface:
    """Cover rings with one smooth surface.

    Tangents are sums of the two edges at a point, unscaled, so that a long flat face keeps its
    own normal beside a narrow fillet.

    Args:
        rings: Shape (rings, points, 3).
        closed: Whether the last point of a ring joins the first.

    Returns:
        The surface, without the triangles of zero area at a pole.
    """
    count, size = rings.shape[:2]
    if closed:
        around = np.roll(rings, -1, axis=1) - np.roll(rings, 1, axis=1)
    else:
        around = _difference(rings.swapaxes(0, 1)).swapaxes(0, 1)
    for pole, neighbour in ((0, 1), (-1, -2)):
        if not around[pole].any():
            around[pole] = around[neighbour]
    normals = np.cross(around, _difference(rings))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)

    first = np.arange(size if closed else size - 1)
    second = (first + 1) % size
    rows = size * np.arange(count - 1)[:, None]
    a, b, c, d = rows + first, rows + second, rows + size + second, rows + size + first
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    points = rings.reshape(-1, 3)
    p, q, r = (points[faces[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(q - p, r - p), axis=1)
    return Surface(points, normals.reshape(-1, 3), faces[area > 1e-9])


def _difference(rows: Array) -> Array:
    """Next row minus the one before; at the ends the row itself stands in for the missing one."""
    padded = np.concatenate([rows[:1], rows, rows[-1:]])
    return np.asarray(padded[2:] - padded[:-2])


def join(surfaces: Sequence[Surface]) -> Surface:
    """Put surfaces side by side in one, in their order."""
    starts = np.cumsum([0, *(len(surface.points) for surface in surfaces)])
    return Surface(
        np.concatenate([surface.points for surface in surfaces]),
        np.concatenate([surface.normals for surface in surfaces]),
        np.concatenate(
            [surface.faces + start for surface, start in zip(surfaces, starts, strict=False)]
        ),
    )


def creased(rings: Array, corners: Sequence[int]) -> Surface:
    """Cover rings with smooth strips that meet in an edge at each of the rings ``corners``."""
    bounds = [0, *corners, len(rings) - 1]
    return join([skin(rings[low : high + 1]) for low, high in pairwise(bounds)])


def sharp_corners(profile: Profile) -> list[int]:
    """Indices of the inner points where a profile turns by more than ``CREASE_ANGLE``."""
    points = np.array(profile, dtype=float)
    edges = np.diff(points, axis=0)
    edges /= np.linalg.norm(edges, axis=1, keepdims=True)
    cosines = np.einsum("ij,ij->i", edges[:-1], edges[1:])
    return [int(index) for index in 1 + np.flatnonzero(cosines < np.cos(CREASE_ANGLE))]


def lathe(profile: Profile, sections: int) -> Surface:
    """Turn a profile about +z.

    Args:
        profile: Pairs (height along z, radius), solid to the left of the way up.
        sections: Points a ring; the first lies on +x.

    Returns:
        The surface of revolution.
    """
    heights, radii = np.array(profile, dtype=float).T
    rings = _circles(np.tile(heights[:, None], sections), np.tile(radii[:, None], sections))
    return creased(rings, sharp_corners(profile))


def capped_lathe(
    profile: Profile, seam: tuple[float, float], sections: int
) -> tuple[Surface, Surface]:
    """Turn a profile about +z and part it along the tilted plane ``z = start + slope * x``.

    The profile points that the plane crosses give way to one tilted ring, so that both parts
    end in the same clean line.

    Args:
        profile: As for :func:`lathe`, rising near the seam.
        seam: ``start`` and ``slope`` of the plane.
        sections: Points a ring.

    Returns:
        The part below the plane and the part above it.
    """
    start, slope = seam
    reach = abs(slope) * max(radius for _, radius in profile)
    below = [point for point in profile if point[0] < start - reach]
    above = [point for point in profile if point[0] > start + reach]
    (low, low_radius), (high, high_radius) = below[-1], above[0]

    def radius_at(height: Array) -> Array:
        return low_radius + (high_radius - low_radius) * (height - low) / (high - low)

    middle = float(radius_at(np.array(start)))
    tilted = start + slope * middle * np.cos(_angles(sections))
    full = [*below, (start, middle), *above]
    heights, radii = (
        np.tile(column[:, None], sections) for column in np.array(full, dtype=float).T
    )
    heights[len(below)], radii[len(below)] = tilted, radius_at(tilted)
    rings = _circles(heights, radii)
    corners = sharp_corners(full)
    cut = len(below)
    return (
        creased(rings[: cut + 1], [index for index in corners if index < cut]),
        creased(rings[cut:], [index - cut for index in corners if index > cut]),
    )


def _angles(sections: int) -> Array:
    return 2 * pi * np.arange(sections) / sections


def _circles(heights: Array, radii: Array) -> Array:
    angles = _angles(heights.shape[1])
    return np.stack([radii * np.cos(angles), radii * np.sin(angles), heights], axis=-1)


def placed(
    surface: Surface, origin: Sequence[float], axis: Sequence[float], towards: Sequence[float]
) -> Surface:
    """Move a surface: its z becomes ``axis``, its x ``towards`` (perpendicular unit vectors)."""
    z, x = np.array(axis, dtype=float), np.array(towards, dtype=float)
    rotation = np.array([x, np.cross(z, x), z])
    return Surface(
        surface.points @ rotation + np.array(origin, dtype=float),
        surface.normals @ rotation,
        surface.faces,
    )
