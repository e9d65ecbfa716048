"""The meshes of the ghosts: those of the arm, coarser and a little thinner."""

from __future__ import annotations

import io

import numpy as np
import trimesh

Array = np.ndarray

COARSE = 0.009
"""Edge of the cells in which a ghost has one vertex in [m] (*ours*): a third of the triangles."""
INSET = 0.0015
"""How far a ghost's skin lies under the arm's in [m] (*ours*): where both are in one place, the
ghost stays inside instead of flickering through."""
NOTHING = (1e-4 * np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], dtype=np.uint32))
"""What stands for a piece that isn't drawn: a triangle that is too small to be seen."""
CREASE = 0.7
"""Angle in [rad] from which an edge of a ghost is drawn as one (*ours*)."""


def ghost_mesh(piece: bytes) -> tuple[Array, Array]:
    """Return a piece of an arm as one coarse surface under its skin.

    Args:
        piece: its GLB, empty for nothing.

    Returns:
        Vertices in [m] and faces. Shapes (n, 3) and (m, 3).
    """
    if not piece:
        return NOTHING
    vertices, normals, faces = _surface(piece)
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


def _surface(piece: bytes) -> tuple[Array, Array, Array]:
    """Return vertices, their normals and faces of all parts of a piece together."""
    loaded = trimesh.load_scene(io.BytesIO(piece), file_type="glb", process=False)
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
