"""Units that stand in the headers of columns, and what makes SI units of them."""

from __future__ import annotations

import re
from math import pi
from typing import NamedTuple

_DEGREE = pi / 180.0
_TURN = 2.0 * pi

UNITS: dict[str, dict[str, float]] = {
    "angle": {
        "rad": 1.0,
        "radian": 1.0,
        "radians": 1.0,
        "mrad": 1e-3,
        "deg": _DEGREE,
        "degree": _DEGREE,
        "degrees": _DEGREE,
        "°": _DEGREE,
        "rev": _TURN,
        "turns": _TURN,
    },
    "place": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "angle rate": {
        "rad/s": 1.0,
        "mrad/s": 1e-3,
        "deg/s": _DEGREE,
        "°/s": _DEGREE,
        "rpm": _TURN / 60.0,
        "rev/s": _TURN,
    },
    "place rate": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3},
    "torque": {"n·m": 1.0, "mn·m": 1e-3, "kn·m": 1e3},
    "force": {"n": 1.0, "kn": 1e3},
    "current": {"a": 1.0, "ma": 1e-3},
    "time": {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
}
"""Factors to rad, m, s, N·m, N and A, by what is measured."""

_SPELT = {
    "nm": "n·m",
    "n*m": "n·m",
    "n.m": "n·m",
    "n m": "n·m",
    "n-m": "n·m",
    "mnm": "mn·m",
    "mn*m": "mn·m",
    "knm": "kn·m",
    "amp": "a",
    "amps": "a",
    "ampere": "a",
    "µs": "us",
    "μs": "us",
    "second": "s",
    "msec": "ms",
    "usec": "us",
    "nsec": "ns",
    "nanosec": "ns",
    "rads": "rad/s",
    "rad_s": "rad/s",
    "rad/sec": "rad/s",
    "degs": "deg/s",
    "deg_s": "deg/s",
    "deg/sec": "deg/s",
    "m_s": "m/s",
    "mm_s": "mm/s",
}
_BRACKETS = re.compile(
    r"^(?P<name>.*?\S)\s*[\[(]\s*(?P<unit>[^\[\]()]*?[^\[\]()\d\s][^\[\]()]*?)\s*[\])]$"
)
_SUFFIX = re.compile(
    r"^(?P<name>.*[^_/\s])[_/\s](?P<unit>(?:rad|deg|mm|m)[_/]s|rad/sec|rads|degs|rpm|mrad|rad|deg|degrees|°"
    r"|mnm|nm|ma|ms|us|ns|sec|s)$",
    re.IGNORECASE,
)


class Named(NamedTuple):
    """A header in two parts; ``unit`` is as it stands there, empty for none."""

    name: str
    unit: str


def split_unit(header: str) -> Named:
    """Part the unit from a header: ``q1 [rad]``, ``q1 (deg)``, ``q1_deg``, ``time_ms``.

    A bracket with a whole number in it, as of ``position[0]``, is an index and no unit.
    """
    text = header.strip()
    found = _BRACKETS.match(text) or _SUFFIX.match(text)
    return Named(found["name"], found["unit"]) if found else Named(text, "")


def factor_of(unit: str, measured: str) -> float | None:
    """Return what makes the SI unit of a unit; ``None`` where it measures something else.

    Args:
        unit: as it stands in a header, empty for the SI unit.
        measured: a key of ``UNITS``.
    """
    if not unit:
        return 1.0
    known = UNITS[measured]
    text = unit.strip().lower()
    return known.get(_SPELT.get(text, text))
