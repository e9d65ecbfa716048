"""Kinematics, limits and inertials of the Zu 5: every number of the URDF but its primitives.

Lengths in [m], angles in [rad], masses in [kg]. Where each figure comes from is in README.md.
"""

from math import pi
from typing import NamedTuple

Triple = tuple[float, float, float]


class JointFigures(NamedTuple):
    """Placement of a joint in the frame of the link before it; its axis is its own +z.

    Attributes:
        xyz: Origin in [m].
        rpy: Roll, pitch and yaw in [rad].
        lower: Lowest position in [rad].
        upper: Highest position in [rad].
        effort: Torque limit in [N m].
    """

    xyz: Triple
    rpy: Triple
    lower: float
    upper: float
    effort: float


class LinkInertial(NamedTuple):
    """Mass, centre of mass and inertia about that centre, in the axes of the link frame.

    Attributes:
        mass: In [kg].
        com: In [m].
        inertia: ixx, ixy, ixz, iyy, iyz, izz in [kg m^2].
    """

    mass: float
    com: Triple
    inertia: tuple[float, float, float, float, float, float]


# vendor, and equal to the published magnitudes of the DH table: .12015 .430 .3685 .114 .1135 .107.
# Limits of position: vendor. Effort: ours, the torque classes of the UR5e, an arm of the same
# payload and weight; nothing is published for this one.
JOINTS = (
    JointFigures((0.0, 0.0, 0.12015), (0.0, 0.0, 0.0), -6.28, 6.28, 150.0),
    JointFigures((0.0, 0.0, 0.0), (pi / 2, 0.0, 0.0), -1.48, 4.62, 150.0),
    JointFigures((0.43, 0.0, 0.0), (0.0, 0.0, 0.0), -3.05, 3.05, 150.0),
    JointFigures((0.3685, 0.0, -0.114), (0.0, 0.0, 0.0), -1.48, 4.62, 28.0),
    JointFigures((0.0, -0.1135, 0.0), (pi / 2, 0.0, 0.0), -6.28, 6.28, 28.0),
    JointFigures((0.0, 0.107, 0.0), (-pi / 2, 0.0, 0.0), -6.28, 6.28, 28.0),
)

MAX_JOINT_SPEED = 3.14
"""Of every joint in [rad/s] (vendor; published as 180 deg/s)."""

# vendor, unscaled: every link as solid steel.
INERTIALS = (
    LinkInertial(
        4.0392,
        (0.00096371, 8.8222e-08, 0.019555),
        (0.0048763, -1.8056e-07, 2.5196e-05, 0.0068003, -1.7678e-09, 0.010618),
    ),
    LinkInertial(
        15.135,
        (-2.5186e-07, 0.0033226, -0.001509),
        (0.044302, 1.5349e-07, -6.1966e-07, 0.043091, 1.4326e-05, 0.030523),
    ),
    LinkInertial(
        45.847,
        (0.215, 6.4325e-09, -0.14315),
        (0.10377, -1.3562e-06, 2.544e-07, 1.5964, 2.1509e-08, 1.5689),
    ),
    LinkInertial(
        18.069,
        (0.19087, -1.1862e-05, -0.010587),
        (0.022066, -3.4554e-06, -0.022609, 0.41632, 1.1508e-08, 0.41071),
    ),
    LinkInertial(
        5.5525,
        (-2.1345e-06, -0.0058004, 0.0026717),
        (0.0092564, 1.1341e-07, -1.2578e-08, 0.0052251, -8.3499e-05, 0.0089683),
    ),
    LinkInertial(
        6.3339,
        (-2.0304e-06, -0.0028889, -0.0023424),
        (0.012993, -1.0764e-07, 5.8559e-09, 0.0058454, 4.5426e-05, 0.0127),
    ),
    LinkInertial(
        1.4169,
        (2.7652e-05, -1.3485e-05, -0.021245),
        (0.00071853, -6.9778e-07, -6.378e-07, 0.00072375, 8.3072e-07, 0.0011337),
    ),
)
