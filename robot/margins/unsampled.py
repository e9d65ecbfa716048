"""A loop in continuous time: whether it is the sampling, or a lag, that makes it unstable."""

from __future__ import annotations

from dataclasses import replace

from slidetune.robot.environment.layout import BITS, LAG, LAGS, TWO_LAGS
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.margins.instants import instants
from slidetune.robot.margins.margin import period_map, switches, with_lane
from slidetune.robot.margins.period_map import UNSAMPLED

_FEW = 3
"""So many instants are looked at where it has to be quick (*ours*)."""


def without_lag(packed: Packed) -> Packed:
    """Return the experiment with drives that have no lag."""
    environment = packed.environment.copy()
    environment[LAG] = 0.0
    environment[BITS, 0] = int(environment[BITS, 0]) & ~(LAGS | TWO_LAGS)
    return replace(packed, environment=environment)


def is_stable_unsampled(packed: Packed, name: str, time: float, lag: bool = True) -> bool:
    """Tell whether a loop would be stable at a rate past all layers and without a delay.

    Then it is the sampling that makes it diverge; else no control rate is to blame.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        time: when along the desired motion, in [s].
        lag: whether its drives keep their lag.
    """
    if not lag:
        packed = without_lag(packed)
    return period_map(as_if_unsampled(packed, name), name, time).stable()


def as_if_unsampled(packed: Packed, name: str) -> Packed:
    """Return an experiment as a sampled one whose period and delay no longer count.

    Args:
        packed: the experiment as numbers.
        name: the lane that counts; implicit is sign there.
    """
    patch = {"mode": "sampled", "control_rate": UNSAMPLED, "input_delay": 0.0}
    simulation = packed.experiment.simulation.model_copy(update=patch)
    experiment = packed.experiment.model_copy(update={"simulation": simulation})
    fast = replace(packed, experiment=experiment)
    return with_lane(fast, name, switching="sign") if switches(packed, name, "implicit") else fast


def fastest_growth(packed: Packed, name: str) -> complex:
    """Return the mode in [1/s] of a loop in continuous time that grows fastest, or dies out last.

    Args:
        packed: the experiment as numbers.
        name: the lane.
    """
    continuous = as_if_unsampled(packed, name)
    times = instants(packed)[:_FEW].tolist()
    modes = [period_map(continuous, name, time).mode() for time in times]
    return max(modes, key=lambda mode: mode.real)
