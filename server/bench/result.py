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
        most: greatest permitted ratio to the floor, ``None`` for information.
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
    most: float | None = None
    note: str = ""

    @property
    def judged(self) -> float | None:
        """The figure that the target speaks of."""
        return self.best if self.high is None else self.high

    @property
    def met(self) -> bool | None:
        """Whether the targets are met; ``None`` where there is none or nothing was measured."""
        verdicts = []
        if self.target is not None and self.judged is not None:
            enough = self.judged >= self.target
            verdicts.append(enough if self.limit == "at least" else self.judged <= self.target)
        if self.most is not None and self.ratio is not None:
            verdicts.append(self.ratio <= self.most)
        return all(verdicts) if verdicts else None

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
    most: float | None = None,
    limit: Limit = "at most",
    note: str = "",
) -> Measurement:
    """Return the row of repeated measurements.

    Args:
        name: what was measured.
        unit: its unit.
        samples: one value a round. Shape (n,).
        floor: the floor's values in the same rounds. Shape (n,).
        target: what the best value must reach.
        most: greatest permitted ratio to the floor.
        limit: on which side of the target it must be, which also tells which value is the best.
        note: a remark.
    """
    values = np.asarray(samples)
    ratio = None if floor is None else float(np.median(values / np.asarray(floor)))
    return Measurement(
        name,
        unit,
        float(values.max() if limit == "at least" else values.min()),
        float(np.median(values)),
        ratio,
        target=target,
        limit=limit,
        most=most,
        note=note,
    )
