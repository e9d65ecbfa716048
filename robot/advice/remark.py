"""One remark on a lane's numbers, and how it writes numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np


@dataclass(frozen=True)
class Advice:
    """One piece of advice on a lane's numbers.

    Attributes:
        level: ``warning`` where trouble is to be expected, ``info`` where something is surprising.
        path: the field it concerns, dotted from the experiment.
        message: the number, the rule and the way out.
        patch: a merge patch that sets the nearest good value, or ``None``.
        title: what to call the patch; empty where its values say it.
    """

    level: Literal["info", "warning"]
    path: str
    message: str
    patch: dict[str, Any] | None = None
    title: str = ""


def short(value: float) -> str:
    """Return a number of three digits, without an exponent up to a million."""
    return f"{float(f'{value:.3g}'):g}"


def span(values: float | list[float]) -> str:
    """Return a number, or the least and the greatest of several."""
    low, high = float(np.min(values)), float(np.max(values))
    return short(low) if low == high else f"{short(low)} to {short(high)}"
