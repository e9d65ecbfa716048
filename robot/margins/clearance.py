"""How far the Nyquist curve of a loop without a limit cycle keeps from one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class Clearance(NamedTuple):
    """Where a curve comes nearest to -1/N(A) of a switching function.

    Attributes:
        angle: between the two there in [rad], seen from 0.
        omega: the frequency there in [rad/s].
    """

    angle: float
    omega: float


def clearance_of(omega: Array, curve: Array, layer: float) -> Clearance | None:
    r"""Return how near a curve comes to -1/N(A), ``None`` where it is nowhere long enough.

    -1/N(A) is the real axis left of :math:`-\epsilon`: what turns by 180 degrees less this angle
    and is longer than the layer is on its way there.

    Args:
        omega: frequencies in [rad/s]. Shape (n,).
        curve: G there in [rad/s], complex. Shape (n,).
        layer: epsilon in [rad/s], 0 for sign.
    """
    long = np.flatnonzero(np.abs(curve) > layer)
    if not len(long):
        return None
    angles = np.pi - np.abs(np.angle(curve[long]))
    nearest = int(np.argmin(angles))
    return Clearance(float(angles[nearest]), float(omega[long[nearest]]))
