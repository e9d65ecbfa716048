"""M and h of an arm at one state, which Pinocchio refills in place."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.recursion import SCRATCH_COLUMNS

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


class ChainDynamics(NamedTuple):
    """An arm that a kernel evaluates by itself.

    Attributes:
        chain: what ``pack_chain`` returned. Shape (7, 24).
        inertia: M, once evaluated. Shape (6, 6).
        bias: h = C v + G, once evaluated. Shape (6,).
        scratch: memory of the recursion. Shape (6, 22).
    """

    chain: Array
    inertia: Array
    bias: Array
    scratch: Array


def chain_of(chain: Array) -> ChainDynamics:
    """Return the dynamics of a chain, zero until a kernel evaluates them."""
    count = len(chain) - 1
    return ChainDynamics(
        chain, np.zeros((count, count)), np.zeros(count), np.zeros((count, SCRATCH_COLUMNS))
    )
