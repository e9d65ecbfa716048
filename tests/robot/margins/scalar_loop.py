"""One switched integrator behind a delay and a drive with lags, written without our code.

    dS/dt = -kappa b + d sin(pi t),  tau db/dt = a - b,  tau da/dt = u - a,  u = sw(S/epsilon)

with one lag (b = a) or two, u held over a period T and late by a delay.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

Array = np.ndarray


class Scalar(NamedTuple):
    """A scalar loop."""

    kappa: float
    period: float
    lag: float = 0.0
    lags: int = 1
    delay: float = 0.0
    disturbance: float = 0.1


def run(loop: Scalar, switch: Callable[[Array], Array], length: float, start: Array) -> Array:
    """Return S at the samples, of several loops side by side.

    Args:
        loop: the loop.
        switch: sw of an array of S.
        length: how long to run in [s].
        start: S at the beginning in [rad/s]. Shape (m,).

    Returns:
        Shape (n, m).
    """
    parts = 8
    step = loop.period / parts
    size = 1 + (loop.lags if loop.lag else 0)
    # State: S, then what the drive gives, the last lag first; input: u.
    rates = np.zeros((size + 1, size + 1))
    rates[0, 1] = -loop.kappa
    for lag in range(1, size):
        rates[lag, lag], rates[lag, lag + 1] = -1.0 / loop.lag, 1.0 / loop.lag
    moved = expm(rates * step)
    own, torque = moved[:size, :size], moved[:size, size:]
    state = np.zeros((size, len(start)))
    state[0] = start
    line = [np.zeros(len(start))] * round(loop.delay / step)
    found = np.empty((int(length / loop.period), len(start)))
    for k in range(len(found)):
        found[k] = state[0]
        line.extend([switch(state[0])] * parts)
        for part in range(parts):
            state = own @ state + torque * line[part]
            time = (k * parts + part + 0.5) * step
            state[0] += step * loop.disturbance * loop.kappa * np.sin(np.pi * time)
        del line[:parts]
    return found


def swing(S: Array, period: float) -> tuple[float, float]:
    """Return frequency in [Hz] and amplitude of S from where it crosses its slow part."""
    last = S[len(S) // 2 :]
    count = max(2, round(0.1 / period))
    slow = np.convolve(last, np.full(count, 1.0 / count), "same")
    fast = (last - slow)[count:-count]
    rises = np.flatnonzero((fast[:-1] < 0.0) & (fast[1:] >= 0.0))
    frequency = (len(rises) - 1) / ((rises[-1] - rises[0]) * period)
    heights = [np.ptp(fast[a : b + 1]) for a, b in pairwise(rises)]
    return float(frequency), 0.5 * float(np.median(heights))
