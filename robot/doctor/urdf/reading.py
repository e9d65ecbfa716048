"""Reads the links and joints of a URDF; each wrong number or name is a finding."""

from __future__ import annotations

from collections.abc import Iterable

from slidetune.robot.doctor.urdf.description import (
    KINDS,
    Description,
    Inertial,
    Joint,
    Limit,
    Link,
    Shape,
)
from slidetune.robot.doctor.urdf.finding import (
    Findings,
    closest_first,
    joint_named,
    link_named,
    names,
)
from slidetune.robot.doctor.urdf.numbers import number, numbers, vector
from slidetune.robot.doctor.urdf.placing import pose, quaternions_count
from slidetune.robot.doctor.urdf.xml_tree import Element
from slidetune.robot.fields.written_value import written

MOST_LINKS = 500
"""Most links of a file (*ours*)."""
_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
Color = tuple[float, float, float, float]


def read_description(root: Element, findings: Findings) -> Description:
    """Return all links and joints that could be read.

    Args:
        root: the element ``robot``.
        findings: takes what is wrong; where it refuses, a value in the description may be zero.
    """
    colors, turned = _colors(root), quaternions_count(root, findings)
    elements = _named(root.all("link"), "link", findings)
    links = {
        name: _link(name, element, colors, findings, turned) for name, element in elements.items()
    }
    if not links:
        text = "the file has no links; an arm has a base and a link for each joint"
        findings.refuse("robot", root.line, text, "load the whole description of the arm")
    if len(links) > MOST_LINKS:
        text = f"the file has {len(links)} links, at most {MOST_LINKS} are read"
        findings.refuse("robot", root.line, text, "load a description of one arm")
    joints = {}
    for name, element in _named(root.all("joint"), "joint", findings).items():
        joint = _joint(name, element, links, findings, turned)
        if joint is not None:
            joints[name] = joint
    return Description(root.line, links, joints)


def _named(elements: Iterable[Element], tag: str, findings: Findings) -> dict[str, Element]:
    """Return the elements by their names, each of which must be there and be used once."""
    found: dict[str, Element] = {}
    for element in elements:
        name = element.attributes.get("name", "")
        if not name.strip():
            text = f"a {tag} has no name"
            findings.refuse(tag, element.line, text, 'give it one: name="…"')
        elif name in found:
            text = f"the name is used twice, first in line {found[name].line}; names must differ"
            findings.refuse(f"{tag} {written(name)}", element.line, text, "rename one of the two")
        else:
            found[name] = element
    return found


def _check_once(element: Element, tags: Iterable[str], where: str, findings: Findings) -> None:
    """Say which elements are there more than once."""
    for tag in tags:
        found = element.all(tag)
        if len(found) > 1:
            text = f"<{tag}> is there {len(found)} times in <{element.tag}>; the first counts"
            findings.assume(where, found[1].line, text, "remove the others")


def _color(material: Element | None) -> Color | None:
    color = material.first("color") if material is not None else None
    if color is None:
        return None
    # A colour that can't be read is no reason to say anything about an arm.
    values = numbers(color, "rgba", 4, "", Findings())
    if values is None or not all(0.0 <= value <= 1.0 for value in values):
        return None
    return (values[0], values[1], values[2], values[3])


def _colors(root: Element) -> dict[str, Color]:
    """Return the robot's materials by their names."""
    found = {}
    for material in root.all("material"):
        color = _color(material)
        if color is not None:
            found[material.attributes.get("name", "")] = color
    return found


def _link(
    name: str, element: Element, colors: dict[str, Color], findings: Findings, turned: bool
) -> Link:
    _check_once(element, ("inertial",), link_named(name), findings)
    shapes = {
        tag: [_shape(part, name, colors, findings, turned) for part in element.all(tag)]
        for tag in ("visual", "collision")
    }
    visuals, collisions = (
        tuple(shape for shape in shapes[tag] if shape is not None) for tag in shapes
    )
    inertial = _inertial(element.first("inertial"), name, findings, turned)
    return Link(name, element.line, inertial, visuals, collisions)


def _inertial(
    element: Element | None, link: str, findings: Findings, turned: bool
) -> Inertial | None:
    if element is None:
        return None
    where = link_named(link)
    _check_once(element, ("origin", "mass", "inertia"), where, findings)
    mass, inertia = element.first("mass"), element.first("inertia")
    if mass is None or "value" not in mass.attributes:
        text = "<inertial> has no mass in kg; taken as 0"
        findings.assume(where, element.line, text, 'write it: <mass value="…"/>')
    value = number(mass, "value", where, findings, "kg") if mass is not None else None
    found = {
        key: number(inertia, key, where, findings, "kg·m²") if inertia is not None else None
        for key in _INERTIA
    }
    missing = [key for key, one in found.items() if one is None]
    if inertia is not None and value and 0 < len(missing) < len(_INERTIA):
        given = {key for key in missing if key in inertia.attributes}
        if not given:
            text = f"<inertia> has no {', '.join(missing)} in kg·m²; taken as 0"
            findings.assume(where, inertia.line, text, "write out all six")
    if value is None and mass is not None and "value" in mass.attributes:
        return None
    tensor = tuple(found[key] or 0.0 for key in _INERTIA)
    return Inertial(element.line, pose(element, where, findings, turned), value or 0.0, tensor)


def _shape(
    element: Element, link: str, colors: dict[str, Color], findings: Findings, turned: bool
) -> Shape | None:
    where, geometry = link_named(link), element.first("geometry")
    form = geometry.children[0] if geometry is not None and geometry.children else None
    if form is None or form.tag not in ("mesh", "box", "cylinder", "sphere"):
        given = f"<{written(form.tag)}>" if form is not None else "nothing"
        text = f"<{element.tag}> has {given} as geometry, not mesh, box, cylinder or sphere"
        findings.note(where, element.line, text, "it isn't drawn; write one of the four")
        return None
    material = element.first("material")
    color = _color(material)
    if color is None and material is not None:
        color = colors.get(material.attributes.get("name", ""))
    place = pose(element, where, findings, turned)
    if form.tag == "mesh":
        filename = form.attributes.get("filename", "")
        scale = vector(form, "scale", where, findings) or Shape.scale
        return Shape(form.line, place, "mesh", (), filename, scale, color)
    size = _size(form, where, findings)
    if size is None:
        return None
    kind = {"box": "box", "cylinder": "cylinder"}.get(form.tag, "sphere")
    return Shape(form.line, place, kind, size, color=color)  # type: ignore[arg-type]


def _size(form: Element, where: str, findings: Findings) -> tuple[float, ...] | None:
    """Return the size of a primitive, ``None`` where it has none."""
    if form.tag == "box":
        size = numbers(form, "size", 3, where, findings, "m")
    else:
        keys = ("radius", "length") if form.tag == "cylinder" else ("radius",)
        parts = [number(form, key, where, findings, "m") for key in keys]
        size = tuple(part for part in parts if part is not None)
        size = size if len(size) == len(keys) else None
    if size is None or min(size) <= 0.0:
        text = f"the size of <{form.tag}> must be above 0 m, got {size if size else 'nothing'}"
        findings.note(where, form.line, text, "it isn't drawn; write its size in metres")
        return None
    return size


def _end(element: Element, tag: str, links: dict[str, Link], findings: Findings) -> str | None:
    """Return the link that a joint names as its parent or child, if it is there."""
    where, part = joint_named(element.attributes["name"]), element.first(tag)
    name = part.attributes.get("link") if part is not None else None
    if part is None or name is None:
        text = f'the joint has no <{tag} link="…">'
        findings.refuse(where, element.line, text, f"name the {tag} link; known: {names(links)}")
        return None
    if name not in links:
        text = f"its {tag} link {written(name)} isn't in the file"
        known = names(closest_first(name, links))
        findings.refuse(where, part.line, text, f"name one of the links: {known or 'none'}")
        return None
    return name


def _joint(
    name: str, element: Element, links: dict[str, Link], findings: Findings, turned: bool
) -> Joint | None:
    where, kind = joint_named(name), element.attributes.get("type", "")
    parent, child = (_end(element, tag, links, findings) for tag in ("parent", "child"))
    if kind not in KINDS:
        allowed = ", ".join(KINDS)
        text = f"its type is {written(kind) or 'missing'}, allowed are {allowed}"
        closest = closest_first(kind, KINDS)[0]
        findings.refuse(where, element.line, text, f'write one of these, such as type="{closest}"')
        return None
    if parent is None or child is None:
        return None
    once = ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics", "safety_controller")
    _check_once(element, once, where, findings)
    axis, mimic = element.first("axis"), element.first("mimic")
    return Joint(
        name,
        element.line,
        kind,
        parent,
        child,
        pose(element, where, findings, turned),
        vector(axis, "xyz", where, findings) if axis is not None else None,
        axis.line if axis is not None else element.line,
        _limit(element, where, findings),
        (mimic.attributes.get("joint", ""), mimic.line) if mimic is not None else None,
        _losses(element, where, findings),
        _soft_limit(element, where, findings),
    )


def _losses(element: Element, where: str, findings: Findings) -> tuple[float, float, int]:
    dynamics = element.first("dynamics")
    if dynamics is None:
        return 0.0, 0.0, element.line
    damping, friction = (
        number(dynamics, key, where, findings) or 0.0 for key in ("damping", "friction")
    )
    return damping, friction, dynamics.line


def _limit(element: Element, where: str, findings: Findings) -> Limit:
    limit = element.first("limit")
    if limit is None:
        return Limit(element.line)
    slides = element.attributes.get("type") == "prismatic"
    way, force = ("m", "N") if slides else ("rad", "N·m")
    units = {"lower": way, "upper": way, "velocity": f"{way}/s", "effort": force}
    out = "where there is no limit leave it out"
    ways = dict.fromkeys(("lower", "upper"), "where there is no limit leave out lower and upper")
    values = {
        key: number(limit, key, where, findings, unit, ways.get(key, out))
        for key, unit in units.items()
    }
    return Limit(limit.line, **values)


def _soft_limit(element: Element, where: str, findings: Findings) -> Limit:
    """Return the limits of the arm's own safety controller, as far as there are any."""
    soft = element.first("safety_controller")
    if soft is None:
        return Limit(element.line)
    unit = "m" if element.attributes.get("type") == "prismatic" else "rad"
    lower, upper = (
        number(soft, f"soft_{key}_limit", where, findings, unit) for key in ("lower", "upper")
    )
    return Limit(soft.line, lower, upper)
