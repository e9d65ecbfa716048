"""The arms that an experiment may be about, by name: those that ship, and the user's own."""

from __future__ import annotations

from difflib import get_close_matches
from functools import cache
from pathlib import Path

import pinocchio as pin

from slidetune.robot.arm.description import LINK_NAMES, MESH_DIR, POSES, URDF_PATH
from slidetune.robot.arm.kept import kept_arm, kept_names
from slidetune.robot.arm.known_arm import KnownArm
from slidetune.robot.arm.serial import Visual
from slidetune.robot.arm.teaching import PENDULUM, TWO_LINKS
from slidetune.robot.fields.written_value import written

__all__ = [
    "FLANGE",
    "SHIPPED",
    "KnownArm",
    "add_arm",
    "arm_named",
    "find_arm",
    "forget_arm",
    "known_arms",
    "shipped_arms",
]

SHIPPED = "jaka_zu5"
"""The arm of the paper."""
FLANGE = "flange_link"
_MOST_NAMES = 12
"""Most names that a refusal lists (*ours*)."""

_added: dict[str, KnownArm] = {}


@cache
def _shipped() -> dict[str, KnownArm]:
    model = pin.buildModelFromUrdf(str(URDF_PATH))
    home = tuple(POSES["tool_down_back"])
    looks = tuple(
        Visual(joint, pin.SE3.Identity(), MESH_DIR / f"{link}.glb")
        for joint, link in enumerate(LINK_NAMES)
    )
    meaning = "JAKA Zu 5, six joints, 5 kg, 954 mm."
    arms = (
        KnownArm(SHIPPED, "JAKA Zu 5", meaning, model, FLANGE, home, looks),
        _teaching("pendulum", "Pendulum", "A rod of 0.5 m and 1 kg on one joint.", PENDULUM),
        _teaching("two_links", "Two links", "Two rods of 0.4 m in a vertical plane.", TWO_LINKS),
    )
    return {arm.name: arm for arm in arms}


def _teaching(name: str, title: str, meaning: str, path: Path) -> KnownArm:
    model = pin.buildModelFromUrdf(str(path))
    shapes = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.VISUAL).geometryObjects
    looks = tuple(_primitive(shape) for shape in shapes)
    return KnownArm(name, title, meaning, model, "tip", (0.0,) * model.nv, looks)


def _primitive(shape: pin.GeometryObject) -> Visual:
    """Return a box or a cylinder as Pinocchio reads it, by halves."""
    form, joint, place = shape.geometry, int(shape.parentJoint), shape.placement
    if hasattr(form, "halfSide"):
        x, y, z = (2.0 * float(half) for half in form.halfSide)
        return Visual(joint, place, box=(x, y, z))
    return Visual(joint, place, cylinder=(float(form.radius), 2.0 * float(form.halfLength)))


def shipped_arms() -> dict[str, KnownArm]:
    """Return the arms that ship, by name."""
    return dict(_shipped())


def known_arms() -> dict[str, KnownArm]:
    """Return all arms by name, those that ship first; reads all that are kept.

    A kept arm that is damaged is left out: ``kept_arms`` tells of it.
    """
    found = {**_shipped(), **_added}
    for name in kept_names():
        if name not in found and (arm := _found(name)) is not None:
            found[name] = arm
    return found


def add_arm(arm: KnownArm) -> None:
    """Let experiments of this process be about an arm.

    Raises:
        ValueError: if one that ships has its name, or its tip is not on its last joint.
    """
    frame = arm.model.frames[arm.model.getFrameId(arm.tip)]
    if frame.parentJoint != arm.joints:
        raise ValueError(f"the tip {arm.tip} of {arm.name} is not on its last joint")
    if arm.name in _shipped():
        raise ValueError(f"{arm.name} is the name of an arm that ships")
    _added[arm.name] = arm


def forget_arm(name: str) -> None:
    """Let no further experiment of this process be about an arm that was added."""
    _added.pop(name, None)


def find_arm(name: str) -> KnownArm | None:
    """Return an arm, ``None`` where there is none of that name.

    One that is kept is read when it is first asked for, and stays known to this process.

    Raises:
        ValueError: if what is kept under that name is damaged.
    """
    arm = _shipped().get(name) or _added.get(name)
    if arm is None and (arm := kept_arm(name)) is not None:
        add_arm(arm)
    return arm


def _found(name: str) -> KnownArm | None:
    try:
        return find_arm(name)
    except ValueError:
        return None


def arm_named(name: str) -> KnownArm:
    """Return an arm.

    Raises:
        ValueError: if no arm has that name, or it is damaged; says which there are, and how to
            add one.
    """
    arm = find_arm(name)
    if arm is not None:
        return arm
    names = list(dict.fromkeys([*_shipped(), *_added, *kept_names()]))
    close = get_close_matches(name[:200], names, 1)
    guess = f" (did you mean {close[0]}?)" if close else ""
    more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    raise ValueError(
        f"no arm named {written(name)} is known here{guess}: there are "
        f"{', '.join(names[:_MOST_NAMES])}{more}. Add it by its URDF: slidetune arm add FILE, or "
        "--urdf FILE, or drop the file on the page"
    )
