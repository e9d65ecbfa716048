"""Shapes of the Zu 5 that no lathe turns: elbow, chamfered block, arms of the foot's flare."""

from collections.abc import Sequence
from itertools import pairwise
from math import pi

import numpy as np

from slidetune.robot.arm.description.profiles import Section
from slidetune.robot.arm.description.rings import Array, Profile, Surface, join, skin


def loft(sections: Sequence[Section], rings: int, points: int) -> Surface:
    """Cover a row of sections smoothly.

    Args:
        sections: At least two. Seen from -y, a ring's ``inner`` point lies to the right of the
            way along the bend.
        rings: How many rings the spline is cut into.
        points: Points a ring.

    Returns:
        The surface, open at both ends.
    """
    knots = np.array([_section_ring(section, points) for section in sections])
    steps = np.linalg.norm(np.diff(knots.mean(axis=1), axis=0), axis=1)
    stations = np.concatenate([[0.0], np.cumsum(steps)])
    slopes = np.gradient(knots, stations, axis=0)
    return skin(_hermite(stations, knots, slopes, np.linspace(0.0, stations[-1], rings)))


def _hermite(stations: Array, knots: Array, slopes: Array, at: Array) -> Array:
    """Cubic through ``knots`` (k, ...) with ``slopes`` at ``stations`` (k,); sampled at (m,)."""
    left = np.clip(np.searchsorted(stations, at, side="right") - 1, 0, len(stations) - 2)
    step = np.diff(stations)[left][:, None, None]
    u = (at - stations[left])[:, None, None] / step
    start = (1 + 2 * u) * (1 - u) ** 2 * knots[left] + u * (1 - u) ** 2 * step * slopes[left]
    end = u**2 * (3 - 2 * u) * knots[left + 1] - u**2 * (1 - u) * step * slopes[left + 1]
    return np.asarray(start + end)


def _section_ring(section: Section, points: int) -> Array:
    angles = 2 * pi * np.arange(points) / points
    across, wide = (
        np.sign(value) * np.abs(value) ** (2 / section.exponent)
        for value in (np.cos(angles), np.sin(angles))
    )
    inner, outer = np.array(section.inner), np.array(section.outer)
    length = float(np.linalg.norm(outer - inner))
    beyond = length - section.waist
    distance = section.waist + across * np.where(across > 0, beyond, section.waist)
    plane = inner + distance[:, None] * (outer - inner) / length
    return np.stack([plane[:, 0], -section.half_width * wide, plane[:, 1]], axis=-1)


def block(half_x: float, half_y: float, corner: float, levels: Profile) -> Surface:
    """Upright block with rounded corners.

    Args:
        half_x: Half its length.
        half_y: Half its width.
        corner: Radius of its four upright edges.
        levels: Pairs (height, inset); an inset narrows the outline on every side.

    Returns:
        The closed surface, with an edge at every level.
    """
    quarter = np.linspace(0, pi / 2, 5)
    signs = np.repeat([(1, 1), (-1, 1), (-1, -1), (1, -1)], 5, axis=0)
    turned = np.concatenate([quarter + side * pi / 2 for side in range(4)])
    normals = np.stack([np.cos(turned), np.sin(turned)], axis=-1)
    centres = signs * np.array([half_x - corner, half_y - corner])
    rings = np.array(
        [
            np.column_stack([centres + (corner - inset) * normals, np.full(20, float(height))])
            for height, inset in levels
        ]
    )
    ends = np.zeros((2, 20, 3))
    ends[:, :, 2] = [[levels[0][0]], [levels[-1][0]]]
    rings = np.concatenate([ends[:1], rings, ends[1:]])
    return join([skin(np.array(pair)) for pair in pairwise(rings)])


def flare_arm(profile: Profile, half_width: float, root: float, points: int) -> Surface:
    """One arm of the foot's flare, along +x: a slice of a turned surface with two flat sides.

    Args:
        profile: Pairs (height, radius) of the turned surface, radius at least ``root``.
        half_width: Of the slice.
        root: Radius inside the neck where the flat sides end.
        points: Points across the slice.

    Returns:
        The surface, open underneath and towards the neck.
    """
    heights, radii = np.array(profile, dtype=float).T
    spread = np.linspace(-1.0, 1.0, points)
    angles = np.arcsin(half_width / radii)[:, None] * spread
    level = np.tile(heights[:, None], points)
    rim = np.stack([radii[:, None] * np.cos(angles), radii[:, None] * np.sin(angles), level], -1)
    inside = np.sqrt(root**2 - half_width**2)
    sides = []
    for edge in (0, -1):
        wall = rim[:, [edge, edge]].copy()
        wall[:, 1 + edge, 0] = inside
        sides.append(skin(wall, closed=False))
    return join([sides[0], skin(rim, closed=False), sides[1]])
