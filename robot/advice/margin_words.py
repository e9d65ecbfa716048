"""What a margin says in words: why a loop is not stable, and which other gains would make it so."""

from __future__ import annotations

import numpy as np

from slidetune.robot.margins.margin import Margin
from slidetune.robot.margins.period_map import INSTANT


def other_gains(margin: Margin, learns: bool) -> list[str]:
    """Say in words which other gains would make a loop stable."""
    if margin.gamma and margin.limit:
        factor = margin.limit / margin.gamma
        if factor > 1.0:
            return [f"reaching gains {short(1.01 * factor)} times higher"]
        return [f"reaching gains {short(1.01 / factor)} times lower"]
    return ["lower surface gains"] + (["a lower learning rate"] if learns else [])


def instability(margin: Margin, sampled: bool, late: str) -> str:
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


def short(value: float) -> str:
    """Return a number of three digits, without an exponent up to a million."""
    return f"{float(f'{value:.3g}'):g}"


def span(values: float | list[float]) -> str:
    """Return a number, or the least and the greatest of some."""
    low, high = float(np.min(values)), float(np.max(values))
    return short(low) if low == high else f"{short(low)} to {short(high)}"
