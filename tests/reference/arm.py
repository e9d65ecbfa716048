"""The arm of the reference, put together from the manufacturer's figures alone.

It shares nothing with ``robot/``: no URDF, no builder. Figures: *vendor*.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

Array = np.ndarray

JOINTS = 6
DATASHEET = 23.0 / 96.3935
"""The real arm's mass over that of its description (*vendor*)."""

# Placement of each joint in the one before: roll [rad] and translation [m].
_PLACES = (
    (0.0, (0.0, 0.0, 0.12015)),
    (0.5 * np.pi, (0.0, 0.0, 0.0)),
    (0.0, (0.43, 0.0, 0.0)),
    (0.0, (0.3685, 0.0, -0.114)),
    (0.5 * np.pi, (0.0, -0.1135, 0.0)),
    (-0.5 * np.pi, (0.0, 0.107, 0.0)),
)
# Mass [kg], centre [m], and ixx ixy ixz iyy iyz izz about it [kg m^2].
_LINKS = (
    (
        15.135,
        (-2.5186e-7, 0.0033226, -0.001509),
        (0.044302, 1.5349e-7, -6.1966e-7, 0.043091, 1.4326e-5, 0.030523),
    ),
    (
        45.847,
        (0.215, 6.4325e-9, -0.14315),
        (0.10377, -1.3562e-6, 2.544e-7, 1.5964, 2.1509e-8, 1.5689),
    ),
    (
        18.069,
        (0.19087, -1.1862e-5, -0.010587),
        (0.022066, -3.4554e-6, -0.022609, 0.41632, 1.1508e-8, 0.41071),
    ),
    (
        5.5525,
        (-2.1345e-6, -0.0058004, 0.0026717),
        (0.0092564, 1.1341e-7, -1.2578e-8, 0.0052251, -8.3499e-5, 0.0089683),
    ),
    (
        6.3339,
        (-2.0304e-6, -0.0028889, -0.0023424),
        (0.012993, -1.0764e-7, 5.8559e-9, 0.0058454, 4.5426e-5, 0.0127),
    ),
    (
        1.4169,
        (2.7652e-5, -1.3485e-5, -0.021245),
        (0.00071853, -6.9778e-7, -6.378e-7, 0.00072375, 8.3072e-7, 0.0011337),
    ),
)


def arm(robot: dict[str, Any], mismatch: float = 1.0, payload: bool = True) -> pin.Model:
    """Return the arm that the section ``robot`` of an experiment describes.

    Args:
        robot: the section as plain values.
        mismatch: factor on the inertials of the arm, for the nominal one.
        payload: whether the payload is part of it.
    """
    scale = DATASHEET if robot["inertials"] == "datasheet" else 1.0
    scale *= robot["inertia_scale"] * mismatch
    model = pin.Model()
    joint = 0
    for number, ((roll, place), (mass, centre, about)) in enumerate(
        zip(_PLACES, _LINKS, strict=True)
    ):
        rotation = pin.rpy.rpyToMatrix(roll, 0.0, 0.0)
        placement = pin.SE3(rotation, np.array(place))
        joint = model.addJoint(joint, pin.JointModelRZ(), placement, f"joint{number + 1}")
        xx, xy, xz, yy, yz, zz = about
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        body = pin.Inertia(scale * mass, np.array(centre), scale * inertia)
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
    load = robot["payload"]
    if payload and load["mass"] > 0.0:
        point = pin.Inertia(load["mass"], np.array(load["center"]), np.zeros((3, 3)))
        model.appendBodyToJoint(joint, point, pin.SE3.Identity())
    model.armature = np.broadcast_to(np.array(robot["armature"], dtype=float), JOINTS).copy()
    return model
