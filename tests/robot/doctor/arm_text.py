"""A sound arm of two joints as text, and the same with one thing wrong in a known line."""

from __future__ import annotations

from pathlib import Path

from slidetune.robot.doctor.examine import Examined, Finding, examine

HERE = "<!--here-->"
"""Marks the line that a finding is to name."""
GOOD = """<?xml version="1.0"?>
<robot name="two">
  <link name="base">
    <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision>
  </link>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 0.2"/>
      <mass value="2.0"/>
      <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.004"/>
    </inertial>
    <visual>
      <origin xyz="0 0 0.2"/>
      <geometry><cylinder radius="0.04" length="0.4"/></geometry>
    </visual>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0 0 0.15"/>
      <mass value="1.0"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.001"/>
    </inertial>
    <visual>
      <geometry><sphere radius="0.05"/></geometry>
    </visual>
  </link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.1"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="50"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0 0 0.4" rpy="0.1 0 0.2"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2.5" upper="1.5" velocity="4" effort="20"/>
  </joint>
  <joint name="wrist" type="fixed">
    <origin xyz="0 0 0.3"/>
    <parent link="fore"/>
    <child link="tool"/>
  </joint>
</robot>
"""
SHOULDER_LIMIT = '<limit lower="-2" upper="2" velocity="3" effort="50"/>'
UPPER_INERTIA = '<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.004"/>'
FORE_INERTIAL = GOOD[GOOD.index('    <inertial>\n      <origin xyz="0 0 0.15"/>') :].partition(
    "    <visual>"
)[0]


def changed(old: str, new: str, text: str = GOOD) -> str:
    """Return the text with its first ``old`` replaced, which must be there."""
    assert old in text, old
    return text.replace(old, new, 1)


def joint(name: str, parent: str, child: str, kind: str = "revolute", inside: str = "") -> str:
    """Return a joint in lines of its own."""
    limit = "" if kind == "fixed" else SHOULDER_LIMIT
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="0 0 0.2"/><parent link="{parent}"/>'
        f'<child link="{child}"/><axis xyz="0 1 0"/>{limit}{inside}</joint>\n'
    )


def link(name: str) -> str:
    """Return a link with a mass."""
    return f'<link name="{name}"><inertial><mass value="0.5"/>{UPPER_INERTIA}</inertial></link>\n'


def chain(count: int) -> str:
    """Return an arm of ``count`` joints."""
    links = "".join(link(f"l{number}") for number in range(count + 1))
    joints = "".join(joint(f"j{n}", f"l{n}", f"l{n + 1}") for n in range(count))
    return f'<robot name="chain">\n{links}{joints}</robot>\n'


def added(*parts: str, text: str = GOOD) -> str:
    """Return the text with more links and joints."""
    return changed("</robot>", "".join(parts) + "</robot>", text)


def examined(folder: Path, text: str, **how: object) -> Examined:
    """Return what the doctor says about a text."""
    path = folder / "arm.urdf"
    path.write_text(text, encoding="utf-8")
    return examine(path, **how)  # type: ignore[arg-type]


def marked_line(text: str) -> int | None:
    """Return the line of the mark, where there is one."""
    return text[: text.index(HERE)].count("\n") + 1 if HERE in text else None


def only(found: Examined, kind: str) -> list[Finding]:
    """Return the findings of a kind."""
    return [finding for finding in found.findings if finding.kind == kind]


def agrees(found: Examined) -> bool:
    """Return whether there is an arm exactly where nothing is refused."""
    return (found.arm is None) == bool(only(found, "refused"))
