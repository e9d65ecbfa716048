"""A known arm as a document of plain JSON values, and back: what is kept of it, and sent of it."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isfinite
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.chain import turned_axis
from slidetune.robot.arm.known_arm import DIGITS, KnownArm, digest_of, is_own_name
from slidetune.robot.arm.serial import Visual
from slidetune.robot.fields.quantity import MOST_JOINTS

Array = np.ndarray
Document = dict[str, Any]

FORMAT = 1
"""Version of the document's format."""
MOST_VISUALS = 2000
"""Most parts of an arm's looks (*ours*): a description has 500 links at most."""
_LONGEST = 4000
"""Most characters of a name or a title (*ours*)."""


class DamagedArmError(ValueError):
    """A document that is no arm, or not the one that its name says."""


def document_of(arm: KnownArm, meshes: Mapping[Path, str] | None = None) -> Document:
    """Return an arm as plain JSON values.

    Args:
        arm: the arm.
        meshes: names of the files of its meshes; without them it is a document without looks.
    """
    model = arm.model
    flange = model.frames[model.getFrameId(arm.tip)].placement
    visuals = arm.visuals if meshes is not None else ()
    return {
        "format": FORMAT,
        "name": arm.name,
        "title": arm.title,
        "meaning": arm.meaning,
        "tip": arm.tip,
        "home": list(arm.home),
        "gravity": model.gravity.linear.tolist(),
        "joints": [_joint(model, number) for number in range(1, model.njoints)],
        "flange": _place(flange),
        "visuals": [_visual(visual, meshes or {}) for visual in visuals],
    }


def _place(placement: pin.SE3) -> Document:
    rotation = np.asarray(placement.rotation)
    return {"rotation": rotation.tolist(), "translation": placement.translation.tolist()}


def _joint(model: pin.Model, number: int) -> Document:
    found, inertia = turned_axis(model, number), model.inertias[number]
    if found is None:
        raise ValueError(f"joint {number} neither turns about nor slides along one axis")
    motion = np.asarray(model.joints[number].createData().S).ravel()
    limits = {
        "lower": model.lowerPositionLimit,
        "upper": model.upperPositionLimit,
        "velocity": model.velocityLimit,
        "effort": model.effortLimit,
    }
    return {
        "name": model.names[number],
        "slides": found[1],
        "axis": (motion[:3] if found[1] else motion[3:]).tolist(),
        "place": _place(model.jointPlacements[number]),
        "mass": float(inertia.mass),
        "center": inertia.lever.tolist(),
        "inertia": np.asarray(inertia.inertia).tolist(),
        **{key: _or_none(values[number - 1]) for key, values in limits.items()},
    }


def _or_none(value: float) -> float | None:
    return float(value) if isfinite(value) else None


def _visual(visual: Visual, meshes: Mapping[Path, str]) -> Document:
    return {
        "joint": visual.joint,
        "place": _place(visual.placement),
        "mesh": meshes[visual.mesh] if visual.mesh is not None else None,
        "scale": list(visual.scale),
        "box": None if visual.box is None else list(visual.box),
        "cylinder": None if visual.cylinder is None else list(visual.cylinder),
        "sphere": visual.sphere,
        "color": None if visual.color is None else list(visual.color),
    }


def arm_from(document: object, meshes: Path | None = None) -> KnownArm:
    """Return the arm of a document.

    Args:
        document: what ``document_of`` returned, read again from JSON.
        meshes: the folder of its meshes; without one it is an arm without looks.

    Raises:
        DamagedArmError: if it is none, or another one than its name says.
    """
    if not isinstance(document, Mapping):
        raise DamagedArmError("it is no document of an arm")
    if document.get("format") != FORMAT:
        raise DamagedArmError(f"its format is not {FORMAT}: it is of another Slidetune")
    try:
        return _arm(document, meshes)
    except DamagedArmError:
        raise
    # Whatever a damaged file makes of the numbers, Pinocchio's own errors among them.
    except (KeyError, TypeError, ValueError, AttributeError, IndexError, RuntimeError) as error:
        raise DamagedArmError(f"{type(error).__name__}: {str(error)[:200]}") from error


def _arm(document: Mapping[str, Any], meshes: Path | None) -> KnownArm:
    name, tip, joints = _text(document["name"]), _text(document["tip"]), document["joints"]
    if not (is_own_name(name) and 1 <= len(joints) <= MOST_JOINTS):
        raise DamagedArmError("its name or the number of its joints is none of an arm's")
    model = pin.Model()
    model.name = name
    model.gravity.linear = _numbers(document["gravity"], (3,))
    for number, joint in enumerate(joints, 1):
        _add_joint(model, number, joint)
    count = len(joints)
    for key, end, target in (
        ("lower", -inf, model.lowerPositionLimit),
        ("upper", inf, model.upperPositionLimit),
        ("velocity", inf, model.velocityLimit),
        ("effort", inf, model.effortLimit),
    ):
        target[:] = [end if joint[key] is None else _number(joint[key]) for joint in joints]
    flange = _se3(document["flange"])
    model.addFrame(pin.Frame(tip, count, 0, flange, pin.FrameType.BODY))
    if digest_of(model, tip) != name[-DIGITS:]:
        raise DamagedArmError("its numbers are not those of the arm of its name")
    home = tuple(_numbers(document["home"], (count,)).tolist())
    shown = document["visuals"] if meshes is not None else []
    if len(shown) > MOST_VISUALS:
        raise DamagedArmError(f"it has more than {MOST_VISUALS} visuals")
    return KnownArm(
        name,
        _text(document["title"]),
        _text(document["meaning"]),
        model,
        tip,
        home,
        tuple(_visual_of(visual, count, meshes or Path()) for visual in shown),
    )


def _add_joint(model: pin.Model, number: int, joint: Mapping[str, Any]) -> None:
    axis = _numbers(joint["axis"], (3,))
    if abs(float(np.linalg.norm(axis)) - 1.0) > 1e-6:
        raise DamagedArmError("an axis has not the length 1")
    kind = pin.JointModelPrismaticUnaligned if joint["slides"] else pin.JointModelRevoluteUnaligned
    index = model.addJoint(number - 1, kind(axis), _se3(joint["place"]), _text(joint["name"]))
    inertia = pin.Inertia(
        _number(joint["mass"]), _numbers(joint["center"], (3,)), _numbers(joint["inertia"], (3, 3))
    )
    model.appendBodyToJoint(index, inertia, pin.SE3.Identity())


def _visual_of(visual: Mapping[str, Any], count: int, meshes: Path) -> Visual:
    joint, mesh = visual["joint"], visual["mesh"]
    if type(joint) is not int or not 0 <= joint <= count:
        raise DamagedArmError("a visual is on a joint that isn't there")
    if mesh is not None and (Path(_text(mesh)).name != mesh or mesh.startswith(".")):
        raise DamagedArmError("the name of a mesh is no name of a file")
    x, y, z = _numbers(visual["scale"], (3,)).tolist()
    sphere = visual["sphere"]
    return Visual(
        joint,
        _se3(visual["place"]),
        None if mesh is None else meshes / mesh,
        (x, y, z),
        _tuple(visual["box"], 3),
        _tuple(visual["cylinder"], 2),
        None if sphere is None else _number(sphere),
        _tuple(visual["color"], 4),
    )


def _se3(place: Mapping[str, Any]) -> pin.SE3:
    rotation = _numbers(place["rotation"], (3, 3))
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-6 or np.linalg.det(rotation) < 0.0:
        raise DamagedArmError("a rotation is none")
    return pin.SE3(rotation, _numbers(place["translation"], (3,)))


def _tuple(values: object, size: int) -> Any:
    return None if values is None else tuple(_numbers(values, (size,)).tolist())


def _numbers(values: object, shape: tuple[int, ...]) -> Array:
    found = np.array(values, dtype=float)
    if found.shape != shape or not np.isfinite(found).all():
        raise DamagedArmError("numbers are missing, too many or not finite")
    return found


def _number(value: object) -> float:
    return float(_numbers(value, ()))


def _text(value: object) -> str:
    if not isinstance(value, str) or len(value) > _LONGEST:
        raise DamagedArmError("a text is missing or too long")
    return value
