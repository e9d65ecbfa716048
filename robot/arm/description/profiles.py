"""Outlines of the Zu 5 that its meshes are turned from, in whole millimetres.

*Ours*: measured figures, rounded, with stations chosen where the outline passes a whole
millimetre and 1 mm chamfers where two links meet. The flange follows ISO 9409-1-50-4-M6
(*published*). A profile is a list of (height along the axis, radius); a barrel's height counts
from the axis of the stub or tube that leaves it, towards its cap.
"""

from typing import NamedTuple

from slidetune.robot.arm.description.rings import Profile


class Barrel(NamedTuple):
    """A joint housing whose cap begins at height ``start + slope * distance along the stub``."""

    profile: Profile
    seam: tuple[float, float]


BIG = Barrel(
    [
        (-80, 0), (-80, 58), (-79, 59), (-54, 59), (-41, 60), (-27, 61), (-11, 62), (9, 63),
        (33, 62), (68, 60), (71, 59), (73, 58), (75, 56), (77, 53), (78, 50), (78, 49), (77, 46),
        (75, 42), (75, 0),
    ],
    (52, 0.153),
)  # fmt: skip
SMALL = Barrel(
    [
        (-68, 0), (-68, 40), (-67, 41), (-44, 41), (-23, 42), (18, 42), (51, 40), (53, 39),
        (55, 37), (57, 33), (57, 31), (56, 28), (54, 24), (54, 0),
    ],
    (38, 0.186),
)  # fmt: skip
WRIST = Barrel(
    [
        (-68, 0), (-68, 40), (-67, 41), (-44, 41), (-19, 42), (22, 42), (45, 41), (67, 41),
        (69, 41), (70, 40), (73, 37), (75, 33), (75, 29), (74, 28), (74, 0),
    ],
    (68, 0.0),
)  # fmt: skip
"""The last wrist housing: its cap is parted straight across."""

UPPER_TUBE: Profile = [
    (0, 0), (0, 59), (78, 59), (80, 58), (83, 57), (88, 53), (96, 45), (99, 43), (103, 42),
    (327, 42), (331, 43), (334, 45), (342, 53), (347, 57), (350, 58), (352, 59), (430, 59),
    (430, 0),
]  # fmt: skip
FOREARM_TUBE: Profile = [
    (112, 32), (295, 32), (298, 33), (308, 39), (310, 40), (313, 41), (368, 41), (368, 0),
]  # fmt: skip
BIG_STUB: Profile = [(0, 0), (0, 59), (63, 59), (64, 58), (64, 0)]
SMALL_STUB: Profile = [(0, 0), (0, 41), (45, 41), (46, 40), (46, 0)]

FLANGE: Profile = [
    (-39, 0), (-39, 40), (-38, 41), (-9, 41), (-7, 39), (-7, 31.5), (-0.5, 31.5), (0, 31),
    (0, 16.5), (-0.75, 15.75), (-6.5, 15.75), (-6.5, 0),
]  # fmt: skip
FOOT: Profile = [(0, 0), (0, 79), (5, 78), (10, 77), (10, 0)]
FLARE: Profile = [(9, 77), (12, 76), (16, 73), (24, 65), (30, 61), (35, 60), (39, 59)]
NECK: Profile = [(9, 0), (9, 59), (39, 59), (40, 58), (40, 0)]


class Section(NamedTuple):
    """Superellipse across the bend of the forearm, symmetric about the plane y = 0.

    Attributes:
        inner: Its point (x, z) on the inside of the bend.
        outer: Its point (x, z) on the outside.
        waist: Distance from ``inner``, towards ``outer``, of its widest place.
        half_width: Along y.
        exponent: 2 is an ellipse, less is more pointed.
    """

    inner: tuple[float, float]
    outer: tuple[float, float]
    waist: float
    half_width: float
    exponent: float


ELBOW = [
    Section((59, -63), (-59, -63), 59, 59, 2.0),
    Section((59, -62), (-55, -42), 57, 59, 1.9),
    Section((59, -60), (-42, -17), 55, 57, 1.8),
    Section((59, -51), (-23, 6), 48, 54, 1.8),
    Section((60, -40), (-1, 21), 36, 48, 1.8),
    Section((67, -33), (24, 29), 31, 41, 1.8),
    Section((78, -32), (48, 32), 34, 36, 1.9),
    Section((85, -32), (65, 32), 33, 33, 2.0),
    Section((93, -32), (83, 32), 32, 32, 2.0),
    Section((102, -32), (100, 32), 32, 32, 2.0),
    Section((112, -32), (112, 32), 32, 32, 2.0),
]
"""From the upper arm to the tube of the forearm; a cubic through their points joins them."""
