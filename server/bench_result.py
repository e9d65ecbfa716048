"""What a benchmark measured: one row a quantity, best and median, against the floor, the target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

Limit = Literal["at most", "at least"]


@dataclass(frozen=True)
class Measurement:
    """One quantity.

    Attributes:
        name: what was measured.
        unit: its unit.
        best: the best of all repeats.
        typical: their median.
        ratio: median ratio to the floor of the same round, ``None`` where there is no floor.
        high: 95th percentile, where that is what the target speaks of, else ``None``.
        target: what it must reach, ``None`` for information.
        limit: on which side of the target it must be.
        note: a remark, such as why it couldn't be measured.
    """

    name: str
    unit: str
    best: float | None
    typical: float | None
    ratio: float | None = None
    high: float | None = None
    target: float | None = None
    limit: Limit = "at most"
    note: str = ""

    @property
    def judged(self) -> float | None:
        """The figure that the target speaks of."""
        return self.best if self.high is None else self.high

    @property
    def met(self) -> bool | None:
        """Whether the target is met; ``None`` where there is none or nothing was measured."""
        if self.target is None or self.judged is None:
            return None
        if self.limit == "at least":
            return self.judged >= self.target
        return self.judged <= self.target

    def document(self) -> dict[str, Any]:
        """Return the row as plain JSON values."""
        return {**asdict(self), "met": self.met}


def measurement(
    name: str,
    unit: str,
    samples: Sequence[float],
    floor: Sequence[float] | None = None,
    *,
    target: float | None = None,
    note: str = "",
) -> Measurement:
    """Return the row of repeated measurements.

    Args:
        name: what was measured.
        unit: its unit.
        samples: one value a round. Shape (n,).
        floor: the floor's values in the same rounds. Shape (n,).
        target: greatest permitted value.
        note: a remark.
    """
    values = np.asarray(samples)
    ratio = None if floor is None else float(np.median(values / np.asarray(floor)))
    return Measurement(
        name, unit, float(values.min()), float(np.median(values)), ratio, target=target, note=note
    )
