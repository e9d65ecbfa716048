"""Geometry and inertia of the JAKA Zu 5, as files and as names.

``jaka_zu5.urdf`` and ``meshes/*.glb`` are data: ``figures`` and ``primitives`` hold the numbers
of the URDF, ``profiles`` those of the meshes; ``urdf`` and ``shapes`` write the files from them.
Importing this package reads nothing.
"""

from collections.abc import Mapping
from math import radians
from pathlib import Path
from types import MappingProxyType

URDF_PATH = Path(__file__).with_name("jaka_zu5.urdf")
"""The robot description; its mesh names are relative to its own folder."""

MESH_DIR = Path(__file__).with_name("meshes")
"""One GLB a link, in the link's frame and in [m]: ``MESH_DIR / f"{link}.glb"``."""

LINK_NAMES = (
    "base_link",
    "shoulder_link",
    "upper_arm_link",
    "forearm_link",
    "wrist_1_link",
    "wrist_2_link",
    "flange_link",
)
"""From the floor to the tool; link ``i`` moves with joint ``i``, the base with none."""

JOINT_NAMES = ("joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6")

VENDOR_MASS = 96.3935
"""Sum of the link masses of the URDF in [kg], base included (*vendor*: solid steel)."""

DATASHEET_MASS = 23.0
"""Mass of the real arm in [kg], base included (*published*)."""

Pose = tuple[float, float, float, float, float, float]


def _degrees(*angles: float) -> Pose:
    q1, q2, q3, q4, q5, q6 = (radians(angle) for angle in angles)
    return (q1, q2, q3, q4, q5, q6)


POSES: Mapping[str, Pose] = MappingProxyType(
    {
        "zero": _degrees(0, 0, 0, 0, 0, 0),  # ours: outstretched along +x
        "experiment_start": _degrees(0, 90, 90, 180, 90, 0),  # published: Liu et al. 2025
        "experiment_end": _degrees(90, 45, 30, 60, 36, 30),  # published: Liu et al. 2025
        "tool_down_front": _degrees(0, 90, -90, 90, 90, 0),  # ours: flange at x > 0, z down
        "tool_down_back": _degrees(0, 90, 90, 90, -90, 0),  # ours: flange at x < 0, z down
        "packed": _degrees(0, 0, 152, 120, 0, 0),  # vendor's transport pose, joint 1 at zero
    }
)
"""Named joint positions in [rad], joint 1 first; all inside the limits and free of collision."""
