"""What the header of a column says of itself: which quantity, of which joint."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from slidetune.robot.recordings.units import split_unit

ANGLE, VELOCITY, TORQUE, CURRENT = "angle", "velocity", "torque", "current"

_QUANTITIES = {
    ANGLE: "q pos position positions angle angles theta",
    VELOCITY: "v dq qdot vel velocity velocities speed omega",
    TORQUE: "tau torque torques effort efforts trq moment force",
    CURRENT: "i current currents",
}
_QUANTITY = {word: name for name, words in _QUANTITIES.items() for word in words.split()}
_REFERENCE = {
    *("d", "des", "desired", "target", "targets", "cmd", "command", "commanded"),
    *("ref", "reference", "setpoint"),
}
_MEASURED = {"actual", "measured", "meas", "act", "feedback"}
_SILENT = {"joint", "joints", "j", "axis", "state", "states", "data", "robot", "arm"} | _MEASURED
_TWO_MEANINGS = "qd"
"""Velocity or desired angle: UR's logs mean the velocity and say ``actual`` or ``target``."""
_TOKENS = re.compile(r"[a-z]+|[0-9]+|[^\W0-9_]+")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")


@dataclass(frozen=True)
class Meaning:
    """What a column holds.

    Attributes:
        quantity: angle, velocity, torque or current.
        reference: whether it is what was asked for, not what was measured.
        joint: number of the joint from 0, or ``None`` where the header has an index.
        index: index in the header, which counts from 0 or from 1.
        unit: as it stands there, empty for none.
        source: what stands before it, such as a topic or a lane's name.
    """

    quantity: str
    reference: bool
    joint: int | None
    index: int | None
    unit: str
    source: str


def meaning_of(header: str, joints: Sequence[str]) -> Meaning | None:
    """Return what a column holds, ``None`` where its header doesn't say that clearly.

    Args:
        header: such as ``q1 [rad]``, ``joint_1.velocity``, ``actual_q_0`` or
            ``/joint_states/elbow/position``.
        joints: names of the arm's joints.
    """
    # As a whole, should what looks like a unit be the end of a joint's name, such as joint_s.
    for name, unit in (split_unit(header), (header.strip(), "")):
        parts = name.split("/")
        # The longest end of the path that is clear: what stands before it is its source.
        for first in range(len(parts)):
            found = _said("/".join(parts[first:]), joints)
            if found is not None:
                return Meaning(*found, unit, "/".join(parts[:first]).strip("/"))
    return None


def _said(text: str, joints: Sequence[str]) -> tuple[str, bool, int | None, int | None] | None:
    joint, rest = _named_joint(text, joints)
    words = _TOKENS.findall(_CAMEL.sub(" ", rest).lower())
    numbers = [int(word[:9]) for word in words if word.isdecimal()]
    quantities = {_QUANTITY[word] for word in words if word in _QUANTITY}
    reference = any(word in _REFERENCE for word in words)
    if _TWO_MEANINGS in words:
        if not reference and not _MEASURED & set(words):
            return None
        quantities.add(VELOCITY)
    known = _QUANTITY.keys() | _REFERENCE | _SILENT | {_TWO_MEANINGS}
    if any(word not in known for word in words if not word.isdecimal()) or len(quantities) > 1:
        return None
    if len(numbers) != (1 if joint is None else 0) or not (quantities or _is_joint(joint, words)):
        return None
    index = numbers[0] if joint is None else None
    return (quantities.pop() if quantities else ANGLE), reference, joint, index


def _is_joint(joint: int | None, words: Sequence[str]) -> bool:
    """Tell whether a column without a quantity is called like a joint, which is its angle."""
    return joint is not None or any(word in ("joint", "j", "axis") for word in words)


def _named_joint(text: str, joints: Sequence[str]) -> tuple[int | None, str]:
    """Return the joint that is named in a text, the longest name first, and the rest of it."""
    for joint in sorted(range(len(joints)), key=lambda j: -len(joints[j])):
        name = re.escape(joints[joint])
        found = re.search(rf"(?<![^\W_]){name}(?![^\W_])", text, re.IGNORECASE)
        if found:
            return joint, f"{text[: found.start()]} {text[found.end() :]}"
    return None, text
