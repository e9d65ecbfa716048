"""Whether a loop bears its sampling, its delay and the lag of its drives, and what would help."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from slidetune.robot.advice.implicit_switching import implicit_switching
from slidetune.robot.advice.remark import Advice, short, span
from slidetune.robot.advice.sampled_arm import sampled_arm
from slidetune.robot.advice.sufficient import halved_layer, sufficient_layer, sufficient_rate
from slidetune.robot.environment.layout import LAG
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.experiment.simulation import MAX_STEPS
from slidetune.robot.fields.field_path import field_path
from slidetune.robot.margins.margin import Margin, is_stable, loop_margin, with_lane
from slidetune.robot.margins.period_map import INSTANT
from slidetune.robot.margins.unsampled import as_if_unsampled


def sampling(packed: Packed, name: str) -> Iterator[Advice]:
    """Tell of a loop that is not stable."""
    simulation, lane = packed.experiment.simulation, packed.experiment.lanes[name]
    sampled, lag = simulation.mode == "sampled", bool(np.any(packed.environment[LAG]))
    if not sampled and not lag:
        return
    if not sampled:
        packed = as_if_unsampled(packed, name)
    margin = loop_margin(packed, name)
    if margin.holds:
        return
    late = [" delay"] if sampled and simulation.input_delay else []
    late += [" lag of the drives"] if lag else []
    rule = f"{_rule(margin, sampled, ' and this'.join(late))}: expect {_outcome(packed, margin)}. "
    where = "simulation.control_rate" if sampled else "robot.lag"
    if margin.radius is None:
        yield Advice("warning", where, f"{rule}Lower the other gains.")
        return
    rate = sufficient_rate(packed, name) if sampled else None
    implicit = sampled and getattr(lane, "switching", "") == "implicit"
    smooth = with_lane(packed, name, switching="tanh") if implicit else packed
    layer = sufficient_layer(smooth, name) if hasattr(lane, "epsilon") else None
    if layer is not None:
        wide = f"{span(layer)} rad/s"
        instead = f", or a control rate of {rate:g} Hz" if rate is not None else ""
        steep = lane.reaching != "power" and np.all(np.divide(lane.k2, lane.epsilon) > lane.k1)
        whose = "k₂/ε dominates. Stable" if steep and not implicit else "Stable"
        text = f"{rule}{whose} with {'tanh and ' if implicit else ''}ε = {wide}{instead}."
        path = field_path(("lanes", name, "switching" if implicit else "epsilon"))
        change = {"switching": "tanh", "epsilon": layer} if implicit else {"epsilon": layer}
        yield Advice("warning", path, text, {"lanes": {name: change}})
        return
    ways = [] if rate is None else [f"a control rate of {rate:g} Hz"]
    if not implicit:
        ways += _other_gains(margin, bool(np.any(getattr(lane, "learning_rate", 0.0))))
    ways += [f"a shorter{one}" for one in late]
    fits = rate is not None and simulation.horizon * rate <= MAX_STEPS
    yield Advice(
        "warning",
        where,
        f"{rule}Stable with {' or '.join(ways) or 'another switching function'}.",
        {"simulation": {"control_rate": rate}} if fits else None,
    )


def sampled_arm_instead(packed: Packed, name: str) -> Iterator[Advice]:
    """Offer an arm on which the lane can be sampled."""
    offer = sampled_arm(packed)
    if offer is not None and name in offer.lanes:
        yield Advice(
            "warning", "simulation.mode", offer.message, offer.patch, "Use the sampled arm"
        )


def _other_gains(margin: Margin, learns: bool) -> list[str]:
    """Say in words which other gains would make a loop stable."""
    if margin.gamma and margin.limit:
        factor = margin.limit / margin.gamma
        if factor > 1.0:
            return [f"reaching gains {short(1.01 * factor)} times higher"]
        return [f"reaching gains {short(1.01 / factor)} times lower"]
    return ["lower surface gains"] + (["a lower learning rate"] if learns else [])


def _outcome(packed: Packed, margin: Margin) -> str:
    """Say in words what an unstable loop comes to; the period map knows no torque limits."""
    if margin.bounded:
        return "a limit cycle"
    if packed.experiment.robot.torque_limit is None:
        return "divergence"
    return "a limit cycle within the torque limits, or divergence"


def _rule(margin: Margin, sampled: bool, late: str) -> str:
    """Say in words why a loop is not stable, with that delay and lag."""
    delay = f" with this{late}" if late else ""
    if margin.radius is None:
        rate = " at this rate" if sampled else ""
        return f"Even without sign(S), this loop is unstable{rate}{delay}"
    if not sampled:
        growth = np.log(margin.radius) / INSTANT
        return f"With this{late}, deviations grow by up to a factor e^(t·{short(growth)}/s)"
    rule = f"Deviations grow by up to a factor ρ = {margin.radius:.5g} per sample"
    if margin.gamma is None or margin.limit is None:
        return rule
    gamma = short(margin.gamma)
    if margin.limit == 0.0:
        return f"{rule}, whatever the reaching gains (γ = {gamma})"
    if margin.limit > margin.gamma:
        return f"{rule}: the reaching gains are too low (γ = {gamma}{delay})"
    return f"{rule} (γ = {gamma}, the limit of this loop{delay} is {short(margin.limit)})"


def sign(packed: Packed, name: str) -> Iterator[Advice]:
    """Tell of a sign that chatters."""
    simulation, lane = packed.experiment.simulation, packed.experiment.lanes[name]
    if simulation.mode != "sampled":
        return  # there sign holds S at zero
    if getattr(lane, "switching", "") != "sign" or lane.reaching == "power" or not np.any(lane.k2):
        return
    smooth = packed.experiment.patched({"lanes": {name: {"switching": "tanh"}}})
    change: dict[str, Any] = {"switching": "tanh"}
    other = pack(smooth)
    stable = is_stable(other, name)
    layer = halved_layer(other, name) if stable else sufficient_layer(other, name)
    if layer is None and not stable:
        return
    if layer is not None:
        change["epsilon"] = layer
    width = span(change.get("epsilon", lane.epsilon))
    jump = f"the torque jump by 2k₂ = {short(2.0 * np.max(lane.k2))} N·m"
    if getattr(lane, "inertia_shaped", False):
        jump = f"the acceleration asked for jump by 2k₂ = {short(2.0 * np.max(lane.k2))} rad/s²"
    yield Advice(
        "info",
        field_path(("lanes", name, "switching")),
        f"sign(S) makes {jump} up to "
        f"{simulation.control_rate:g} times per second: it chatters. tanh with ε = {width} rad/s "
        "is smooth at this rate.",
        {"lanes": {name: change}},
    )


def implicit(packed: Packed, name: str) -> Iterator[Advice]:
    """Offer the implicit sign."""
    offer = implicit_switching(packed, name)
    if offer is not None:
        path = field_path(("lanes", name, "switching"))
        yield Advice("info", path, offer.message, offer.patch, offer.title)
