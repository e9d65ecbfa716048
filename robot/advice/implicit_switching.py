"""The implicit sign in place of a switching function that chatters: no layer has to be chosen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.laws import law_of
from slidetune.robot.margins.layer import layer_of
from slidetune.robot.margins.margin import is_stable, with_lane


@dataclass(frozen=True)
class ImplicitSwitching:
    """A change that makes a lane switch by the implicit sign.

    Attributes:
        message: what it would do.
        patch: the merge patch.
        title: what to call the patch.
    """

    message: str
    patch: dict[str, Any]
    title: str


def implicit_switching(packed: Packed, name: str) -> ImplicitSwitching | None:
    """Return that change where a sampled lane switches by sign, or its layer is too thin.

    It is offered where the lane's law knows the arm and its loop then is stable.

    Args:
        packed: the experiment as numbers.
        name: the lane.
    """
    lane = packed.experiment.lanes[name]
    if packed.experiment.simulation.mode != "sampled" or not law_of(lane).model_based:
        return None
    present = getattr(lane, "switching", "implicit")
    if present == "implicit" or lane.reaching == "power" or not np.any(lane.k2):
        return None
    other = with_lane(packed, name, switching="implicit")
    if not is_stable(other, name) or (present != "sign" and is_stable(packed, name)):
        return None
    switched = np.broadcast_to(np.asarray(lane.k2) > 0.0, packed.joints)
    layer = layer_of(other, name)[switched]
    low, high = f"{layer.min():.3g}", f"{layer.max():.3g}"
    width = low if low == high else f"{low} to {high}"
    symbol = "T·k₂" if getattr(lane, "inertia_shaped", False) else "T·ΓM⁻¹k₂"
    return ImplicitSwitching(
        message="implicit takes sign(S) at the end of the period, by the model: a layer of "
        f"{width} rad/s, within which S is gone after one period.",
        patch={"lanes": {name: {"switching": "implicit"}}},
        title=f"Set ε = {symbol} (implicit)",
    )
