"""Write ``jaka_zu5.urdf`` from the tables: ``python -m slidetune.robot.arm.description.urdf``."""

from math import pi
from xml.sax.saxutils import quoteattr

from slidetune.robot.arm.description import JOINT_NAMES, LINK_NAMES, URDF_PATH
from slidetune.robot.arm.description.figures import (
    INERTIALS,
    JOINTS,
    MAX_JOINT_SPEED,
    JointFigures,
    LinkInertial,
)
from slidetune.robot.arm.description.primitives import PRIMITIVES, Box, Cylinder, Primitive

_HEADER = """<?xml version="1.0"?>
<!-- JAKA Zu 5. Written by robot/arm/description/urdf.py from the tables beside it: edit those.
     Lengths in m, angles in rad, masses in kg. README.md names the source of each figure.
     Inertials are the manufacturer's, unscaled: every link as solid steel, 96.3935 kg in all,
     while the real arm weighs 23 kg.
     Joint effort is an assumption, by analogy with the UR5e: nothing is published. -->
"""
_INERTIA_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_CYLINDER_RPY = {"x": (0.0, pi / 2, 0.0), "y": (-pi / 2, 0.0, 0.0), "z": (0.0, 0.0, 0.0)}


def _numbers(values: tuple[float, ...]) -> str:
    return quoteattr(" ".join(repr(value) for value in values))


def urdf_text() -> str:
    """Return the text of the URDF, the same at every call."""
    parts = [_HEADER, '<robot name="jaka_zu5">\n']
    for name, inertial, primitives in zip(LINK_NAMES, INERTIALS, PRIMITIVES, strict=True):
        parts += _link(name, inertial, primitives)
    for index, (name, joint) in enumerate(zip(JOINT_NAMES, JOINTS, strict=True)):
        parts += _joint(name, LINK_NAMES[index], LINK_NAMES[index + 1], joint)
    return "".join([*parts, "</robot>\n"])


def _link(name: str, inertial: LinkInertial, primitives: tuple[Primitive, ...]) -> list[str]:
    inertia = " ".join(
        f'{key}="{value!r}"' for key, value in zip(_INERTIA_KEYS, inertial.inertia, strict=True)
    )
    lines = [
        f'  <link name="{name}">\n',
        "    <inertial>\n",
        f'      <origin xyz={_numbers(inertial.com)} rpy="0 0 0"/>\n',
        f'      <mass value="{inertial.mass!r}"/>\n',
        f"      <inertia {inertia}/>\n",
        "    </inertial>\n",
        "    <visual>\n",
        f'      <geometry><mesh filename="meshes/{name}.glb"/></geometry>\n',
        "    </visual>\n",
    ]
    for primitive in primitives:
        lines += _collision(name, primitive)
    return [*lines, "  </link>\n"]


def _collision(link: str, primitive: Primitive) -> list[str]:
    rpy = (0.0, 0.0, 0.0)
    if isinstance(primitive, Cylinder):
        rpy = _CYLINDER_RPY[primitive.axis]
        shape = f'<cylinder radius="{primitive.radius!r}" length="{primitive.length!r}"/>'
    elif isinstance(primitive, Box):
        shape = f"<box size={_numbers(primitive.size)}/>"
    else:
        shape = f'<sphere radius="{primitive.radius!r}"/>'
    return [
        f'    <collision name="{link}.{primitive.name}">\n',
        f"      <origin xyz={_numbers(primitive.centre)} rpy={_numbers(rpy)}/>\n",
        f"      <geometry>{shape}</geometry>\n",
        "    </collision>\n",
    ]


def _joint(name: str, parent: str, child: str, joint: JointFigures) -> list[str]:
    return [
        f'  <joint name="{name}" type="revolute">\n',
        f"    <origin xyz={_numbers(joint.xyz)} rpy={_numbers(joint.rpy)}/>\n",
        f'    <parent link="{parent}"/>\n',
        f'    <child link="{child}"/>\n',
        '    <axis xyz="0 0 1"/>\n',
        f'    <limit lower="{joint.lower!r}" upper="{joint.upper!r}" '
        f'effort="{joint.effort!r}" velocity="{MAX_JOINT_SPEED!r}"/>\n',
        "  </joint>\n",
    ]


if __name__ == "__main__":
    URDF_PATH.write_text(urdf_text(), encoding="utf-8")
