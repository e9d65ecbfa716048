"""Whether masses and inertias can be those of bodies; the datasheet's mass where they can't."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from slidetune.robot.doctor.meshes.volume import Meshes, link_body
from slidetune.robot.doctor.urdf.description import (
    LONGEST_LINK,
    Description,
    Inertial,
    Joint,
    Link,
    Pose,
)
from slidetune.robot.doctor.urdf.finding import Findings, figure, figures, link_named, names
from slidetune.robot.fields.written_value import written

ROUNDING = 1e-3
"""Part of the largest moment by which others may be wrong (*ours*): three digits are written."""
_POINT = 1e-6
"""Radius in [m] below which a body is a point (*ours*)."""
_FLAT = 1e-9
"""Part of the largest moment below which one is none (*ours*)."""
_DENSITIES = (1.0, 100_000.0)
"""Densities in [kg/m³] that a mass spread by volume may have (*ours*): foam to osmium and more."""
_WITH_MASS = "give the arm's whole mass (total_mass) to have it spread by volume"


def not_physical(inertial: Inertial) -> str:
    """Return why no body has this mass and inertia, or an empty text.

    The principal moments of a body are positive, and none is larger than the other two together.
    """
    if inertial.mass < 0.0:
        return f"its mass is {figure(inertial.mass)} kg, must be above 0"
    moments = np.linalg.eigvalsh(inertial.tensor())
    small, middle, large = (float(moment) for moment in moments)
    allowed = max(ROUNDING * max(abs(small), abs(large)), _POINT**2 * inertial.mass)
    shown = f"its principal moments are {figures((small, middle, large))} kg·m²"
    if small < -allowed:
        return f"{shown}; all must be above 0"
    if large - small - middle > allowed:
        return f"{shown}; the largest must not exceed the sum of the others (triangle inequality)"
    return ""


def _empty(link: Link) -> bool:
    return link.inertial is None or link.inertial.mass == 0.0


class Masses:
    """The inertials of an arm's links, checked."""

    def __init__(
        self, description: Description, bodies: Sequence[Sequence[str]], chain: Sequence[Joint]
    ) -> None:
        """Take links by body: those on the base first, then those that each joint moves."""
        self._links = description.links
        self._bodies, self._chain = bodies, chain
        self._wrong = {
            link.name: text
            for link in description.links.values()
            if link.inertial is not None and (text := not_physical(link.inertial))
        }
        self.inertials: dict[str, Inertial] = {
            link.name: link.inertial
            for link in description.links.values()
            if link.inertial is not None
        }

    def _moving(self) -> list[str]:
        return [name for body in self._bodies[1:] for name in body]

    def _massless(self) -> list[Joint]:
        """Return the joints that move no mass of their own."""
        return [
            joint
            for joint, body in zip(self._chain, self._bodies[1:], strict=True)
            if sum(self.inertials[name].mass for name in body if name in self.inertials) <= 0.0
        ]

    def check(self, findings: Findings) -> None:
        """Refuse what no body can be, note what a body hardly is."""
        for name in self._moving():
            link = self._links[name]
            where, line = link_named(name), link.inertial.line if link.inertial else link.line
            if name in self._wrong:
                remedy = f"write the inertia of the CAD model in kg·m², or {_WITH_MASS}"
                findings.refuse(where, line, self._wrong[name], remedy)
            elif link.inertial is not None:
                _check_scale(link, link.inertial, findings)
        for joint in self._massless():
            link = self._links[joint.child]
            given = "no inertial" if link.inertial is None else "a mass of 0 kg"
            text = (
                f"it has {given}, nor has anything fixed to it a mass, while the joint "
                f"{written(joint.name)} moves it"
            )
            line = link.inertial.line if link.inertial else link.line
            remedy = f"add <inertial> with its mass in kg and inertia in kg·m², or {_WITH_MASS}"
            findings.refuse(link_named(link.name), line, text, remedy)
        for name in self._bodies[0]:
            if name in self._wrong:
                line, text = self.inertials[name].line, self._wrong[name]
                remedy = "nothing to do: it stands on the base and doesn't move"
                findings.note(link_named(name), line, text, remedy)
        self._note_weightless(findings)

    def _note_weightless(self, findings: Findings) -> None:
        massless = {joint.child for joint in self._massless()}
        for name in self._moving():
            link = self._links[name]
            mass = self.inertials[name].mass if name in self.inertials else 0.0
            if mass == 0.0 and name not in massless and link.visuals:
                text = "it has a shape and no mass; it weighs nothing"
                remedy = "nothing to do if its mass is in the link that it is fixed to"
                findings.note(link_named(name), link.line, text, remedy)

    def spread(self, total: float, meshes: Meshes, findings: Findings) -> None:
        """Give what has no mass, or no physical one, a part of the arm's by its volume.

        Args:
            total: mass of the whole arm in [kg]; what other links weigh is taken off.
            meshes: where they are.
            findings: takes what each link was given, or why there is nothing to give.
        """
        where = "total_mass"
        if not 0.0 < total < inf:
            text = f"total_mass must be above 0 kg, got {total:g}"
            findings.refuse(where, None, text, "give the datasheet's mass in kg")
            return
        if not self._massless() and not any(name in self._wrong for name in self._moving()):
            weight = sum(inertial.mass for inertial in self.inertials.values())
            text = f"total_mass isn't used: what moves has its masses, {figure(weight)} kg in all"
            findings.note(where, None, text, "remove <inertial> of the links to be replaced")
            return
        lacking = [
            link for link in self._links.values() if _empty(link) or link.name in self._wrong
        ]
        found = {link.name: link_body(link, meshes) for link in lacking}
        bodies = {name: body for name, body in found.items() if body is not None}
        kept = sum(
            inertial.mass
            for name, inertial in self.inertials.items()
            if name not in self._wrong and name not in bodies
        )
        volume = sum(body.volume for body, _ in bodies.values())
        if not bodies or volume <= 0.0:
            text = f"{figure(total)} kg can't be spread: {names(found)} have no shape with volume"
            remedy = "add <collision> with box, cylinder or sphere, or <inertial>"
            findings.refuse(where, None, text, remedy)
            return
        density = (total - kept) / volume
        if not _DENSITIES[0] <= density <= _DENSITIES[1]:
            text = (
                f"{figure(total)} kg less {figure(kept)} kg of the other links on "
                f"{figure(volume)} m³ is a density of {figure(density)} kg/m³, "
                f"allowed is {_DENSITIES[0]:g} to {_DENSITIES[1]:g}"
            )
            remedy = 'correct the mass, or the unit of the meshes: scale="0.001 0.001 0.001" for mm'
            findings.refuse(where, None, text, remedy)
            return
        for name, (body, source) in bodies.items():
            mass = density * body.volume
            x, y, z = (float(part) for part in body.centre)
            rows, columns = np.triu_indices(3)
            tensor = tuple(float(part) for part in density * body.inertia[rows, columns])
            link = self._links[name]
            line = link.inertial.line if link.inertial else link.line
            self.inertials[name] = Inertial(line, Pose((x, y, z)), mass, tensor)
            self._wrong.pop(name, None)
            text = (
                f"{figure(mass)} kg of the arm's {figure(total)} by the volume of its {source}, "
                f"{figure(body.volume)} m³ at {figure(density)} kg/m³; inertia of the same volume"
            )
            remedy = "write its own <inertial> when you know it"
            findings.assume(link_named(name), line, text, remedy)


def _check_scale(link: Link, inertial: Inertial, findings: Findings) -> None:
    """Note what is thin, and what looks like millimetres."""
    where, line = link_named(link.name), inertial.line
    moments = np.linalg.eigvalsh(inertial.tensor())
    if inertial.mass > 0.0 and moments[0] <= _FLAT * moments[2]:
        text = (
            f"{figure(inertial.mass)} kg with the principal moments {figures(moments)} kg·m²: "
            "a point, a line or a plane"
        )
        findings.note(where, line, text, "write the inertia of the CAD model in kg·m²")
    distance = float(np.linalg.norm(inertial.pose.xyz))
    if distance > LONGEST_LINK:
        text = (
            f"its centre of mass lies {figure(distance)} m from its frame; beyond "
            f"{LONGEST_LINK:g} m it looks like millimetres"
        )
        findings.note(where, line, text, "write it in metres")
    radius = float(np.sqrt(max(moments[2], 0.0) / inertial.mass)) if inertial.mass > 0.0 else 0.0
    if radius > LONGEST_LINK:
        text = (
            f"{figure(inertial.mass)} kg with a moment of {figure(moments[2])} kg·m² is a body of "
            f"{figure(radius)} m around; it looks like kg·mm²"
        )
        findings.note(where, line, text, "write it in kg·m²: a millionth of kg·mm²")


def check_each(description: Description, findings: Findings) -> None:
    """Refuse every inertial that no body has, where it isn't known which links move."""
    for link in description.links.values():
        text = not_physical(link.inertial) if link.inertial is not None else ""
        if text:
            line = link.inertial.line if link.inertial else link.line
            remedy = "write the inertia of the CAD model in kg·m²"
            findings.refuse(link_named(link.name), line, text, remedy)
