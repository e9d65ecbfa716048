"""A switching gain that may grow to where its loop oscillates."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from slidetune.robot.advice.remark import Advice, span
from slidetune.robot.environment.layout import LAG
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.fields.field_path import field_path
from slidetune.robot.margins.margin import is_stable, with_lane
from slidetune.robot.margins.unsampled import as_if_unsampled

Array = np.ndarray

_TOLERANCE = 0.02
"""To what share of the way the border is looked for (*ours*)."""


def adapted_gain(packed: Packed, name: str) -> Iterator[Advice]:
    """Tell from which gain on an adaptive law's loop oscillates, where it may grow so far."""
    lane, simulation = packed.experiment.lanes[name], packed.experiment.simulation
    if not hasattr(lane, "adaptation_rate") or lane.switching == "sign" or lane.reaching == "power":
        return
    least, most = (
        np.broadcast_to(np.asarray(gain), packed.joints) for gain in (lane.k2_min, lane.k2)
    )
    sampled, lag = simulation.mode == "sampled", bool(np.any(packed.environment[LAG]))
    if not (sampled or lag) or not np.any(lane.adaptation_rate) or np.all(most <= least):
        return
    loop = packed if sampled else as_if_unsampled(packed, name)
    most = np.maximum(least, most)

    def holds(share: float) -> bool:
        gain = (least + share * (most - least)).tolist()
        return is_stable(with_lane(loop, name, k2=gain, k2_min=gain), name)

    if holds(1.0) or not holds(0.0):
        return  # Never, or from the beginning, which another remark tells.
    low, high = 0.0, 1.0
    while high - low > _TOLERANCE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    safe = [_rounded_down(gain) for gain in (least + low * (most - least)).tolist()]
    bound = safe if isinstance(lane.k2, tuple) else min(safe)
    change = {"lanes": {name: {"k2": bound}}} if np.all(np.asarray(safe) >= least) else None
    yield Advice(
        "info",
        field_path(("lanes", name, "k2")),
        f"k₂ may grow to k_max = {span(lane.k2)} rad/s², but from about {span(bound)} rad/s² on "
        "this loop oscillates within its layer, and that makes k₂ grow on. A lower k_max, a wider "
        "ε or less delay prevents it.",
        change,
    )


def _rounded_down(value: float) -> float:
    """Return the next number of two digits that isn't greater."""
    if value <= 0.0:
        return 0.0
    unit = 10.0 ** (np.floor(np.log10(value)) - 1.0)
    return float(f"{np.floor(value / unit + 1e-9) * unit:.2g}")
