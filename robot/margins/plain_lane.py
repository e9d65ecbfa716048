"""Every law that switches, as one that harmonic balance knows: k1 S and k2 times a switching term.

What is equal to it is replaced by it; where it is near, the docstring says so.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.laws.adaptive_smc import AdaptiveSmc
from slidetune.robot.margins.layer import mobility_at
from slidetune.robot.margins.margin import replaced, with_lane
from slidetune.robot.margins.switching_term import SwitchingTerm

Array = np.ndarray

SWITCHINGS = ("tanh", "saturation", "sign", "implicit")


def switches(packed: Packed, name: str) -> bool:
    """Tell whether a lane has a switching term that a harmonic balance can be made of.

    Power reaching has none: its gain at S = 0 has no end, whatever its layer.
    """
    lane = packed.experiment.lanes[name]
    if lane.law == "super_twisting":
        return bool(np.any(lane.k1) or np.any(lane.k2))
    known = getattr(lane, "switching", "") in SWITCHINGS
    return known and getattr(lane, "reaching", "") != "power" and bool(np.any(lane.k2))


def as_plain(
    packed: Packed, name: str, time: float, gain: Array | None = None
) -> tuple[Packed, SwitchingTerm]:
    """Return an experiment in which a lane's term stands behind its k2, and that term.

    Args:
        packed: the experiment as numbers.
        name: the lane, one that ``switches``.
        time: when along the desired motion, in [s].
        gain: the present k2 of a law that adapts it, in [rad/s^2]. Shape (6,).
    """
    lane = packed.experiment.lanes[name]
    if lane.law == "super_twisting":
        return _twisting(packed, name)
    if gain is not None:
        packed = with_lane(packed, name, k2=gain.tolist(), k2_min=gain.tolist())
        lane = packed.experiment.lanes[name]
    if lane.switching == "implicit":
        return _implicit(packed, name, time)
    layer = np.broadcast_to(np.asarray(lane.epsilon, dtype=float), packed.joints)
    return packed, SwitchingTerm.within(lane.switching, layer)


def _twisting(packed: Packed, name: str) -> tuple[Packed, SwitchingTerm]:
    """Return a lane of unit gain behind M; k1 and k2 are in the term."""
    lane = packed.experiment.lanes[name]
    names = AdaptiveSmc.model_fields.keys() & type(lane).model_fields.keys()
    kept = {key: getattr(lane, key) for key in names - {"law", "k1", "k2"}}
    unit = AdaptiveSmc(**kept, k1=0.0, k2=1.0, k2_min=1.0, adaptation_rate=0.0)
    root, rate = (
        np.broadcast_to(np.asarray(gain, float), packed.joints) for gain in (lane.k1, lane.k2)
    )
    return replaced(packed, name, unit), SwitchingTerm(
        "twisting", np.ones(packed.joints), root, rate
    )


def _implicit(packed: Packed, name: str, time: float) -> tuple[Packed, SwitchingTerm]:
    r"""Return the saturation that the implicit sign of a sampled loop is.

    .. math:: \frac{k_1 S + k_2\,\mathrm{clip}(S / (T k_2), -1, 1)}{1 + T k_1}

    Exactly so behind the inertia. If not, its joints couple: it is what each has by itself, with
    T Gamma_j (M^-1)_jj in place of T. In continuous mode it is sign.
    """
    lane, period = packed.experiment.lanes[name], packed.experiment.simulation.hold
    k1, k2 = (
        np.broadcast_to(np.asarray(gain, float), packed.joints) for gain in (lane.k1, lane.k2)
    )
    if period == 0.0:
        return with_lane(packed, name, switching="sign"), SwitchingTerm.within(
            "sign", np.ones(packed.joints)
        )
    moved = np.full(packed.joints, period)
    if not getattr(lane, "inertia_shaped", False):
        moved = period * mobility_at(packed, name, time)
    layer = np.maximum(moved * k2, np.finfo(float).tiny)
    less = 1.0 / (1.0 + moved * (k1 if lane.reaching == "exponential" else 0.0))
    gains: dict[str, Any] = {"k1": (k1 * less).tolist(), "k2": (k2 * less).tolist()}
    if hasattr(lane, "k2_min"):
        gains["k2_min"] = gains["k2"]
    plain = with_lane(packed, name, switching="saturation", epsilon=layer.tolist(), **gains)
    return plain, SwitchingTerm.within("saturation", layer)
