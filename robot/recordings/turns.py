"""Whole turns: what an angle of a turning joint doesn't tell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Array = np.ndarray

TURN = 2.0 * np.pi


def whole_turns(difference: Array, turning: Array) -> Array:
    r"""Return by how many turns angles are apart from others, those of sliding joints being 0.

    .. math:: \mathrm{round}\Big(\frac{1}{2\pi m} \sum_k (q_k - q_{d,k})\Big)

    Of all whole numbers they leave the least sum of squares.

    Args:
        difference: of the angles in [rad]. Shape (m, n).
        turning: which joints turn. Shape (n,).

    Returns:
        Whole numbers. Shape (n,).
    """
    return np.asarray(np.where(turning, np.round(difference.mean(axis=0) / TURN), 0.0))


def turns_said(turns: Array, joints: Sequence[str], what: str, other: str) -> list[str]:
    """Return in words which angles were brought to the turn of others, ``what`` to ``other``."""
    said = []
    for joint, count in zip(joints, turns.tolist(), strict=True):
        if count:
            many = "a turn" if abs(count) == 1.0 else f"{abs(count):g} turns"
            side = "above" if count > 0.0 else "below"
            said.append(f"{what} of {joint} is {many} {side} {other}: taken as of the same turn")
    return said
