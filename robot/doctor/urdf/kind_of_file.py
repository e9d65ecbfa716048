"""Whether a file is a URDF at all, and ready to be read."""

from __future__ import annotations

from slidetune.robot.doctor.urdf.finding import Findings
from slidetune.robot.doctor.urdf.xml_tree import Element
from slidetune.robot.fields.written_value import written

_EXPAND = "expand it first: xacro file.urdf.xacro > out.urdf, and load out.urdf"
_CONVERT = "load the URDF that it was made from, or convert it to URDF"
_OTHER_ROOTS = {
    "sdf": ("SDF (Gazebo)", _CONVERT),
    "gazebo": ("SDF (Gazebo)", _CONVERT),
    "mujoco": ("MJCF (MuJoCo)", _CONVERT),
    "mujocoinclude": ("MJCF (MuJoCo)", _CONVERT),
    "COLLADA": ("COLLADA, a mesh", "load the URDF whose links name this mesh"),
    "launch": ("a launch file", "load the URDF that it names"),
    "package": ("a ROS package's manifest", "load a URDF of that package"),
}


def is_urdf(root: Element, findings: Findings) -> bool:
    """Return whether this is a URDF without macros; says what else it is."""
    if root.tag in _OTHER_ROOTS:
        kind, remedy = _OTHER_ROOTS[root.tag]
        findings.refuse("file", root.line, f"the file is {kind}, not URDF", remedy)
        return False
    if root.tag != "robot":
        text = f"the root element is <{written(root.tag)}>, a URDF has <robot>"
        findings.refuse("file", root.line, text, "load a URDF file")
        return False
    return not _has_macros(root, findings)


def _is_macro(element: Element) -> bool:
    return element.tag.startswith("xacro:") or (
        # Other elements, such as Gazebo's, may have dollars of their own.
        element.tag in ("link", "joint", "parent", "child", "origin", "mass", "limit", "mesh")
        and any("${" in value or "$(" in value for value in element.attributes.values())
    )


def _has_macros(root: Element, findings: Findings) -> bool:
    found = [element for element in root.within() if _is_macro(element)]
    if found:
        first = found[0]
        value = next((value for value in first.attributes.values() if "$" in value), "")
        example = f"<{written(first.tag)}>" + (f" with {written(value)}" if value else "")
        text = f"the file is xacro, not URDF: {len(found)} elements such as {example}"
        findings.refuse("file", first.line, text, _EXPAND)
    return bool(found)
