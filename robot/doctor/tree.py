"""The tree of links: one root, no loops."""

from __future__ import annotations

from dataclasses import dataclass

from slidetune.robot.doctor.urdf.description import Description, Joint
from slidetune.robot.doctor.urdf.finding import Findings, link_named, names
from slidetune.robot.fields.written_value import written


@dataclass(frozen=True)
class Tree:
    """How links hang together.

    Attributes:
        root: the link that no joint moves.
        above: the joint that carries a link; the root has none.
        below: the joints that a link carries, in the file's order.
        order: all links, each after the one that carries it.
    """

    root: str
    above: dict[str, Joint]
    below: dict[str, list[Joint]]
    order: tuple[str, ...]

    def path(self, link: str) -> list[Joint]:
        """Return the joints from the root to a link."""
        found = []
        while link in self.above:
            found.append(self.above[link])
            link = self.above[link].parent
        return found[::-1]

    def depths(self, all_joints: bool = False) -> dict[str, int]:
        """Return how many free joints follow each link along the longest way, or all that move."""
        deepest = dict.fromkeys(self.order, 0)
        for link in reversed(self.order):
            for joint in self.below[link]:
                counts = joint.kind != "fixed" if all_joints else joint.free
                deepest[link] = max(deepest[link], deepest[joint.child] + counts)
        return deepest


def tree_of(description: Description, findings: Findings) -> Tree | None:
    """Return the tree of a description whose joints name known links; ``None`` if it is none."""
    above: dict[str, Joint] = {}
    below: dict[str, list[Joint]] = {link: [] for link in description.links}
    for joint in description.joints.values():
        if joint.child in above:
            other = above[joint.child]
            findings.refuse(
                link_named(joint.child),
                joint.line,
                f"the link is the child of two joints, {written(other.name)} in line {other.line} "
                f"and {written(joint.name)}: a loop, while URDF has trees only",
                "remove one of the two joints; closed chains can't be simulated here",
            )
            return None
        above[joint.child] = joint
        below[joint.parent].append(joint)
    roots = [link for link in description.links if link not in above]
    if len(roots) > 1:
        text = f"{len(roots)} links have no parent ({names(roots)}); one must carry all others"
        remedy = "connect them by fixed joints, or remove what isn't connected"
        line = description.links[roots[1]].line
        findings.refuse(link_named(roots[1]), line, text, remedy)
        return None
    order = list(roots)
    for link in order:
        order += [joint.child for joint in below[link]]
    lost = [link for link in description.links if link not in set(order)]
    if lost:
        text = f"links carry each other in a circle: {names(lost)}"
        remedy = "remove the joint that closes the circle; one link must have no parent"
        findings.refuse(link_named(lost[0]), description.links[lost[0]].line, text, remedy)
        return None
    return Tree(roots[0], above, below, tuple(order))
