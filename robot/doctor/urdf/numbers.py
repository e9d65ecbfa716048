"""Numbers in attributes, strictly as URDF has them."""

from __future__ import annotations

import re

from slidetune.robot.doctor.urdf.description import Vector
from slidetune.robot.doctor.urdf.finding import Findings
from slidetune.robot.doctor.urdf.xml_tree import Element
from slidetune.robot.fields.written_value import written

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_LARGEST = 1e30
"""Largest number (*ours*): products of three are far from overflowing."""
_SMALLEST = 1e-300
"""What is smaller is zero (*ours*): below it doubles lose digits."""


def numbers(
    element: Element,
    attribute: str,
    count: int,
    where: str,
    findings: Findings,
    unit: str = "",
    instead: str = "",
) -> tuple[float, ...] | None:
    """Return the numbers of an attribute.

    Args:
        element: has the attribute, or doesn't.
        attribute: its name.
        count: how many numbers there must be.
        where: the link or joint, for the finding.
        findings: takes a refusal of what are no numbers.
        unit: of each number.
        instead: another way out, where a number isn't the only one.

    Returns:
        ``count`` numbers, ``None`` where they are missing or refused.
    """
    given = element.attributes.get(attribute)
    if given is None:
        return None
    words = given.split()
    values = [float(word) for word in words if _NUMBER.fullmatch(word)]
    if len(words) == len(values) == count and all(abs(value) <= _LARGEST for value in values):
        return tuple(0.0 if abs(value) < _SMALLEST else value for value in values)
    allowed = "one number" if count == 1 else f"{count} numbers with blanks between"
    in_unit = f" in {unit}" if unit else ""
    findings.refuse(
        where,
        element.line,
        f"{attribute} of <{written(element.tag)}> must be {allowed}{in_unit}, none beyond "
        f"{_LARGEST:g}, got {written(given) or 'nothing'}",
        f"write {' '.join(['0.0'] * count)} or what it should be, with a point and no unit"
        f"{f'; {instead}' if instead else ''}",
    )
    return None


def number(
    element: Element,
    attribute: str,
    where: str,
    findings: Findings,
    unit: str = "",
    instead: str = "",
) -> float | None:
    """Return the one number of an attribute, as ``numbers`` does."""
    values = numbers(element, attribute, 1, where, findings, unit, instead)
    return values[0] if values else None


def vector(
    element: Element, attribute: str, where: str, findings: Findings, unit: str = ""
) -> Vector | None:
    """Return the three numbers of an attribute, as ``numbers`` does."""
    values = numbers(element, attribute, 3, where, findings, unit)
    return (values[0], values[1], values[2]) if values else None
