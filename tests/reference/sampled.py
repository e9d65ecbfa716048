"""The reference's closed loop under a sampled controller: exact instants, whatever the steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from tests.reference.arm import JOINTS
from tests.reference.loop import COULOMB_WIDTH, Loop

Array = np.ndarray


def solve_sampled(document: dict[str, Any], rtol: float = 1e-9) -> Array:
    """Return the angles at every sample in [rad], NaN after a joint left its bounds. Shape (n, 6).

    The torque of a sample reaches the joints exactly ``input_delay`` after it; between two arrivals
    the arm and its drives are a smooth differential equation.

    Args:
        document: an experiment of one lane as plain values, complete; its law has no network.
        rtol: relative tolerance; the absolute one is a hundredth of it.
    """
    loop, simulation = Loop(document, thin=1e-6), document["simulation"]
    period, delay = 1.0 / simulation["control_rate"], simulation["input_delay"]
    samples = round(simulation["horizon"] / period)
    q = np.full((samples + 1, JOINTS), np.nan)
    arrivals: list[tuple[float, Array]] = []
    y, torque = loop.start, np.zeros(JOINTS)

    def rate(t: float, y: Array) -> Array:
        v, given, late = y[JOINTS : 2 * JOINTS], torque, []
        for delivered in loop.drives(y):
            late.append((given - delivered) / loop.lag)
            given = delivered
        lost = loop.disturbance(t, loop.within) + loop.viscous * v
        lost = lost + loop.coulomb * np.tanh(v / COULOMB_WIDTH)
        a = pin.aba(loop.model, loop.data, y[:JOINTS], v, given - lost)
        return np.concatenate([v, a, *late])

    for sample in range(samples + 1):
        t, end = sample * period, (sample + 1) * period
        q[sample] = y[:JOINTS]
        given = np.clip(loop.torque(t, y)["tau"], -loop.limit, loop.limit)
        arrivals.append((t + delay, given))
        edges = [edge for edge in loop.edges if t < edge < end]
        edges += [arrival for arrival, _ in arrivals if t < arrival < end]
        for until in (*sorted(edges), end):
            while arrivals and arrivals[0][0] <= t + 1e-12:
                torque = arrivals.pop(0)[1]
            if until <= t + 1e-12:
                continue
            loop.within = 0.5 * (t + until)
            found = solve_ivp(rate, (t, until), y, "DOP853", rtol=rtol, atol=0.01 * rtol)
            t, y = until, found.y[:, -1]
        if not np.abs(y[: 2 * JOINTS]).max() < 100.0:
            break
    return q
