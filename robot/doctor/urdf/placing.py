"""Where the origin of an element lies, and how it is turned: by three angles or a quaternion."""

from __future__ import annotations

import re

import numpy as np
import pinocchio as pin

from slidetune.robot.doctor.urdf.description import Pose, Vector
from slidetune.robot.doctor.urdf.finding import Findings, figure, figures
from slidetune.robot.doctor.urdf.numbers import numbers, vector
from slidetune.robot.doctor.urdf.xml_tree import Element
from slidetune.robot.fields.written_value import written

Array = np.ndarray

QUATERNION = "quat_xyzw"
_VERSION = re.compile(r"\s*([0-9]+)\.([0-9]+)\s*")
_WITHOUT, _WITH = {(1, 0)}, {(1, 1), (1, 2)}
"""Versions of URDF in which an origin has no quaternion, and in which it may have one (*published*:
urdfdom, by which Pinocchio reads)."""
_UNIT = 1e-3
"""How far from one a quaternion's length may be without a word (*ours*): three digits are
written."""


def quaternions_count(root: Element, findings: Findings) -> bool:
    """Return whether the quaternions of a file count: from URDF 1.1 on.

    A version that isn't known is refused where there is a quaternion; else it makes no difference.
    """
    given = root.attributes.get("version", "1.0")
    found = _VERSION.fullmatch(given)
    version = (int(found[1][:9]), int(found[2][:9])) if found else None
    if version in _WITHOUT | _WITH:
        return version in _WITH
    using = (one for one in root.within() if one.tag == "origin" and QUATERNION in one.attributes)
    first = next(using, None)
    if first is not None:
        text = (
            f"the file's version is {written(given) or 'empty'}, not 1.0, 1.1 or 1.2: whether its "
            f"{QUATERNION}, first in line {first.line}, counts isn't known"
        )
        findings.refuse("robot", root.line, text, 'write <robot version="1.2"> if it does')
    return False


def pose(element: Element | None, where: str, findings: Findings, quaternions: bool) -> Pose:
    """Return the place that ``origin`` of an element gives, zero where there is none.

    Args:
        element: has the origin, or doesn't.
        where: the link or joint, for a finding.
        findings: takes a refusal of what are no numbers, and of an origin that is turned twice.
        quaternions: whether they count in this file; see ``quaternions_count``.
    """
    origin = element.first("origin") if element is not None else None
    if origin is None:
        return Pose()
    xyz = vector(origin, "xyz", where, findings, "m")
    rpy = vector(origin, "rpy", where, findings, "rad")
    if QUATERNION in origin.attributes:
        turned = _angles(origin, where, findings, quaternions)
        rpy = turned if quaternions else rpy
    return Pose(xyz or Pose.xyz, rpy or Pose.rpy)


def _angles(origin: Element, where: str, findings: Findings, counts: bool) -> Vector | None:
    """Return roll, pitch and yaw of a quaternion in [rad]; says what is odd about it."""
    if not counts:
        found = numbers(origin, QUATERNION, 4, where, Findings())
        text = (
            f"{QUATERNION} counts from URDF 1.1 on, and <robot> has version 1.0 or none: it is "
            "ignored, as by Pinocchio"
        )
        angles = _rpy(np.array(found)) if found else Pose.rpy
        instead = f', or rpy="{" ".join(f"{angle:.15g}" for angle in angles)}"' if found else ""
        findings.assume(where, origin.line, text, f'write <robot version="1.2">{instead}')
        return None
    if "rpy" in origin.attributes:
        text = f"<origin> has rpy and {QUATERNION}; it is turned by one of the two"
        findings.refuse(where, origin.line, text, "remove one of them")
        return None
    found = numbers(origin, QUATERNION, 4, where, findings)
    if found is None:
        return None
    values = np.array(found)
    length = _length(values)
    if length == 0.0:
        text = f"{QUATERNION} of <origin> is {figures(values)}, of no length; taken as no turn"
        findings.assume(where, origin.line, text, f'write {QUATERNION}="0 0 0 1"')
    elif abs(length - 1.0) > _UNIT:
        text = (
            f"{QUATERNION} of <origin>, {figures(values)}, has the length {figure(length)}, not 1; "
            "it is divided by that"
        )
        unit = " ".join(f"{part:.15g}" for part in values / length)
        findings.assume(where, origin.line, text, f'write {QUATERNION}="{unit}"')
    return _rpy(values)


def _length(quaternion: Array) -> float:
    """Return its length as the parser has it: 0 where the squares underflow."""
    return float(np.sqrt(quaternion @ quaternion))


def _rpy(quaternion: Array) -> Vector:
    length = _length(quaternion)
    if length == 0.0:
        return Pose.rpy
    turn = pin.Quaternion(quaternion / length).toRotationMatrix()
    roll, pitch, yaw = (float(angle) for angle in pin.rpy.matrixToRpy(turn))
    return roll, pitch, yaw
