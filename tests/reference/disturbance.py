"""The disturbance torque of the reference as a function of time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Array = np.ndarray
TONES = 16


Torque = Callable[[float, float], Array]


def disturbance(section: dict[str, Any], horizon: float, joints: int) -> tuple[Torque, list[float]]:
    """Return the torque that the section ``disturbance`` takes, and the times at which it jumps.

    The torque is asked for at a time and for a piece between two jumps, named by a time within it.
    """

    def wide(value: Any) -> Array:
        return np.broadcast_to(np.array(value, dtype=float), joints).copy()

    constant, sine, pulse = wide(section["constant"]), section["sine"], section["pulse"]
    swing, height = wide(sine["amplitude"]), wide(pulse["amplitude"])
    omega, phase = 2.0 * np.pi * sine["frequency"], sine["phase"]
    start, duration, period = pulse["start"], pulse["duration"], pulse["period"]
    noise = wide(section["noise"]["amplitude"])
    random = np.random.default_rng(section["seed"])
    places = (np.arange(TONES)[:, None] + random.random((TONES, joints))) / TONES
    tones = 2.0 * np.pi * section["noise"]["bandwidth"] * places
    phases = 2.0 * np.pi * random.random((TONES, joints))

    def at(t: float, within: float) -> Array:
        since = within - start
        if period > 0.0 and since > 0.0:
            since = since % period
        total = constant + swing * np.sin(omega * t + phase)
        if 0.0 <= since < duration:
            total = total + height
        if noise.any():
            total = total + noise * np.sqrt(2.0 / TONES) * np.cos(tones * t + phases).sum(axis=0)
        return total

    edges: list[float] = []
    if height.any():
        count = int(horizon / period) + 2 if period > 0.0 else 1
        for number in range(min(count, 10_000)):
            begin = start + number * period
            edges += [begin, begin + duration]
    return at, edges
