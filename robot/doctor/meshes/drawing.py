"""How each link looks: its meshes where they are found, something plain where they aren't."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.serial import Visual
from slidetune.robot.doctor.meshes.files import Found
from slidetune.robot.doctor.meshes.shape import readable
from slidetune.robot.doctor.meshes.volume import Meshes
from slidetune.robot.doctor.urdf.description import LONGEST_LINK, Description, Link, Pose, Shape
from slidetune.robot.doctor.urdf.finding import Findings, figure, figures, link_named
from slidetune.robot.fields.written_value import written

Array = np.ndarray
_THICKNESS = 0.1
"""Part of its length that a plain link is thick (*ours*)."""
_THINNEST, _THICKEST = 0.01, 0.05
"""How thick a plain link is at least and at most, in [m] (*ours*)."""
_LARGEST = 10.0
"""How many reaches of the arm a mesh may be large without a word (*ours*)."""
_SHORTEST_REACH = 0.2
"""Reach in [m] below which an arm's tells nothing about the size of meshes (*ours*)."""
_FOLDERS = 4
"""Most folders that a text lists (*ours*)."""


@dataclass(frozen=True)
class Part:
    """A shape of a link, and the file of its mesh if it is one."""

    link: str
    shape: Shape
    mesh: Path | None = None


class Drawing:
    """Finds out how links look."""

    def __init__(
        self, description: Description, reach: float, meshes: Meshes, measure: bool
    ) -> None:
        """Take all links.

        Args:
            description: all links and joints.
            reach: length of the arm in [m].
            meshes: where they are.
            measure: whether to open meshes and measure them.
        """
        self._description, self._meshes, self._measure = description, meshes, measure
        self._limit = min(LONGEST_LINK, _LARGEST * max(reach, _SHORTEST_REACH))

    def parts(self, findings: Findings) -> list[Part]:
        """Return the shapes to draw, in the order of the links."""
        found: list[Part] = []
        for link in self._description.links.values():
            drawn = [self._part(link, shape, findings) for shape in link.visuals]
            found += [part for part in drawn if part is not None]
            if None in drawn:
                found += self._plain(link)
        return found

    def _part(self, link: Link, shape: Shape, findings: Findings) -> Part | None:
        """Return a visual, ``None`` where its mesh can't be drawn."""
        if shape.kind != "mesh":
            if max(shape.size) > self._limit:
                size = figure(max(shape.size))
                _say_large(link, shape, size, "write its size in metres", findings)
            return Part(link.name, shape)
        found = self._meshes.files.find(shape.filename)
        if found.path is None:
            _say_missing(link, shape, found, findings)
            return None
        problem = readable(found.path) or self._size_problem(link, shape, found.path, findings)
        if problem:
            text = f"its mesh {written(shape.filename)}: {problem}; {_DRAWN_PLAIN}"
            remedy = "save the mesh as STL, OBJ or GLB and name that file"
            findings.assume(link_named(link.name), shape.line, text, remedy)
            return None
        if found.how != "named":
            _say_elsewhere(link, shape, found, findings)
        unit = self._meshes.reader.unit(found.path) if self._measure else 1.0
        x, y, z = (unit * factor for factor in shape.scale)
        return Part(link.name, replace(shape, scale=(x, y, z)), found.path)

    def _size_problem(self, link: Link, shape: Shape, path: Path, findings: Findings) -> str:
        """Return why a mesh can't be read; say if it is too large."""
        if not self._measure:
            return ""
        extent = self._meshes.reader.extent(path, shape.scale)
        if isinstance(extent, str):
            return extent
        if extent.max() > self._limit:
            small = figures(factor / 1000.0 for factor in shape.scale)
            _say_large(link, shape, figure(extent.max()), f'write scale="{small}"', findings)
        return ""

    def _plain(self, link: Link) -> Iterator[Part]:
        """Yield a link's collisions that can be drawn, else a thin box to the next joint."""
        found = False
        for shape in link.collisions:
            part = self._part(link, shape, Findings())
            if part is not None:
                found = True
                yield part
        if not found:
            yield Part(link.name, self._thin_box(link))

    def _thin_box(self, link: Link) -> Shape:
        """Return a box from a link's frame to the farthest joint that it carries."""
        carried = (j for j in self._description.joints.values() if j.parent == link.name)
        ends = [np.array(joint.pose.xyz) for joint in carried]
        end: Array = max(ends, key=lambda xyz: float(np.linalg.norm(xyz)), default=np.zeros(3))
        length = float(np.linalg.norm(end))
        thick = min(max(_THICKNESS * length, _THINNEST), _THICKEST)
        if length < _THINNEST:
            return Shape(link.line, Pose(), "box", (thick, thick, thick))
        x, y, z = (float(part) for part in end)
        # Roll and pitch that turn z along the way to that joint.
        pitch, yaw = float(np.arctan2(np.hypot(x, y), z)), float(np.arctan2(y, x))
        pose = Pose((x / 2, y / 2, z / 2), (0.0, pitch, yaw))
        return Shape(link.line, pose, "box", (thick, thick, length))


_DRAWN_PLAIN = "drawn as its collision, or as a box"


def _say_missing(link: Link, shape: Shape, found: Found, findings: Findings) -> None:
    looked = [written(str(folder)) for folder in found.looked]
    more = f" and {len(looked) - _FOLDERS} more folders" if len(looked) > _FOLDERS else ""
    places = f"; looked in {', '.join(looked[:_FOLDERS])}{more}" if looked else ""
    name = shape.filename.strip()
    text = f"its mesh {written(name) or 'without a name'} isn't found; {_DRAWN_PLAIN}{places}"
    package = name.partition("://")[2].lstrip("/").partition("/")[0]
    remedy = (
        f"give the folder that holds {written(package)}: --package-dir"
        if package and name.startswith(("package:", "model:"))
        else "put the mesh beside the URDF, or give its folder: --package-dir"
    )
    findings.assume(link_named(link.name), shape.line, text, remedy)


def _say_elsewhere(link: Link, shape: Shape, found: Found, findings: Findings) -> None:
    where = "in other capitals" if found.how == "other case" else "elsewhere"
    text = f"its mesh {written(shape.filename)} is found {where}: {written(str(found.path))}"
    remedy = (
        "write the name as the file has it"
        if found.how == "other case"
        else ("write its path relative to the URDF if that is the right one")
    )
    findings.assume(link_named(link.name), shape.line, text, remedy)


def _say_large(link: Link, shape: Shape, size: str, remedy: str, findings: Findings) -> None:
    text = f"its {shape.kind} is {size} m large; it looks like millimetres"
    findings.note(link_named(link.name), shape.line, text, f"{remedy} if it is in millimetres")


def visuals_of(parts: list[Part], model: pin.Model) -> tuple[Visual, ...]:
    """Return the parts in the frames of a model's joints, from base to tip."""
    found = []
    for part in parts:
        frame = model.frames[model.getFrameId(part.link, pin.FrameType.BODY)]
        shape = part.shape
        visual = Visual(
            int(frame.parentJoint),
            frame.placement * shape.pose.se3(),
            mesh=part.mesh,
            scale=shape.scale,
            color=shape.color,
        )
        if shape.kind == "box":
            x, y, z = shape.size
            visual = replace(visual, box=(x, y, z))
        elif shape.kind == "cylinder":
            radius, length = shape.size
            visual = replace(visual, cylinder=(radius, length))
        elif shape.kind == "sphere":
            visual = replace(visual, sphere=shape.size[0])
        found.append(visual)
    return tuple(sorted(found, key=lambda visual: visual.joint))
