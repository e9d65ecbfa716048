"""The meshes of the ghosts: those of the arm, coarser and a little thinner."""

from __future__ import annotations

from functools import cache

import numpy as np
import trimesh

from slidetune.robot.arm.description import MESH_DIR

Array = np.ndarray

COARSE = 0.009
"""Edge of the cells in which a ghost has one vertex in [m] (*ours*): a third of the triangles."""
INSET = 0.0015
"""How far a ghost's skin lies under the arm's in [m] (*ours*): where both are in one place, the
ghost stays inside instead of flickering through."""
CREASE = 0.7
"""Angle in [rad] from which an edge of a ghost is drawn as one (*ours*)."""


@cache
def ghost_mesh(link: str) -> tuple[Array, Array]:
    """Return a link's mesh as one coarse surface under the skin of the link.

    Args:
        link: a name of ``robot.arm.description.LINK_NAMES``.

    Returns:
        Vertices in [m] and faces. Shapes (n, 3) and (m, 3).
    """
    vertices, normals, faces = _surface(link)
    cells, cell = np.unique(np.floor(vertices / COARSE), axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    places, outward = np.zeros_like(cells), np.zeros_like(cells)
    np.add.at(places, cell, vertices)
    np.add.at(outward, cell, normals)
    places /= np.bincount(cell)[:, None]
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-9)
    coarse = trimesh.Trimesh(places - INSET * outward, _distinct(cell[faces]), process=False)
    # Faces that meet at an edge get vertices of their own: the browser smooths what is shared.
    crisp = trimesh.graph.smooth_shade(coarse, angle=CREASE)
    return np.asarray(crisp.vertices, dtype=np.float32), np.asarray(crisp.faces, dtype=np.uint32)


def _surface(link: str) -> tuple[Array, Array, Array]:
    """Return vertices, their normals and faces of all parts of a link together."""
    loaded = trimesh.load_scene(MESH_DIR / f"{link}.glb", process=False)
    parts = [part for part in loaded.geometry.values() if isinstance(part, trimesh.Trimesh)]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=False)]
    return (
        np.vstack([part.vertices for part in parts]),
        np.vstack([part.vertex_normals for part in parts]),
        np.vstack(faces),
    )


def _distinct(faces: Array) -> Array:
    """Drop faces without area and copies of others."""
    first, second, third = faces.T
    whole = faces[(first != second) & (second != third) & (third != first)]
    _, kept = np.unique(np.sort(whole, axis=1), axis=0, return_index=True)
    distinct: Array = whole[kept]
    return distinct
