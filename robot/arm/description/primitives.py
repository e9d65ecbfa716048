"""Collision geometry of the Zu 5: cylinders, boxes and spheres in the link frames, in [m].

*Ours*, fitted to the measured outline of the arm: flat-ended cylinders, because a capsule of the
same radius leaves 15 mm of a barrel's corners outside. The four spheres of the elbow reach into
the upper arm; the two links are neighbours, which no collision check pairs.
"""

from typing import NamedTuple

from slidetune.robot.arm.description.figures import Triple


class Cylinder(NamedTuple):
    """Flat-ended cylinder; ``axis`` names the link axis that it lies along."""

    name: str
    centre: Triple
    axis: str
    radius: float
    length: float


class Box(NamedTuple):
    """Box aligned with the link frame; ``size`` is edge to edge."""

    name: str
    centre: Triple
    size: Triple


class Sphere(NamedTuple):
    """Sphere."""

    name: str
    centre: Triple
    radius: float


Primitive = Cylinder | Box | Sphere


def _upper_arm_barrel(name: str, x: float) -> tuple[Cylinder, ...]:
    return (
        Cylinder(f"{name}_skirt", (x, 0.0, -0.082075), "z", 0.0592, 0.03615),
        Cylinder(f"{name}_body", (x, 0.0, -0.148), "z", 0.0618, 0.0957),
        Cylinder(f"{name}_cap", (x, 0.0, -0.20525), "z", 0.0604, 0.0188),
        Cylinder(f"{name}_cap_rim", (x, 0.0, -0.2178), "z", 0.056, 0.0063),
    )


PRIMITIVES: tuple[tuple[Primitive, ...], ...] = (
    (
        Cylinder("foot", (0.0, 0.0, 0.005), "z", 0.0782, 0.01),
        Cylinder("neck", (0.0, 0.0, 0.02), "z", 0.059, 0.04),
        Box("flare_low", (0.0, 0.0, 0.014), (0.058, 0.146, 0.008)),
        Box("flare_high", (0.0, 0.0, 0.0225), (0.058, 0.131, 0.009)),
        Box("connectors", (0.0, 0.0, 0.0192), (0.164, 0.0436, 0.0332)),
    ),
    (
        Cylinder("skirt", (0.0, 0.0, -0.062075), "z", 0.0592, 0.03615),
        Cylinder("body", (0.0, 0.0, 0.00385), "z", 0.0618, 0.0957),
        Cylinder("cap", (0.0, 0.0, 0.0611), "z", 0.0604, 0.0188),
        Cylinder("cap_rim", (0.0, 0.0, 0.07365), "z", 0.056, 0.0063),
        Cylinder("stub", (0.0, 0.032, 0.0), "y", 0.059, 0.064),
    ),
    (
        *_upper_arm_barrel("shoulder", 0.0),
        *_upper_arm_barrel("elbow", 0.43),
        Cylinder("collar_a", (0.041, 0.0, -0.14415), "x", 0.059, 0.082),
        Cylinder("neck_a", (0.08675, 0.0, -0.14415), "x", 0.052, 0.0095),
        Cylinder("tube", (0.215, 0.0, -0.14415), "x", 0.0425, 0.266),
        Cylinder("neck_b", (0.34325, 0.0, -0.14415), "x", 0.052, 0.0095),
        Cylinder("collar_b", (0.389, 0.0, -0.14415), "x", 0.059, 0.082),
    ),
    (
        Cylinder("elbow_base", (0.0, 0.0, -0.059), "z", 0.059, 0.01),
        Sphere("elbow_1", (0.002, 0.0, -0.055), 0.0575),
        Sphere("elbow_2", (0.0125, 0.0, -0.0315), 0.0515),
        Sphere("elbow_3", (0.029, 0.0, -0.015), 0.0437),
        Sphere("elbow_4", (0.0515, 0.0, -0.0045), 0.0366),
        Cylinder("tube", (0.185, 0.0, -0.0005), "x", 0.032, 0.25),
        Cylinder("neck", (0.30525, 0.0, -0.0005), "x", 0.0365, 0.0075),
        Cylinder("collar", (0.33875, 0.0, -0.0005), "x", 0.0405, 0.0595),
        Cylinder("wrist_skirt", (0.3685, 0.0, -0.0535), "z", 0.0406, 0.03),
        Cylinder("wrist_body", (0.3685, 0.0, -0.00065), "z", 0.0418, 0.0757),
        Cylinder("wrist_cap", (0.3685, 0.0, 0.0441), "z", 0.0407, 0.0138),
        Cylinder("wrist_cap_rim", (0.3685, 0.0, 0.0535), "z", 0.0375, 0.005),
    ),
    (
        Cylinder("skirt", (0.0, -0.053, 0.0), "y", 0.0406, 0.03),
        Cylinder("body", (0.0, -0.00015, 0.0), "y", 0.0418, 0.0757),
        Cylinder("cap", (0.0, 0.0446, 0.0), "y", 0.0407, 0.0138),
        Cylinder("cap_rim", (0.0, 0.054, 0.0), "y", 0.0375, 0.005),
        Cylinder("stub", (0.0, 0.0, 0.02275), "z", 0.0405, 0.0455),
    ),
    (
        Cylinder("skirt", (0.0, 0.054, 0.0), "y", 0.0406, 0.028),
        Cylinder("body", (0.0, -0.001, 0.0), "y", 0.0419, 0.082),
        Cylinder("neck", (0.0, -0.055, 0.0), "y", 0.0406, 0.026),
        Cylinder("cap", (0.0, -0.0713, 0.0), "y", 0.0382, 0.0066),
        Cylinder("stub", (0.0, 0.0, -0.02275), "z", 0.0405, 0.0455),
    ),
    (
        Cylinder("body", (0.0, 0.0, -0.023), "z", 0.0405, 0.032),
        Cylinder("spigot", (0.0, 0.0, -0.0035), "z", 0.0315, 0.007),
    ),
)
"""Per link, from the base to the flange."""
