"""What a law and its observer remember, as further states of a control period's linear map."""

from __future__ import annotations

from typing import Any

import numpy as np

from slidetune.robot.kernels.workspace import AD, VD
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.observer import LAST_V, LOSS, SPAN, UNDRIVEN

Array = np.ndarray


def remembered_rows(law: Law, lane: Any) -> Array:
    """Return the rows, from that of the first weight on, that a law and its observer carry on."""
    own = np.array(law.states, int)
    if getattr(lane, "observer", "none") == "none":
        return own
    return np.concatenate([own, law.memory + np.array([LOSS, LAST_V, UNDRIVEN])])


def begin_observer(law: Law, period: float, inertia: Array, work: Array, memory: Array) -> None:
    """Let an observer have seen the desired motion, and nothing that the arm loses.

    Args:
        law: the lane's law.
        period: control period in [s].
        inertia: M of the nominal arm. Shape (6, 6).
        work: workspace with the desired motion.
        memory: rows of the state in the place of the weights; written. Shape (10, 6).
    """
    memory[law.memory + LAST_V] = work[VD] - period * work[AD]
    memory[law.memory + UNDRIVEN] = -inertia @ work[AD]
    memory[law.memory + SPAN] = period


def remembered_torque(lane: Any, size: int, joints: int) -> Array:
    """Return what of a commanded torque is kept in the state: an observer's last row is less it.

    Args:
        lane: a lane's gains.
        size: deviations of a state.
        joints: how many joints the arm has.

    Returns:
        Shape (size, 6).
    """
    kept = np.zeros((size, joints))
    if getattr(lane, "observer", "none") != "none":
        kept[size - joints :] = -np.eye(joints)
    return kept
