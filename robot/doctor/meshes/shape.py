"""What a file of a mesh holds: its size, its volume, its inertia at a uniform density."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from pathlib import Path

import numpy as np
import trimesh

from slidetune.robot.doctor.meshes.files import FORMATS
from slidetune.robot.doctor.urdf.description import Vector
from slidetune.robot.fields.written_value import written

Array = np.ndarray
MOST_BYTES = 100_000_000
"""Largest file of a mesh (*ours*)."""


@dataclass(frozen=True)
class Body:
    """A body of density one.

    Attributes:
        volume: in [m³], which is its mass too.
        centre: of mass, in the frame of what it belongs to. Shape (3,).
        inertia: about that centre. Shape (3, 3).
    """

    volume: float
    centre: Array
    inertia: Array


def readable(path: Path) -> str:
    """Return why a mesh can't be read, or an empty text."""
    form = path.suffix.lower()
    if form not in FORMATS:
        allowed = ", ".join(one[1:].upper() for one in FORMATS)
        return f"{form or 'a file without an ending'} is no format that is read ({allowed} are)"
    if form[1:] not in trimesh.available_formats():
        return f"this installation reads no {form[1:].upper()}"
    if path.stat().st_size > MOST_BYTES:
        return f"it has more than {MOST_BYTES:,} bytes"
    return ""


class MeshReader:
    """Reads each file once."""

    def __init__(self) -> None:
        """Begin with none."""
        self._read: dict[Path, tuple[trimesh.Trimesh, float] | str] = {}

    def read(self, path: Path) -> tuple[trimesh.Trimesh, float] | str:
        """Return a mesh as its file has it and the unit of that in [m], or why there is none."""
        if path not in self._read:
            self._read[path] = _read(path)
        return self._read[path]

    def unit(self, path: Path) -> float:
        """Return the unit in [m] that a file names; 1 where it names none, as STL and OBJ."""
        found = self.read(path)
        return 1.0 if isinstance(found, str) else found[1]

    def extent(self, path: Path, scale: Vector) -> Array | str:
        """Return the edges of a mesh's bounding box in [m] at a scale, or why there are none."""
        found = self.read(path)
        if isinstance(found, str):
            return found
        mesh, unit = found
        return np.asarray(mesh.extents) * np.abs(scale) * unit

    def body(self, path: Path, scale: Vector) -> Body | str:
        """Return a mesh as a body, its hull where it isn't closed; or why it is none."""
        found = self.read(path)
        if isinstance(found, str):
            return found
        mesh, unit = found
        try:
            with np.errstate(all="ignore"):
                whole = mesh.copy()
                whole.apply_transform(np.diag([*(unit * factor for factor in scale), 1.0]))
                solid = whole if whole.is_volume and whole.volume > 0.0 else whole.convex_hull
                body = Body(
                    float(solid.volume),
                    np.asarray(solid.center_mass, dtype=float),
                    np.asarray(solid.moment_inertia, dtype=float),
                )
        # A flat or broken mesh has no hull, which every library says in its own way.
        except Exception as error:
            return f"it has no volume ({written(str(error).splitlines()[0] if str(error) else '')})"
        numbers = np.concatenate([[body.volume], body.centre, body.inertia.ravel()])
        if not np.isfinite(numbers).all() or body.volume <= 0.0:
            return "it has no volume"
        return body


def _read(path: Path) -> tuple[trimesh.Trimesh, float] | str:
    try:
        problem = readable(path)
        if problem:
            return problem
        # Without a resolver no other file is read, whatever this one names.
        with path.open("rb") as file, np.errstate(all="ignore"):
            scene = trimesh.load_scene(file, file_type=path.suffix.lower()[1:])
            mesh: trimesh.Trimesh = scene.to_mesh()
    # The readers of formats raise whatever a damaged file makes of them.
    except Exception as error:
        return f"it can't be read ({written(f'{type(error).__name__}: {error}')})"
    if len(mesh.faces) == 0 or not np.isfinite(mesh.vertices).all():
        return "it holds no triangles"
    return mesh, _unit_of(scene)


def _unit_of(scene: trimesh.Scene) -> float:
    """Return the unit of a COLLADA file in [m], which trimesh writes as `0.001 * meters`."""
    factor, _, name = str(scene.units or "").partition(" * ")
    try:
        unit = float(factor) if name == "meters" else 1.0
    except ValueError:
        return 1.0
    return unit if 0.0 < unit < inf else 1.0
