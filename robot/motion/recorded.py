"""A recorded motion: a spline through waypoints at evenly spaced times."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PlainValidator, ValidationInfo, WithJsonSchema

from slidetune.robot.fields.quantity import JOINTS, Number, Section, field

Array = np.ndarray

DEGREE = 5
"""Of the spline (*ours*): acceleration and jerk are continuous."""
FEWEST_WAYPOINTS = 4
"""So many determine the spline (*ours*): below it no knot is left between the ends."""
MOST_NUMBERS = 3000
"""Most angles of one recorded motion (*ours*): as text half of what a preset may have."""
FARTHEST = 1000.0
"""Greatest angle in [rad] or place in [m] of a waypoint (*ours*)."""
SMALLEST_SPACING, WIDEST_SPACING = 0.002, 10.0
LONGEST_ORIGIN = 200
DECIMALS = 7
"""Digits after the point that are written (*ours*): at 50 waypoints a second, 0.001 rad/s^2."""

_WAY_OUT = "slidetune reference PRESET FILE makes them of a recording"


def _parsed(text: str, joints: int) -> Array:
    rows = [line.split() for line in text.splitlines() if line.strip()]
    if not rows:
        raise ValueError(f"must be those of a recording: {_WAY_OUT}")
    if len(rows) < FEWEST_WAYPOINTS:
        raise ValueError(
            f"must have at least {FEWEST_WAYPOINTS} lines, one a waypoint, got {len(rows)}; "
            f"{_WAY_OUT}"
        )
    if len(rows) * joints > MOST_NUMBERS:
        raise ValueError(
            f"must have at most {MOST_NUMBERS // joints} lines for {joints} joints, got "
            f"{len(rows)}: space them farther apart"
        )
    for number, row in enumerate(rows, 1):
        if len(row) != joints:
            raise ValueError(
                f"must have one number a joint, {joints}, in every line: line {number} has "
                f"{len(row)}"
            )
    try:
        angles = np.array(rows, dtype=float)
    except ValueError:
        number, cell = next(
            (number, cell) for number, row in enumerate(rows, 1) for cell in row if not _real(cell)
        )
        text = f"must be numbers: line {number} holds {cell[:40]!r}"
        raise ValueError(text) from None
    if not (np.abs(angles) <= FARTHEST).all():
        number = int(np.argmax(~(np.abs(angles) <= FARTHEST).all(axis=1))) + 1
        text = f"must be finite and within ±{FARTHEST:g} rad: line {number} is not"
        raise ValueError(text)
    angles.flags.writeable = False
    return angles


def _real(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


@lru_cache(maxsize=16)
def waypoints_of(text: str, joints: int = JOINTS) -> Array:
    """Return the angles that a text of waypoints holds in [rad], or [m]. Shape (m, n).

    Raises:
        ValueError: saying which line is wrong, and how.
    """
    return _parsed(text, joints)


def waypoint_text(angles: Array) -> str:
    """Return waypoints as a text, one a line. Shape (m, n)."""
    rows = ("  ".join(f"{value:.{DECIMALS}f}" for value in row) for row in angles.tolist())
    return "\n".join(rows) + "\n"


def _text(value: object, info: ValidationInfo) -> str:
    if not isinstance(value, str):
        raise ValueError("must be a text, one waypoint a line")
    waypoints_of(value, int((info.context or {}).get("joints", JOINTS)))
    return "".join(f"{'  '.join(line.split())}\n" for line in value.splitlines() if line.strip())


Waypoints = Annotated[str, PlainValidator(_text), WithJsonSchema({"type": "string"})]


class RecordedTrajectory(Section):
    """A recorded motion, smoothed: a spline of degree five, then held at its last waypoint."""

    kind: Literal["recorded"] = "recorded"
    spacing: Number = field(
        0.1,
        title="Spacing",
        symbol="h_w",
        unit="s",
        low=SMALLEST_SPACING,
        high=WIDEST_SPACING,
        step=0.001,
        scale="log",
        meaning="Time between two waypoints; a longer one plays the motion more slowly.",
    )
    origin: str = Field(
        default="",
        max_length=LONGEST_ORIGIN,
        title="Origin",
        description="The file that it was made from.",
    )
    waypoints: Waypoints = Field(
        default="",
        title="Waypoints",
        description="Angles of all joints in rad (m where one slides), one waypoint a line; the "
        "motion comes to rest at the last one and is held there.",
    )


def spline_knots(count: int, spacing: float) -> Array:
    """Return the knots of the spline through ``count`` waypoints.

    At its start it is free: the first two inner waypoints are no knots ("not a knot"). Its end is
    held by two conditions, rest. Shape (count + 8,).
    """
    end = spacing * (count - 1)
    inner = spacing * np.arange(3, count - 1)
    return np.concatenate([np.zeros(DEGREE + 1), inner, np.full(DEGREE + 1, end)])


@lru_cache(maxsize=8)
def _samples(text: str, spacing: float, joints: int) -> Array:
    from scipy.interpolate import make_interp_spline  # here, because it takes long to import

    angles = waypoints_of(text, joints)
    count = len(angles)
    time = spacing * np.arange(count)
    at_rest = [(1, np.zeros(joints)), (2, np.zeros(joints))]
    knots = spline_knots(count, spacing)
    time[-1] = knots[-1]
    spline = make_interp_spline(time, angles, k=DEGREE, t=knots, bc_type=(None, at_rest))
    samples = np.stack([angles, spline.derivative(1)(time), spline.derivative(2)(time)], axis=1)
    samples[-1, 1:] = 0.0
    samples.flags.writeable = False
    return samples


def recorded_samples(trajectory: RecordedTrajectory, joints: int) -> Array:
    """Return q_d [rad], v_d [rad/s] and a_d [rad/s^2] of a recorded motion at its waypoints.

    Between two of them the spline is one polynomial of degree five, which these determine.

    Args:
        trajectory: spacing and waypoints.
        joints: how many joints the arm has.

    Returns:
        Shape (m, 3, n).
    """
    return _samples(trajectory.waypoints, trajectory.spacing, joints)
