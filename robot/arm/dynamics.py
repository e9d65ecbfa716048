"""M and h of an arm at one state, which Pinocchio refills in place."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pinocchio as pin

Array = np.ndarray


class Dynamics(NamedTuple):
    """An arm at a state.

    Attributes:
        model: the arm.
        data: what Pinocchio writes for it.
        refill: lets Pinocchio write M and h anew.
        inertia: M. Shape (6, 6).
        bias: h = C v + G. Shape (6,).
    """

    model: pin.Model
    data: pin.Data
    refill: Callable[[], None]
    inertia: Array
    bias: Array


def dynamics(model: pin.Model, q: Array, v: Array) -> Dynamics:
    """Return the dynamics of an arm at (q, v), zero until they are refilled.

    Args:
        model: the arm.
        q: joint angles in [rad], read at every refill. Shape (6,).
        v: joint velocities in [rad/s], read at every refill. Shape (6,).
    """
    data = model.createData()
    crba, bias = pin.crba, pin.nonLinearEffects

    def refill() -> None:
        crba(model, data, q)
        bias(model, data, q, v)

    return Dynamics(model, data, refill, data.M.T, data.nle)
