"""How wide a boundary layer has to be for a loop not to chatter.

Within the layer the loop is linear: it is silent exactly where one control period's linear map lets
small deviations die out. Harmonic balance is within 15 % of that, so the map decides.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.margins.margin import period_map
from slidetune.robot.margins.period_map import PeriodMap
from slidetune.robot.margins.switching_loop import with_layer
from slidetune.robot.margins.unsampled import as_if_unsampled

Array = np.ndarray

_SHARES = np.geomspace(1e4, 1e-3, 29)
"""By how much a layer is divided in search of its threshold (*ours*): one of 1 rad/s down to the
narrowest that a lane may have, which stands for all that are narrower."""
_TOLERANCE = 1e-3
_WIDER = 2.0, 8.0, 32.0, 128.0
"""By how much the layers of the other joints are widened, so that none of them decides (*ours*):
by the first with which a layer is found. Balance knows how wide they have to be where the drives
are alike, but not behind a neighbour whose drive is much slower."""


def _map_within(packed: Packed, name: str, layer: Array, time: float) -> PeriodMap:
    if packed.experiment.simulation.mode == "continuous":
        packed = as_if_unsampled(packed, name)
    return period_map(with_layer(packed, name, layer), name, time)


def _greatest_share(found: PeriodMap) -> float | None:
    """Return by how much the slope of the layer may grow, ``None`` where none is stable."""
    stable = next((k for k, s in enumerate(_SHARES) if found.stable(switching=float(s))), None)
    if stable is None:
        return None
    if stable == 0:
        return float(_SHARES[0])
    low, high = float(_SHARES[stable]), float(_SHARES[stable - 1])
    while high > low * (1.0 + _TOLERANCE):
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if found.stable(switching=middle) else (low, middle)
    return low


def silent_layer(
    packed: Packed, name: str, layer: Array, time: float, joints: tuple[int, ...] | None = None
) -> Array | None:
    """Return the narrowest layers in proportion to given ones within which a loop is silent.

    Args:
        packed: the experiment as numbers.
        name: the lane, one that switches.
        layer: widths whose proportion counts in [rad/s]. Shape (6,).
        time: when along the desired motion, in [s].
        joints: the joints whose layers are looked for, from 0; those of the others are wide
            enough. By default all.

    Returns:
        Layers in [rad/s], shape (6,); ``None`` where the loop oscillates whatever they are.
    """
    found = _map_within(packed, name, np.maximum(layer, 1e-9), time)
    if joints is not None:
        # A joint's S depends on its own angle and velocity.
        chosen = np.zeros(found.switching.shape[1])
        chosen[[*joints, *(packed.joints + joint for joint in joints)]] = 1.0
        others, own = found.switching * (1.0 - chosen), found.switching * chosen
        # Not without a layer: its slope may be all that holds the others.
        wider = (replace(found, rest=found.rest + others / by, switching=own) for by in _WIDER)
        shares = (_greatest_share(one) for one in wider)
        share = next((one for one in shares if one is not None), None)
    else:
        share = _greatest_share(found)
    return None if share is None else np.asarray(layer / share)
