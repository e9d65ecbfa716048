"""Limits and axes of the arm's joints: what is missing, what can't be, what looks like degrees."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isclose, pi, radians

import numpy as np

from slidetune.robot.arm.section import Robot
from slidetune.robot.doctor.urdf.description import LONGEST_LINK, Joint, Vector
from slidetune.robot.doctor.urdf.finding import Findings, figure, figures, joint_named
from slidetune.robot.fields.quantity import bounds

MOST_TURN = 4.0 * pi
"""Limits beyond it, in [rad], look like degrees (*ours*): real joints turn twice at most."""
_MOST_DEGREES = 3600.0
"""Limits beyond it are no degrees either (*ours*): some write 1e16 for none."""
UNIT_LENGTH = 1e-3
"""How far from one an axis's length may be without a word (*ours*): three digits are written."""
_SHORTEST_AXIS = 1e-6
_URDF_AXIS = (1.0, 0.0, 0.0)
"""Axis of a joint without one (*published*: URDF)."""


@dataclass(frozen=True)
class Limits:
    """Limits of one joint in [rad, rad/s, N·m] or [m, m/s, N], infinite where there are none."""

    lower: float = -inf
    upper: float = inf
    velocity: float = inf
    effort: float = inf


def unit_axis(joint: Joint, findings: Findings) -> Vector:
    """Return the axis of a joint, of length one; refuses a zero axis."""
    where = joint_named(joint.name)
    if joint.axis is None:
        text = "the joint has no axis; URDF's is taken, 1 0 0"
        findings.assume(where, joint.axis_line, text, 'write it: <axis xyz="0 0 1"/>')
        return _URDF_AXIS
    length = float(np.linalg.norm(joint.axis))
    if not _SHORTEST_AXIS <= length < inf:
        text = f"the axis {figures(joint.axis)} has no direction; its length must be 1"
        findings.refuse(where, joint.axis_line, text, 'write it: <axis xyz="0 0 1"/>')
        return _URDF_AXIS
    if abs(length - 1.0) > UNIT_LENGTH:
        text = (
            f"the axis {figures(joint.axis)} has the length {figure(length)}, not 1; "
            "only its direction is taken"
        )
        remedy = f'write <axis xyz="{figures(part / length for part in joint.axis)}"/>'
        findings.assume(where, joint.axis_line, text, remedy)
    x, y, z = (part / length for part in joint.axis)
    return (x, y, z)


def checked_limits(joint: Joint, findings: Findings) -> Limits:
    """Return the limits of a joint of the arm."""
    unit, force = ("m", "N") if joint.kind == "prismatic" else ("rad", "N·m")
    if joint.kind == "continuous":
        lower, upper = -inf, inf
        _check_endless(joint, findings)
    else:
        lower, upper = _range(joint, unit, findings)
    _check_soft(joint, lower, upper, unit, findings)
    missing = []
    values = {}
    for key, value in (("velocity", joint.limit.velocity), ("effort", joint.limit.effort)):
        values[key] = value if value is not None and value > 0.0 else inf
        if values[key] == inf:
            per = f"{unit}/s" if key == "velocity" else force
            given = "missing" if value is None else f"{figure(value)} {per}, must be above 0"
            missing.append(f"{key} is {given}")
    if missing:
        text = f"{'; '.join(missing)}: taken as no limit"
        remedy = f'write the datasheet\'s: <limit velocity="…" effort="…"/> in {unit}/s and {force}'
        findings.assume(joint_named(joint.name), joint.limit.line, text, remedy)
    _check_effort(joint, values["effort"], force, findings)
    return Limits(lower, upper, values["velocity"], values["effort"])


def _check_endless(joint: Joint, findings: Findings) -> None:
    """Say where a joint has limits that its type doesn't have."""
    if joint.limit.lower or joint.limit.upper:
        lower, upper = joint.limit.lower or 0.0, joint.limit.upper or 0.0
        text = f"it is continuous, which has no limits: lower {figure(lower)} and upper "
        text += f"{figure(upper)} rad don't count"
        remedy = 'write type="revolute" if it is to stay within them'
        findings.note(joint_named(joint.name), joint.limit.line, text, remedy)


def _check_soft(joint: Joint, lower: float, upper: float, unit: str, findings: Findings) -> None:
    """Say where the safety controller of a real arm would keep it within less."""
    low, high = joint.soft.lower, joint.soft.upper
    low, high = -inf if low is None else low, inf if high is None else high
    if low > lower or high < upper:
        low, high = max(low, lower), min(high, upper)
        text = (
            f"its safety controller keeps it within {figure(low)} to {figure(high)} {unit}, which "
            "is no part of the model"
        )
        remedy = "write these as lower and upper of <limit> if they are to count"
        findings.note(joint_named(joint.name), joint.soft.line, text, remedy)


def _check_effort(joint: Joint, effort: float, force: str, findings: Findings) -> None:
    """Say where an experiment can't have a joint's effort as its torque limit."""
    least, most = bounds(Robot, "torque_limit")
    if effort < inf and not least <= effort <= most:
        text = (
            f"effort is {figure(effort)} {force}; torque limits of an experiment are "
            f"{figure(least)} to {figure(most)} {force}: there it counts as "
            f"{figure(min(max(effort, least), most))}"
        )
        remedy = f"write the datasheet's effort in {force}; leave it out where there is no limit"
        findings.note(joint_named(joint.name), joint.limit.line, text, remedy)


def _range(joint: Joint, unit: str, findings: Findings) -> tuple[float, float]:
    where, limit = joint_named(joint.name), joint.limit
    remedy = f'write the datasheet\'s: <limit lower="…" upper="…"/> in {unit}'
    if not limit.lower and not limit.upper:
        given = "missing" if limit.lower is None and limit.upper is None else f"both 0 {unit}"
        text = f"lower and upper are {given}: taken as no limits"
        findings.assume(where, limit.line, text, remedy)
        return -inf, inf
    for key, value in (("lower", limit.lower), ("upper", limit.upper)):
        if value is None:
            text = f"{key} is missing; URDF's is taken, 0 {unit}"
            findings.assume(where, limit.line, text, remedy)
    lower, upper = limit.lower or 0.0, limit.upper or 0.0
    if lower >= upper:
        text = (
            f"lower is {figure(lower)} and upper {figure(upper)} {unit}; lower must be below upper"
        )
        findings.refuse(where, limit.line, text, f"swap them, or {remedy}")
    elif unit == "rad":
        _check_degrees(joint, lower, upper, findings)
    elif max(-lower, upper) > LONGEST_LINK:
        text = (
            f"it slides from {figure(lower)} to {figure(upper)} m; beyond {LONGEST_LINK:g} m it "
            "looks like millimetres"
        )
        remedy = f'in metres: lower="{figure(lower / 1000)}" upper="{figure(upper / 1000)}"'
        findings.note(where, limit.line, text, remedy)
    return lower, upper


def _check_degrees(joint: Joint, lower: float, upper: float, findings: Findings) -> None:
    whole = all(isclose(value, round(value), abs_tol=1e-6) for value in (lower, upper))
    if MOST_TURN < max(-lower, upper) <= _MOST_DEGREES and whole:
        text = (
            f"it turns from {figure(lower)} to {figure(upper)} rad; whole numbers beyond "
            f"{figure(MOST_TURN)} rad look like degrees"
        )
        remedy = f'in radians: lower="{figure(radians(lower))}" upper="{figure(radians(upper))}"'
        findings.note(joint_named(joint.name), joint.limit.line, text, remedy)


def check_losses(joint: Joint, findings: Findings) -> None:
    """Say which losses of the file are no part of the model."""
    damping, friction, line = joint.losses
    if damping or friction:
        slides = joint.kind == "prismatic"
        rate, force = ("N·s/m", "N") if slides else ("N·m·s/rad", "N·m")
        text = (
            f"its damping of {figure(damping)} {rate} and friction of {figure(friction)} {force} "
            "are no part of the model"
        )
        remedy = "enter them as the experiment's friction if they are to act"
        findings.note(joint_named(joint.name), line, text, remedy)


def check_lengths(joint: Joint, findings: Findings) -> None:
    """Say where a joint is so far from the one before that it looks like millimetres."""
    length = float(np.linalg.norm(joint.pose.xyz))
    if length > LONGEST_LINK:
        text = (
            f"it lies {figure(length)} m from its parent's frame; beyond {LONGEST_LINK:g} m it "
            "looks like millimetres"
        )
        remedy = f'in metres: xyz="{figures(part / 1000 for part in joint.pose.xyz)}"'
        findings.note(joint_named(joint.name), joint.line, text, remedy)
