"""How much a noisy series grows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import median


@dataclass(frozen=True)
class Growth:
    """How a series goes on.

    Attributes:
        before: median of its first third.
        after: median of its last third.
        slope: median of the slopes between all pairs of points (Theil and Sen), a unit of time.
    """

    before: float
    after: float
    slope: float

    @property
    def step(self) -> float:
        """How much more it is in the end."""
        return self.after - self.before


def growth(times: Sequence[float], values: Sequence[float]) -> Growth:
    """Return how a series grows; single outliers count for nothing.

    Raises:
        ValueError: for fewer than three points.
    """
    if len(values) < 3:
        raise ValueError(f"three points at least are needed to see growth, got {len(values)}")
    third = max(1, len(values) // 3)
    pairs = combinations(zip(times, values, strict=True), 2)
    slopes = [(y1 - y0) / (x1 - x0) for (x0, y0), (x1, y1) in pairs if x1 > x0]
    return Growth(median(values[:third]), median(values[-third:]), median(slopes))
