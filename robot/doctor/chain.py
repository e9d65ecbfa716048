"""The serial chain from the base to the tip, and what keeps it from being an arm's."""

from __future__ import annotations

from slidetune.robot.doctor.tip import limbs_of
from slidetune.robot.doctor.tree import Tree
from slidetune.robot.doctor.urdf.description import FREE, Description, Joint
from slidetune.robot.doctor.urdf.finding import Findings, joint_named, names
from slidetune.robot.fields.quantity import MOST_JOINTS
from slidetune.robot.fields.written_value import written

_LEG_WORDS = ("leg", "foot", "hip", "knee", "thigh", "calf", "shank", "ankle", "haa", "hfe", "kfe")
"""What joints and links of legs are called (*inferred* from example-robot-data)."""
_FIXED_BASE = "only arms on a fixed base can be simulated here"


def chain_to(
    description: Description, tree: Tree, tip: str, asked: bool, findings: Findings
) -> list[Joint]:
    """Return the joints of the arm, from base to tip.

    Args:
        description: all links and joints.
        tree: how they hang together.
        tip: the link at the end.
        asked: whether somebody chose that link.
        findings: takes all that isn't a fixed base or a joint of an arm, and what is held.
    """
    path = [joint for joint in tree.path(tip) if joint.kind != "fixed"]
    for number, joint in enumerate(path):
        _check_kind(joint, number == 0, findings)
    _check_legs(description, tree, asked, findings)
    chain = [joint for joint in path if joint.free]
    if not path:
        text = f"no joint moves between the base {written(tree.root)} and the tip {written(tip)}"
        moving = [joint.name for joint in description.joints.values() if joint.free]
        remedy = (
            f"choose a tip beyond one of the joints {names(moving)}: --tip"
            if moving
            else "an arm has 1 to 12 revolute, continuous or prismatic joints"
        )
        findings.refuse("robot", description.line, text, remedy)
    if len(chain) > MOST_JOINTS:
        joint = chain[MOST_JOINTS]
        text = (
            f"{len(chain)} joints move between base and tip, at most {MOST_JOINTS} can; "
            "this one is the first too many"
        )
        remedy = (
            f"choose a tip before it, such as {written(joint.parent)} (--tip), or write "
            'type="fixed" where nothing moves'
        )
        findings.refuse(joint_named(joint.name), joint.line, text, remedy)
    _say_held(description, path, findings)
    return chain


def _check_kind(joint: Joint, first: bool, findings: Findings) -> None:
    where = joint_named(joint.name)
    if joint.mimic is not None:
        leader, line = joint.mimic
        text = f"it follows the joint {written(leader)} (mimic) and lies between base and tip"
        remedy = "remove <mimic> if it has a motor of its own, or choose a tip before it: --tip"
        findings.refuse(where, line, text, remedy)
    elif joint.kind not in FREE and first:
        text = f"the base floats: the joint's type is {joint.kind}, and {_FIXED_BASE}"
        remedy = 'write type="fixed" if the arm is mounted'
        findings.refuse(where, joint.line, text, remedy)
    elif joint.kind not in FREE:
        text = (
            f"its type is {joint.kind}; joints between base and tip may be {', '.join(FREE)}, "
            "with one number each"
        )
        remedy = "write it as joints of one axis each, or choose a tip before it: --tip"
        findings.refuse(where, joint.line, text, remedy)


def _check_legs(description: Description, tree: Tree, asked: bool, findings: Findings) -> None:
    legs = limbs_of(tree, _LEG_WORDS)
    if len(legs) < 2:
        return
    joint = description.joints[legs[0]]
    text = (
        f"a robot on legs has a floating base ({len(legs)} of its limbs look like legs, from the "
        f"joints {names(legs)} on), and {_FIXED_BASE}"
    )
    where = joint_named(joint.name)
    if asked:
        text += f"; the base {written(tree.root)} is held fixed"
        findings.assume(where, joint.line, text, "take what it does for an arm on a stand")
    else:
        remedy = "name the end of one arm to load it with the base held fixed: --tip"
        findings.refuse(where, joint.line, text, remedy)


def _say_held(description: Description, path: list[Joint], findings: Findings) -> None:
    """Say which joints are held, and where that is out of their limits."""
    on_the_way = {joint.name for joint in path}
    for joint in description.joints.values():
        if joint.kind == "fixed" or joint.name in on_the_way:
            continue
        where = joint_named(joint.name)
        why = "is not between base and tip"
        if joint.mimic is not None:
            why += f" and follows the joint {written(joint.mimic[0])} (mimic)"
        unit = {"prismatic": "0 m", "revolute": "0 rad", "continuous": "0 rad"}.get(joint.kind)
        text = f"it {why}: held at its neutral place" + (f", {unit}" if unit else "")
        lower, upper = joint.limit.lower or 0.0, joint.limit.upper or 0.0
        if joint.kind in ("revolute", "prismatic") and not lower <= 0.0 <= upper:
            text += f", which is not within its limits {lower:.6g} to {upper:.6g}"
        findings.assume(where, joint.line, text, "choose another tip if it is one of the arm's")
