"""Where a sampled run may go another way than the exact one: a sign in doubt, a swing apart."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

Array = np.ndarray

APART = 0.05
"""Difference of S between two runs, as part of S, from which on they swing differently (*ours*). Of
shipped presets those that settle have at most 0.003, those that swing 0.15 and more."""
_NOTHING = 1e-6
"""Difference of S in [rad/s] that is nothing (*ours*)."""
_DOUBT = 2.0
"""How many times its estimated error S may be off where a decision counts as sure (*ours*)."""


class Doubt(NamedTuple):
    """A decision that may be the other way round in the exact run.

    Attributes:
        row: the row.
        joint: which joint, from 1.
    """

    row: int
    joint: int


def turning_points(lane: Any) -> Array | None:
    """Return the |S| at which a sampled law decides, in [rad/s], ``None`` for one that does not.

    It is 0 where it takes the sign of S, and the layer where a gain grows outside it and falls
    within. Shape (n,) or (1,).

    Args:
        lane: a lane's law and gains.
    """
    if lane.law == "super_twisting" or getattr(lane, "switching", "") == "sign":
        return np.zeros(1)
    if lane.law == "adaptive_smc":
        return np.atleast_1d(np.asarray(lane.epsilon, dtype=float))
    return None


def first_doubt(points: Array, S: Array, other: Array, share: float) -> Doubt | None:
    """Return the first sample whose decision is within the error of S, ``None`` where all are sure.

    Two runs that are both coarse decide alike there, and both may be wrong: their difference then
    says nothing of how far they are off.

    Args:
        points: see ``turning_points``.
        S: sliding variables of a run in [rad/s], NaN after it left its bounds. Shape (m, n).
        other: those of the second run at the same instants. Shape (m, n).
        share: the error of the first as a multiple of their difference.
    """
    off = _DOUBT * share * np.abs(S - other)
    doubtful = (np.abs(np.abs(S) - points) <= off) & (off > 0.0)
    rows, joints = np.nonzero(doubtful)
    return Doubt(int(rows[0]), int(joints[0]) + 1) if len(rows) else None


def swings_apart(S: Array, other: Array) -> float:
    """Return by what part of itself S differs between two runs, once they have begun.

    A loop that swings by itself carries any small difference on until the two runs are out of step:
    it then says how far the swing goes, and no more how far off a run is.

    Args:
        S: sliding variables of a run in [rad/s], NaN after it left its bounds. Shape (m, n).
        other: those of the second run at the same instants. Shape (m, n).
    """
    late = slice(len(S) // 2, None)
    apart = np.nanmax(np.abs(S - other)[late], axis=0, initial=0.0)
    most = np.nanmax(np.abs(S)[late], axis=0, initial=0.0)
    return float((apart / np.maximum(most, 1e-300))[apart > _NOTHING].max(initial=0.0))
