"""Where an arm ends: the tip that was asked for, or the end of the longest serial chain."""

from __future__ import annotations

from dataclasses import dataclass

from slidetune.robot.doctor.tree import Tree
from slidetune.robot.doctor.urdf.description import Description, Joint
from slidetune.robot.doctor.urdf.finding import Findings, closest_first, link_named, names
from slidetune.robot.fields.written_value import written


def chosen_tip(
    description: Description, tree: Tree, tip: str | None, findings: Findings
) -> str | None:
    """Return the link at the arm's end.

    Args:
        description: all links.
        tree: how they hang together.
        tip: a link's name, or ``None`` for the default.
        findings: takes a note where others would do as well, a refusal of an unknown tip.

    Returns:
        ``None`` where there is no such link.
    """
    if tip is None:
        return _default_tip(description, tree, findings)
    if tip in description.links:
        return tip
    text = f"no link is named {written(tip)}, which is to be the tip"
    known = names(closest_first(tip, description.links))
    findings.refuse(f"tip {written(tip)}", None, text, f"choose one of the links: {known}")
    return None


@dataclass(frozen=True)
class _Walk:
    """The longest chain from a link on.

    Attributes:
        last: its last link.
        rivals: the first links of other chains as long.
        fingers: the joints of a gripper, where it ends at one.
    """

    last: str
    rivals: tuple[str, ...] = ()
    fingers: tuple[str, ...] = ()


def _default_tip(description: Description, tree: Tree, findings: Findings) -> str:
    walk = _walk(tree, tree.root)
    ends = _ends(tree, walk.last)
    others = list(ends[1:])
    for rival in walk.rivals:
        others += _ends(tree, _walk(tree, rival).last)[:1]
    text = f"the tip is {written(ends[0])}"
    if others:
        text += (
            f"; {names(others)} would be as far from the base "
            "(the tip is the end of the longest serial chain, the first one in the file)"
        )
    if walk.fingers:
        text += f"; the joints {names(walk.fingers)} look like a gripper's and are not the arm's"
    if others or walk.fingers:
        line = description.links[ends[0]].line
        findings.note(link_named(ends[0]), line, text, "name the tip if it is another one: --tip")
    return ends[0]


def _walk(tree: Tree, link: str) -> _Walk:
    """Follow the longest chain from a link to where moving joints end, or to a gripper.

    A gripper is where a chain splits into branches that are all shorter than the chain so far,
    two of them as long as each other but for one joint (*ours*).
    """
    free, moving = tree.depths(), tree.depths(all_joints=True)
    before = sum(joint.free for joint in tree.path(link))
    rivals: list[str] = []
    while True:
        branches = [
            joint for joint in tree.below[link] if moving[joint.child] or joint.kind != "fixed"
        ]
        lengths = [free[joint.child] + joint.free for joint in branches]
        longest = max(lengths, default=0)
        spread = sorted(moving[joint.child] + (joint.kind != "fixed") for joint in branches)
        alike = len(branches) > 1 and spread[-2] >= spread[-1] - 1
        if not branches or (alike and before > longest):
            fingers = [joint.name for joint in branches if joint.kind != "fixed"]
            return _Walk(link, tuple(rivals), tuple(fingers or [j.name for j in branches]))
        best, *equal = [
            joint for joint, length in zip(branches, lengths, strict=True) if length == longest
        ]
        rivals += [joint.child for joint in equal]
        link, before = best.child, before + best.free


def _ends(tree: Tree, link: str) -> list[str]:
    """Return what is fixed to the body of a link and most fixed joints away, first one first."""
    path = tree.path(link)
    while path and path[-1].kind == "fixed":
        link = path.pop().parent
    steps = {link: 0}
    for carried in tree.order:
        joint = tree.above.get(carried)
        if joint is not None and joint.kind == "fixed" and joint.parent in steps:
            steps[carried] = steps[joint.parent] + 1
    most = max(steps.values())
    return [name for name, count in steps.items() if count == most]


def limbs_of(tree: Tree, words: tuple[str, ...]) -> list[str]:
    """Return where limbs begin, of at least two free joints each, whose names hold such a word."""

    def named(joint: Joint) -> bool:
        text = f"{joint.name} {joint.child}".lower()
        return joint.free and any(word in text for word in words)

    starts: dict[str, int] = {}
    limb_of: dict[str, str] = {}
    for link in tree.order[1:]:
        joint = tree.above[link]
        limb = limb_of.get(joint.parent)
        if named(joint):
            limb = limb or joint.name
            starts[limb] = starts.get(limb, 0) + 1
        if limb is not None:
            limb_of[link] = limb
    return [name for name, count in starts.items() if count > 1]
