"""What would make a sampled loop stable: a faster rate, a wider boundary layer."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.margins.instants import instants
from slidetune.robot.margins.margin import at_rate, is_stable, period_map, with_lane, worst_instant

_STEEPEST = 2.0**10
"""By how much a layer is divided at most in search of a narrower one (*ours*)."""


def _sufficient(
    packed: Packed, name: str, changed: Callable[[float], Packed], most: float
) -> float | None:
    """Return the least factor, found by a scan and a bisection, that makes the loop stable.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        changed: returns the experiment with something that many times as great.
        most: greatest factor.
    """
    time, _ = worst_instant(packed, name)

    def holds(factor: float) -> bool:
        return period_map(changed(factor), name, time).stable()

    low, high = 1.0, 1.0
    while not holds(high):
        if high >= most:
            return None
        low, high = high, min(1.25 * high, most)
    while high / low > 1.01:
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if holds(middle) else (middle, high)
    for slack in (1.0, 1.02, 1.1, 1.5):
        if slack * high <= most and is_stable(changed(slack * high), name):
            return slack * high
    return None


def sufficient_rate(packed: Packed, name: str) -> float | None:
    """Return a control rate in [Hz] at which a lane's loop is stable, or ``None``.

    A delay in seconds takes more periods at a higher rate, so that there may be none.

    Args:
        packed: the experiment as numbers.
        name: the lane.
    """
    rate = packed.experiment.simulation.control_rate
    _, most = bounds(Simulation, "control_rate")

    def faster(factor: float) -> Packed:
        return at_rate(packed, _whole(factor * rate, most))

    factor = _sufficient(packed, name, faster, most / rate)
    return None if factor is None else _whole(factor * rate, most)


def _whole(rate: float, most: float) -> float:
    """Return the next whole number of hertz, which is what a screen shows."""
    return float(min(np.ceil(rate), most))


def with_layer(packed: Packed, name: str, factor: float) -> Packed:
    """Return the experiment with a lane's boundary layer that many times as wide.

    Args:
        packed: the experiment as numbers.
        name: a lane that switches.
        factor: how many times.
    """
    lane = packed.experiment.lanes[name]
    width = tuple(np.broadcast_to(np.multiply(lane.epsilon, factor), packed.joints).tolist())
    return with_lane(packed, name, epsilon=width)


def sufficient_layer(packed: Packed, name: str) -> float | list[float] | None:
    """Return a boundary layer in [rad/s], hardly wider than it must be, that makes a loop stable.

    Every joint's is widened alike.

    Args:
        packed: the experiment as numbers.
        name: a lane that switches by tanh or saturation.

    Returns:
        One number or six, as the lane has it; ``None`` where no layer does.
    """
    present = packed.experiment.lanes[name].epsilon
    _, most = bounds(type(packed.experiment.lanes[name]), "epsilon")
    widest = most / float(np.max(present))
    factor = _sufficient(packed, name, lambda wide: with_layer(packed, name, wide), widest)
    if factor is None:
        return None
    widened = [min(_rounded_up(e * factor), most) for e in np.atleast_1d(present).tolist()]
    return widened if isinstance(present, tuple) else widened[0]


def halved_layer(packed: Packed, name: str) -> float | list[float] | None:
    """Return a stable lane's boundary layer, halved as often as the loop bears it, in [rad/s].

    A layer much wider than it must be is smooth as well, but gives accuracy away.

    Args:
        packed: the experiment as numbers.
        name: a lane that switches by tanh or saturation, stable as it is.

    Returns:
        One number or six, as the lane has it; ``None`` where not even half of it is enough.
    """
    present = packed.experiment.lanes[name].epsilon
    maps = [period_map(packed, name, time) for time in instants(packed).tolist()]
    steeper = 1.0
    while steeper < _STEEPEST and all(one.stable(switching=2.0 * steeper) for one in maps):
        steeper *= 2.0
    if steeper == 1.0:
        return None
    least, _ = bounds(type(packed.experiment.lanes[name]), "epsilon")
    thin = [max(_rounded_up(e / steeper), least) for e in np.atleast_1d(present).tolist()]
    return thin if isinstance(present, tuple) else thin[0]


def _rounded_up(value: float) -> float:
    """Return the next number of two digits that isn't smaller."""
    unit = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(f"{np.ceil(value / unit - 1e-9) * unit:.2g}")
