"""The switching gain that an adaptive law had, from what its sliding variables did."""

from __future__ import annotations

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.loop.simulate import LaneRun

Array = np.ndarray


def adapted_gain(packed: Packed, name: str, run: LaneRun) -> Array | None:
    r"""Return k2 of an adaptive law along a run in [rad/s^2], ``None`` of one that keeps it.

    .. math:: \dot k_2 = \kappa |S| \operatorname{sign}(|S| - \epsilon), \qquad
        k_{min} \le k_2 \le k_{max}

    Exact in sampled mode; in continuous mode as near as its rows tell, to a twentieth of k_max.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        run: what it did.

    Returns:
        Shape (n, 6).
    """
    lane = packed.experiment.lanes[name]
    if lane.law != "adaptive_smc":
        return None
    rate, layer, least, most = (
        np.broadcast_to(np.asarray(value, dtype=float), packed.joints)
        for value in (lane.adaptation_rate, lane.epsilon, lane.k2_min, lane.k2)
    )
    size, period = np.abs(np.nan_to_num(run.S)), packed.experiment.simulation.row_period
    change = period * rate * np.where(size < layer, -size, size)
    if packed.experiment.simulation.mode == "continuous":
        change[:-1] = 0.5 * (change[:-1] + change[1:])  # the trapezoidal rule
    gain, found = np.minimum(least, most), np.empty(run.S.shape)
    for row, step in enumerate(change):
        found[row] = gain
        gain = np.minimum(np.maximum(gain + step, least), most)
    return found
