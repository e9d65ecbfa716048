"""The two-link arm and what it is asked to do; NumPy alone, for this Python and OpenSMC's.

OpenSMC's own examples: its robot-arm benchmark, and the motion with which it validates its arm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray

STEP = 1e-4
"""Control period, and step of the integrator, in [s] (*published*: that example)."""
SECONDS = 5.0
"""Length of a run in [s] (*published*: that example)."""
_PUSHED = 2.0
"""When both joints are pushed in [s], and by how much in [N m] (*published*: that example)."""
_PUSH = np.array([0.5, 0.3])


@dataclass(frozen=True)
class Task:
    """A desired motion of both joints, from a start of its own.

    Attributes:
        title: for people.
        q0: angles at t = 0 in [rad]. Shape (2,).
        v0: velocities at t = 0 in [rad/s]. Shape (2,).
        desired: q_d, v_d and a_d at a time. Shape (3, 2).
    """

    title: str
    q0: Array
    v0: Array
    desired: Callable[[float], Array]


def push(t: float) -> Array:
    """Return what pushes the joints in [N m]. Shape (2,)."""
    return _PUSH if t > _PUSHED else np.zeros(2)


def _reach(_t: float) -> Array:
    return np.array([[np.pi / 4, np.pi / 4], [0.0, 0.0], [0.0, 0.0]])


def _follow(t: float) -> Array:
    sine, cosine = np.sin(t), np.cos(t)
    return np.array([[sine, cosine], [cosine, -sine], [-sine, -cosine]])


_OFF = np.array([0.05, -0.05])
"""Error at the beginning of the second task in [rad] (*ours*): on the motion S would be 0, and
rounding would choose its sign."""
_SLOPE = 20.0
"""-de/e there in [1/s] (*ours*): on the surface of the integral law, and off that of the others."""

TASKS = {
    "reach": Task("reach 45°", np.zeros(2), np.zeros(2), _reach),
    "follow": Task(
        "follow a sine", _follow(0.0)[0] - _OFF, _follow(0.0)[1] + _SLOPE * _OFF, _follow
    ),
}
