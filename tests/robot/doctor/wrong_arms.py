"""Arms with one thing wrong, by name: the text, where it is wrong, words of the finding."""

from __future__ import annotations

from tests.robot.doctor.arm_text import (
    FORE_INERTIAL,
    HERE,
    SHOULDER_LIMIT,
    UPPER_INERTIA,
    added,
    chain,
    changed,
    joint,
    link,
)

AXIS = '<axis xyz="0 1 0"/>'
MANY = changed('<joint name="j12" ', f'{HERE}<joint name="j12" ', chain(13))

REFUSED = {
    "word for a number": (
        changed('<mass value="2.0"/>', f'<mass value="two"/>{HERE}'),
        "link upper", "value of <mass> must be one number in kg, none beyond 1e+30, got two",
    ),
    "nan": (
        changed(AXIS, f'{HERE}<axis xyz="0 nan 0"/>'),
        "joint shoulder", "xyz of <axis> must be 3 numbers with blanks between, none beyond 1e+30",
    ),
    "comma": (
        changed('<origin xyz="0 0 0.4"', f'{HERE}<origin xyz="0,0,0.4"'),
        "joint elbow", "xyz of <origin> must be 3 numbers with blanks between in m",
    ),
    "two numbers": (
        changed('rpy="0.1 0 0.2"', f'rpy="0.1 0"{HERE}'.replace(HERE, "")).replace(
            '<origin xyz="0 0 0.4"', f'{HERE}<origin xyz="0 0 0.4"'
        ),
        "joint elbow", "rpy of <origin> must be 3 numbers with blanks between in rad",
    ),
    "beyond doubles": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="-1e400" upper="2"/>'),
        "joint shoulder", "lower of <limit> must be one number in rad, none beyond 1e+30, got -1",
    ),
    "zero axis": (
        changed(AXIS, f'{HERE}<axis xyz="0 0 0"/>'),
        "joint shoulder", "the axis 0 0 0 has no direction; its length must be 1",
    ),
    "lower above upper": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="2" upper="-2" velocity="3" effort="5"/>'),
        "joint shoulder", "lower is 2 and upper -2 rad; lower must be below upper",
    ),
    "no inertial": (
        changed(FORE_INERTIAL, "").replace('<link name="fore">', f'{HERE}<link name="fore">'),
        "link fore", "it has no inertial, nor has anything fixed to it a mass",
    ),
    "mass of zero": (
        changed('<mass value="1.0"/>', '<mass value="0"/>').replace(
            FORE_INERTIAL.splitlines()[0] + '\n      <origin xyz="0 0 0.15"/>',
            f'{HERE}<inertial>\n<origin xyz="0 0 0.15"/>',
        ),
        "link fore", "it has a mass of 0 kg",
    ),
    "negative mass": (
        changed("    <inertial>\n", f"    <inertial>{HERE}\n").replace('"2.0"', '"-2.0"'),
        "link upper", "its mass is -2 kg, must be above 0",
    ),
    "not positive definite": (
        changed("    <inertial>\n", f"    <inertial>{HERE}\n").replace('ixy="0"', 'ixy="0.05"', 1),
        "link upper", "its principal moments are -0.02 0.004 0.08 kg·m²; all must be above 0",
    ),
    "triangle inequality": (
        changed("    <inertial>\n", f"    <inertial>{HERE}\n").replace(
            'izz="0.004"', 'izz="0.4"'
        ),
        "link upper", "its principal moments are 0.03 0.03 0.4 kg·m²; the largest must not exceed",
    ),
    "point mass": (
        changed(UPPER_INERTIA, "").replace(
            '<joint name="shoulder"', f'{HERE}<joint name="shoulder"'
        ),
        "joint shoulder", "what it moves has 2 kg and the principal moments 0 0 0 kg·m²",
    ),
    "type": (
        changed('name="elbow" type="revolute"', f'name="elbow" type="revolut"{HERE}').replace(
            f'"revolut"{HERE}>', f'"revolut">{HERE}'
        ),
        "joint elbow", "its type is revolut, allowed are revolute, continuous, prismatic, fixed",
    ),
    "floating base": (
        changed('name="shoulder" type="revolute">', f'name="shoulder" type="floating">{HERE}'),
        "joint shoulder", "the base floats: the joint's type is floating, and only arms on a fixed",
    ),
    "planar base": (
        changed('name="shoulder" type="revolute">', f'name="shoulder" type="planar">{HERE}'),
        "joint shoulder", "the base floats: the joint's type is planar",
    ),
    "floating joint": (
        changed('name="elbow" type="revolute">', f'name="elbow" type="floating">{HERE}'),
        "joint elbow", "its type is floating; joints between base and tip may be revolute",
    ),
    "mimic": (
        changed(
            '<axis xyz="0 1 0"/>\n    <limit lower="-2.5"',
            f'<mimic joint="shoulder"/>{HERE}\n    <limit lower="-2.5"',
        ),
        "joint elbow", "it follows the joint shoulder (mimic) and lies between base and tip",
    ),
    "unknown parent": (
        changed('<parent link="upper"/>', f'<parent link="uper"/>{HERE}'),
        "joint elbow", "its parent link uper isn't in the file",
    ),
    "no child": (
        changed('<joint name="elbow"', f'{HERE}<joint name="elbow"').replace(
            '<child link="fore"/>', ""
        ),
        "joint elbow", 'the joint has no <child link="…">',
    ),
    "link twice": (
        added(f'{HERE}<link name="upper"/>'),
        "link upper", "the name is used twice, first in line 6",
    ),
    "joint twice": (
        added(link("more"), HERE, joint("elbow", "tool", "more")),
        "joint elbow", "the name is used twice, first in line 35",
    ),
    "no name": (added(f"{HERE}<link/>"), "link", "a link has no name"),
    "two roots": (
        added(f'{HERE}<link name="table"/>'),
        "link table", "2 links have no parent (base, table); one must carry all others",
    ),
    "two parents": (
        added(HERE, joint("strut", "base", "fore")),
        "link fore", "the child of two joints, elbow in line 35 and strut: a loop",
    ),
    "circle": (
        added(HERE, link("a"), link("b"), joint("ab", "a", "b"), joint("ba", "b", "a")),
        "link a", "links carry each other in a circle: a, b",
    ),
    "all in a circle": (
        added(joint("back", "tool", "base")).replace(
            '<link name="base">', f'{HERE}<link name="base">'
        ),
        "link base", "links carry each other in a circle: base, upper, fore, tool",
    ),
    "too many": (MANY, "joint j12", "13 joints move between base and tip, at most 12 can"),
    "no joints": (
        f'{HERE}<robot name="stone"><link name="stone"/></robot>',
        "robot", "no joint moves between the base stone and the tip stone",
    ),
    "no links": (f'{HERE}<robot name="empty"/>', "robot", "the file has no links"),
    "turned twice": (
        changed('<robot name="two">', '<robot name="two" version="1.2">').replace(
            '<origin xyz="0 0 0.4" rpy="0.1 0 0.2"/>',
            f'{HERE}<origin xyz="0 0 0.4" rpy="0.1 0 0.2" quat_xyzw="0 0 0 1"/>',
        ),
        "joint elbow", "<origin> has rpy and quat_xyzw; it is turned by one of the two",
    ),
    "three numbers of a quaternion": (
        changed('<robot name="two">', '<robot name="two" version="1.2">').replace(
            '<origin xyz="0 0 0.15"/>', f'{HERE}<origin quat_xyzw="0 0 1"/>'
        ),
        "link fore", "quat_xyzw of <origin> must be 4 numbers with blanks between",
    ),
    "quaternion in a version that isn't known": (
        changed('<robot name="two">', f'{HERE}<robot name="two" version="2.0">').replace(
            '<origin xyz="0 0 0.1"/>', '<origin xyz="0 0 0.1" quat_xyzw="0 0 0 1"/>'
        ),
        "robot", "the file's version is 2.0, not 1.0, 1.1 or 1.2: whether its quat_xyzw, first",
    ),
    "endless limit": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="-inf" upper="2"/>'),
        "joint shoulder", "lower of <limit> must be one number in rad, none beyond 1e+30, got -inf",
    ),
    "many orders apart": (
        chain(3).replace('<origin xyz="0 0 0.2"/>', '<origin xyz="0 1e-15 0"/>').replace(
            f'name="l3"><inertial><mass value="0.5"/>{UPPER_INERTIA}',
            'name="l3"><inertial><mass value="1e30"/><inertia ixx="1e30" iyy="1e30" izz="1e30"/>',
        ),
        "robot", "the mass matrix isn't positive definite",
    ),
}  # fmt: skip
ASSUMED = {
    "no velocity": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="-2" upper="2" effort="50"/>'),
        "joint shoulder", "velocity is missing: taken as no limit",
    ),
    "effort of zero": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="-2" upper="2" velocity="3" effort="0"/>'),
        "joint shoulder", "effort is 0 N·m, must be above 0: taken as no limit",
    ),
    "no limit": (
        changed(SHOULDER_LIMIT, "").replace(
            '<joint name="shoulder"', f'{HERE}<joint name="shoulder"'
        ),
        "joint shoulder", "lower and upper are missing: taken as no limits",
    ),
    "limits of zero": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="0" upper="0" velocity="3" effort="50"/>'),
        "joint shoulder", "lower and upper are both 0 rad: taken as no limits",
    ),
    "one limit": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit upper="2" velocity="3" effort="50"/>'),
        "joint shoulder", "lower is missing; URDF's is taken, 0 rad",
    ),
    "long axis": (
        changed(AXIS, f'{HERE}<axis xyz="0 3 4"/>'),
        "joint shoulder", "the axis 0 3 4 has the length 5, not 1; only its direction is taken",
    ),
    "no axis": (
        changed(AXIS, "").replace('<joint name="shoulder"', f'{HERE}<joint name="shoulder"'),
        "joint shoulder", "the joint has no axis; URDF's is taken, 1 0 0",
    ),
    "held": (
        added(link("head"), HERE, joint("neck", "base", "head")),
        "joint neck", "it is not between base and tip: held at its neutral place, 0 rad",
    ),
    "held out of its limits": (
        added(link("head"), HERE, joint("neck", "base", "head").replace('"-2"', '"1"')),
        "joint neck", "0 rad, which is not within its limits 1 to 2",
    ),
    "held mimic": (
        added(
            link("head"), HERE, joint("neck", "base", "head", "prismatic", '<mimic joint="elbow"/>')
        ),
        "joint neck", "follows the joint elbow (mimic): held at its neutral place, 0 m",
    ),
    "held floating": (
        added(link("ball"), HERE, joint("flight", "base", "ball", "floating")),
        "joint flight", "it is not between base and tip: held at its neutral place",
    ),
    "no name": (
        changed('<robot name="two">', f"<robot>{HERE}"),
        "robot", "the robot has no name; it is called arm like the file",
    ),
    "no mass": (
        changed(
            '<link name="tool"/>',
            f'{HERE}<link name="tool"><inertial>{UPPER_INERTIA}</inertial></link>',
        ),
        "link tool", "<inertial> has no mass in kg; taken as 0",
    ),
    "limits twice": (
        changed(SHOULDER_LIMIT, f'{SHOULDER_LIMIT}\n{HERE}<limit lower="-1" upper="1"/>'),
        "joint shoulder", "<limit> is there 2 times in <joint>; the first counts",
    ),
    "quaternion without a version": (
        changed('<origin xyz="0 0 0.1"/>', f'{HERE}<origin quat_xyzw="0 0 0.6 0.8"/>'),
        "joint shoulder", "quat_xyzw counts from URDF 1.1 on, and <robot> has version 1.0 or none",
    ),
    "long quaternion": (
        changed('<robot name="two">', '<robot name="two" version="1.2">').replace(
            '<origin xyz="0 0 0.1"/>', f'{HERE}<origin quat_xyzw="0 0 3 4"/>'
        ),
        "joint shoulder", "quat_xyzw of <origin>, 0 0 3 4, has the length 5, not 1",
    ),
    "quaternion of no length": (
        changed('<robot name="two">', '<robot name="two" version="1.2">').replace(
            '<origin xyz="0 0 0.1"/>', f'{HERE}<origin quat_xyzw="0 0 0 0"/>'
        ),
        "joint shoulder", "quat_xyzw of <origin> is 0 0 0 0, of no length; taken as no turn",
    ),
    "half an inertia": (
        changed(UPPER_INERTIA, f'{HERE}<inertia ixx="0.03" iyy="0.03" izz="0.004"/>'),
        "link upper", "<inertia> has no ixy, ixz, iyz in kg·m²; taken as 0",
    ),
}  # fmt: skip
NOTED = {
    "losses": (
        changed(SHOULDER_LIMIT, f'{SHOULDER_LIMIT}\n{HERE}<dynamics damping="0.5" friction="2"/>'),
        "joint shoulder", "its damping of 0.5 N·m·s/rad and friction of 2 N·m are no part",
    ),
    "limits of an endless joint": (
        changed('name="shoulder" type="revolute"', 'name="shoulder" type="continuous"').replace(
            SHOULDER_LIMIT, f"{HERE}{SHOULDER_LIMIT}"
        ),
        "joint shoulder", "it is continuous, which has no limits: lower -2 and upper 2 rad don't",
    ),
    "soft limits": (
        changed(
            SHOULDER_LIMIT,
            f'{SHOULDER_LIMIT}\n{HERE}<safety_controller soft_lower_limit="-0.5" '
            'soft_upper_limit="2.5" k_velocity="1"/>',
        ),
        "joint shoulder", "its safety controller keeps it within -0.5 to 2 rad, which is no part",
    ),
    "weak": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="-2" upper="2" velocity="3" effort="0.002"/>'),
        "joint shoulder", "effort is 0.002 N·m; torque limits of an experiment are 0.01 to 5000",
    ),
    "strong": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="-2" upper="2" velocity="3" effort="1e20"/>'),
        "joint shoulder", "effort is 1e+20 N·m; torque limits of an experiment are 0.01 to 5000",
    ),
    "degrees": (
        changed(SHOULDER_LIMIT, f'{HERE}<limit lower="-170" upper="90" velocity="3" effort="5"/>'),
        "joint shoulder", "whole numbers beyond 12.5664 rad look like degrees",
    ),
    "millimetres of a joint": (
        changed('<joint name="elbow"', f'{HERE}<joint name="elbow"').replace("0 0 0.4", "0 0 400"),
        "joint elbow", "it lies 400 m from its parent's frame; beyond 20 m it looks like mill",
    ),
    "millimetres of a slide": (
        changed('name="shoulder" type="revolute"', 'name="shoulder" type="prismatic"').replace(
            SHOULDER_LIMIT, f'{HERE}<limit lower="0" upper="300" velocity="3" effort="5"/>'
        ),
        "joint shoulder", "it slides from 0 to 300 m; beyond 20 m it looks like millimetres",
    ),
    "millimetres of a centre": (
        changed("    <inertial>\n", f"    <inertial>{HERE}\n").replace("0 0 0.2", "0 0 200", 1),
        "link upper", "its centre of mass lies 200 m from its frame",
    ),
    "inertia in kg·mm²": (
        changed("    <inertial>\n", f"    <inertial>{HERE}\n").replace(
            UPPER_INERTIA, UPPER_INERTIA.replace('="0.03"', '="30000"').replace("0.004", "4000")
        ),
        "link upper", "it looks like kg·mm²",
    ),
    "large primitive": (
        changed('<cylinder radius="0.04" length="0.4"/>', f'{HERE}<sphere radius="90"/>'),
        "link upper", "its sphere is 90 m large; it looks like millimetres",
    ),
    "size of zero": (
        changed('<sphere radius="0.05"/>', f'{HERE}<sphere radius="0"/>'),
        "link fore", "the size of <sphere> must be above 0 m",
    ),
    "shape without a mass": (
        changed('<link name="tool"/>', f'{HERE}<link name="tool"><visual><geometry>'
                '<sphere radius="0.01"/></geometry></visual></link>'),
        "link tool", "it has a shape and no mass; it weighs nothing",
    ),
    "line of mass": (
        changed('izz="0.001"', 'izz="0"').replace('<link name="tool"/>', link("tool")).replace(
            '<inertial>\n      <origin xyz="0 0 0.15"/>',
            f'<inertial>{HERE}\n      <origin xyz="0 0 0.15"/>',
        ),
        "link fore", "a point, a line or a plane",
    ),
    "wrong inertia of the base": (
        changed('<link name="base">', f'<link name="base">{HERE}<inertial><mass value="1"/>'
                '<inertia ixx="1" iyy="1" izz="9"/></inertial>'),
        "link base", "the largest must not exceed the sum of the others",
    ),
}  # fmt: skip
