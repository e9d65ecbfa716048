"""Units of what belongs to joints, where some of them slide."""

from __future__ import annotations

import re
from collections.abc import Sequence

BETWEEN = " | "
"""Between the unit for joints that turn and the one for joints that slide."""
_SLIDING = (("N·m", "N"), ("kg·m²", "kg"), ("mrad", "mm"), ("rad", "m"))

_IN_TEXT = re.compile(r"(?<![\w·])(?:kg·m²|N·m(?:·s)?|m?rad)(?:/(?:rad|s²|s))?(?![\w·/²])")
"""Units of joints within a text."""
ANGLES = ("phase", "angular_frequency")
"""Fields of joints that are angles of a sine, and stay so where a joint slides."""


def sliding(unit: str) -> str:
    """Return the unit that a joint which slides has in the place of one: N·m·s/rad gives N·s/m."""
    for turns, slides in _SLIDING:
        unit = unit.replace(turns, slides)
    return unit


def unit_of_joints(unit: str, slides: Sequence[bool]) -> str:
    """Return the unit of numbers that belong to an arm's joints.

    Args:
        unit: the unit for joints that turn.
        slides: whether each joint slides.

    Returns:
        One unit where all joints have the same, else both: ``rad | m``.
    """
    other = sliding(unit)
    if other == unit or not any(slides):
        return unit
    return other if all(slides) else f"{unit}{BETWEEN}{other}"


def in_units_of(text: str, slides: Sequence[bool]) -> str:
    """Return a text about joints with their units: `5 N·m` is `5 N` where all of them slide."""
    if not any(slides):
        return text
    return _IN_TEXT.sub(lambda found: unit_of_joints(found[0], slides), text)
