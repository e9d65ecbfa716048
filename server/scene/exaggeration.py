"""Deviations drawn larger than they are; nothing but the picture knows of it."""

from __future__ import annotations

import numpy as np

from slidetune.robot.arm.arm import flange_positions

Array = np.ndarray

WIDEST = np.pi
"""Deviation of a joint in [rad] that exaggeration doesn't exceed (*ours*): half a turn."""


def exaggerated_angles(q_d: Array, q: Array, factor: float) -> Array:
    """Return the joint angles that are drawn for the true ones.

    A deviation is stretched up to half a turn; one that is larger by itself is left as it is.

    Args:
        q_d: desired angles in [rad]. Shape (..., m).
        q: true angles in [rad]. Shape (..., m).
        factor: how many times the deviation is drawn, at least 1.

    Returns:
        Angles in [rad]. Shape (..., m).
    """
    deviation = q - q_d
    widest = np.maximum(WIDEST, np.abs(deviation))
    drawn: Array = q_d + np.clip(factor * deviation, -widest, widest)
    return drawn


def exaggerated_positions(
    desired: Array, actual: Array, q_d: Array, q: Array, factor: float, places: Array
) -> Array:
    """Return where the flange of the drawn arm was.

    The offset from the desired position follows from the angles, so that a trail ends where the
    drawn arm has its flange; stretching the offset itself would miss it by the curve of the joints.

    Args:
        desired: desired flange positions in [m]. Shape (n, 3).
        actual: true flange positions in [m]. Shape (n, 3).
        q_d: desired angles at the same instants in [rad]. Shape (n, m).
        q: true angles at the same instants in [rad]. Shape (n, m).
        factor: how many times the deviation is drawn, at least 1.
        places: the arm for ``flange_positions``.

    Returns:
        Positions in [m]. Shape (n, 3).
    """
    if factor == 1.0:
        return actual
    drawn = flange_positions(exaggerated_angles(q_d, q, factor), places)
    positions: Array = desired + drawn - flange_positions(q_d, places)
    return positions
