"""Examines the description of an arm before anything runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidetune.robot.arm.serial import SerialArm
from slidetune.robot.doctor.chain import chain_to
from slidetune.robot.doctor.inertials import Masses, check_each
from slidetune.robot.doctor.limits import check_lengths, check_losses, checked_limits, unit_axis
from slidetune.robot.doctor.meshes.drawing import Drawing, visuals_of
from slidetune.robot.doctor.meshes.files import MeshFiles
from slidetune.robot.doctor.meshes.shape import MeshReader
from slidetune.robot.doctor.meshes.volume import Meshes
from slidetune.robot.doctor.model import build_chain, frame_name, moves_like_bodies, urdf_text
from slidetune.robot.doctor.tip import chosen_tip
from slidetune.robot.doctor.tree import Tree, tree_of
from slidetune.robot.doctor.urdf.description import Description, Joint
from slidetune.robot.doctor.urdf.finding import Finding, Findings
from slidetune.robot.doctor.urdf.kind_of_file import is_urdf
from slidetune.robot.doctor.urdf.reading import read_description
from slidetune.robot.doctor.urdf.xml_tree import read_tree
from slidetune.robot.fields.written_value import written

__all__ = ["Examined", "Finding", "examine"]


@dataclass(frozen=True)
class Examined:
    """What the doctor says.

    Attributes:
        name: the robot's name in the file.
        findings: the refused ones first, then the assumed and the noted ones.
        arm: ``None`` where anything is refused.
    """

    name: str
    findings: tuple[Finding, ...]
    arm: SerialArm | None


@dataclass(frozen=True)
class _Layout:
    """An arm within its description."""

    tree: Tree
    tip: str
    chain: list[Joint]

    def bodies(self) -> list[list[str]]:
        """Return the links that stand on the base, then those that each joint moves."""
        number = {joint.name: place for place, joint in enumerate(self.chain, 1)}
        body = {self.tree.root: 0}
        for link in self.tree.order[1:]:
            joint = self.tree.above[link]
            body[link] = number.get(joint.name, body[joint.parent])
        return [[link for link in body if body[link] == n] for n in range(len(self.chain) + 1)]

    def reach(self) -> float:
        """Return the length of the chain in [m]."""
        path = self.tree.path(self.tip)
        return sum(float(np.linalg.norm(joint.pose.xyz)) for joint in path)


def examine(
    path: Path,
    package_dirs: Sequence[Path] = (),
    tip: str | None = None,
    total_mass: float | None = None,
    within: Path | None = None,
) -> Examined:
    """Examine a URDF and load the arm in it.

    Args:
        path: the file.
        package_dirs: folders in which, or beside which, the packages of its meshes lie.
        tip: the link at the arm's end; by default the end of the longest serial chain.
        total_mass: of the whole arm in [kg], spread by volume over links without a physical one.
        within: the folder outside of which no mesh is opened, for files of somebody else.

    Returns:
        All findings, and the arm if none of them is a refusal. Nothing is raised for what a file
        holds.
    """
    findings = Findings()
    root = read_tree(path, findings)
    if root is None or not is_urdf(root, findings):
        return Examined(written(path.stem), findings.ordered(), None)
    name = root.attributes.get("name", "")
    if not name.strip():
        name = path.stem
        text = f"the robot has no name; it is called {written(name)} like the file"
        findings.assume("robot", root.line, text, 'give it one: <robot name="…">')
    description = read_description(root, findings)
    for folder in package_dirs:
        if not folder.is_dir():
            text = f"{written(str(folder))} is no folder"
            findings.note("package folder", None, text, "give the folder that holds the package")
    meshes = Meshes(MeshFiles(path, package_dirs, within), MeshReader())
    arm = _arm(description, meshes, tip, total_mass, findings)
    return Examined(name, findings.ordered(), None if findings.refused else arm)


def _layout(description: Description, tip: str | None, findings: Findings) -> _Layout | None:
    """Return what is base, chain and tip, where links and joints could be read."""
    if findings.refused:
        return None
    tree = tree_of(description, findings)
    end = chosen_tip(description, tree, tip, findings) if tree is not None else None
    if tree is None or end is None:
        return None
    return _Layout(tree, end, chain_to(description, tree, end, tip is not None, findings))


def _arm(
    description: Description,
    meshes: Meshes,
    tip: str | None,
    total_mass: float | None,
    findings: Findings,
) -> SerialArm | None:
    layout = _layout(description, tip, findings)
    every = description.joints.values()
    chain = layout.chain if layout is not None else [joint for joint in every if joint.free]
    for joint in every:
        check_lengths(joint, findings)
    axes = {joint.name: unit_axis(joint, findings) for joint in chain}
    limits = [checked_limits(joint, findings) for joint in chain]
    for joint in chain:
        check_losses(joint, findings)
    if layout is None:
        check_each(description, findings)
        Drawing(description, 0.0, meshes, measure=False).parts(findings)
        return None
    masses = Masses(description, layout.bodies(), chain)
    if total_mass is not None:
        masses.spread(total_mass, meshes, findings)
    masses.check(findings)
    drawing = Drawing(description, layout.reach(), meshes, measure=not findings.refused)
    parts = drawing.parts(findings)
    if findings.refused:
        return None
    text = urdf_text(description, axes, masses.inertials)
    in_model = [frame_name(description, joint) for joint in chain]
    model = build_chain(text, in_model, limits, findings)
    if model is None or not moves_like_bodies(model, chain, findings):
        return None
    names = tuple(joint.name for joint in chain)
    return SerialArm(
        model,
        layout.tip,
        names,
        tuple(joint.name for joint in every if joint.kind != "fixed" and joint.name not in names),
        tuple(limit.lower for limit in limits),
        tuple(limit.upper for limit in limits),
        tuple(limit.velocity for limit in limits),
        tuple(limit.effort for limit in limits),
        visuals_of(parts, model),
    )
