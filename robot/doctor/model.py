"""Pinocchio's model of a chain that the doctor has found sound."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np
import pinocchio as pin

from slidetune.robot.doctor.limits import Limits
from slidetune.robot.doctor.urdf.description import Description, Inertial, Joint, Pose, Vector
from slidetune.robot.doctor.urdf.finding import Findings, figures, joint_named
from slidetune.robot.fields.written_value import written

_STATES = 4
"""Places at which the mass matrix is looked at (*ours*)."""
_SINGULAR = 1e-12
"""Part of its largest eigenvalue that M's smallest must have (*ours*): below it, doubles invert
M to no digit that means anything.
"""
_FLAT = 1e-12
"""Part of the largest moment that the smallest one of a body must have (*ours*)."""


def _numbers(values: Iterable[float]) -> str:
    return quoteattr(" ".join(repr(value) for value in values))


def _origin(pose: Pose) -> str:
    return f"<origin xyz={_numbers(pose.xyz)} rpy={_numbers(pose.rpy)}/>"


def _link(name: str, inertial: Inertial | None) -> str:
    if inertial is None:
        return f"<link name={quoteattr(name)}/>"
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    tensor = " ".join(f'{k}="{v!r}"' for k, v in zip(keys, inertial.inertia, strict=True))
    return (
        f"<link name={quoteattr(name)}><inertial>{_origin(inertial.pose)}"
        f'<mass value="{inertial.mass!r}"/><inertia {tensor}/></inertial></link>'
    )


def frame_name(description: Description, joint: Joint) -> str:
    """Return how a joint is called in the model: as in the file, unless a link is called so.

    In a model both are frames, and a name may stand for one of them only.
    """
    name = joint.name
    if name not in description.links and name != "universe":
        return name
    while name in description.links or name in description.joints or name == "universe":
        name += "_joint"
    return name


def _joint(joint: Joint, name: str, axis: Vector) -> str:
    # A continuous joint has two numbers in Pinocchio. Its limits are set on the model.
    kind = "revolute" if joint.kind == "continuous" else joint.kind
    return (
        f'<joint name={quoteattr(name)} type="{kind}">{_origin(joint.pose)}'
        f"<parent link={quoteattr(joint.parent)}/><child link={quoteattr(joint.child)}/>"
        f"<axis xyz={_numbers(axis)}/>"
        '<limit lower="0" upper="0" velocity="0" effort="0"/></joint>'
    )


def urdf_text(
    description: Description, axes: Mapping[str, Vector], inertials: Mapping[str, Inertial]
) -> str:
    """Return a URDF of what moves, with the numbers that were read and those that were assumed.

    Args:
        description: all links and joints.
        axes: by joint, of length one; others have URDF's own, along x.
        inertials: by link.
    """

    def parts() -> Iterator[str]:
        yield '<robot name="arm">'
        for name in description.links:
            yield _link(name, inertials.get(name))
        for joint in description.joints.values():
            axis = axes.get(joint.name, (1.0, 0.0, 0.0))
            yield _joint(joint, frame_name(description, joint), axis)
        yield "</robot>"

    return "\n".join(parts())


def build_chain(
    text: str, names: Sequence[str], limits: Sequence[Limits], findings: Findings
) -> pin.Model | None:
    """Return the model of a chain, all other joints held at their neutral place.

    Args:
        text: what ``urdf_text`` returned.
        names: of the chain's joints in the model, from base to tip.
        limits: of each.
        findings: takes a refusal of what can't be built.

    Returns:
        ``None`` where that was refused.
    """
    try:
        full = pin.buildModelFromXML(text)
        held = [full.getJointId(name) for name in full.names[1:] if name not in set(names)]
        model = pin.buildReducedModel(full, held, pin.neutral(full))
    except (ValueError, RuntimeError, IndexError) as error:
        reason = f"Pinocchio can't make a model of it: {written(str(error))}"
        remedy = "check it with check_urdf, and the names of links and joints for odd characters"
        findings.refuse("robot", None, reason, remedy)
        return None
    if list(model.names[1:]) != list(names) or model.nq != model.nv:
        reason = "Pinocchio finds other joints in it than those between base and tip"
        remedy = "check the names of links and joints for odd characters"
        findings.refuse("robot", None, reason, remedy)
        return None
    model.lowerPositionLimit = np.array([limit.lower for limit in limits])
    model.upperPositionLimit = np.array([limit.upper for limit in limits])
    model.velocityLimit = np.array([limit.velocity for limit in limits])
    model.effortLimit = np.array([limit.effort for limit in limits])
    return model


def moves_like_bodies(model: pin.Model, chain: Sequence[Joint], findings: Findings) -> bool:
    """Return whether bodies have an extent and M is positive definite; refuse them otherwise."""
    sound = True
    for joint, inertia in zip(chain, list(model.inertias)[1:], strict=True):
        tensor = np.asarray(inertia.inertia)
        moments = np.linalg.eigvalsh(tensor) if np.isfinite(tensor).all() else np.full(3, np.nan)
        if not (inertia.mass > 0.0 and moments[0] > _FLAT * moments[2]):
            sound = False
            text = (
                f"what it moves has {inertia.mass:g} kg and the principal moments "
                f"{figures(moments)} kg·m²; all must be finite and above 0"
            )
            remedy = "write <inertial> of the link that it carries, in kg and kg·m²"
            findings.refuse(joint_named(joint.name), joint.line, text, remedy)
    data, places = model.createData(), np.random.default_rng(0)
    for q in places.uniform(-1.0, 1.0, (_STATES if sound else 0, model.nq)):
        upper = np.triu(pin.crba(model, data, q))
        whole = upper + np.triu(upper, 1).T
        values = np.linalg.eigvalsh(whole) if np.isfinite(whole).all() else np.zeros(1)
        if values[0] <= _SINGULAR * values[-1]:
            text = "the mass matrix isn't positive definite: no finite torque moves the arm"
            remedy = "look for masses, inertias or lengths that are many orders apart"
            findings.refuse("robot", None, text, remedy)
            return False
    return sound
