"""Things to time, in rounds in which each takes its turn.

So a busy moment hits all of them, and ratios keep their meaning on a loaded machine.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slidetune.server.bench.result import Limit, Measurement, measurement


@dataclass(frozen=True)
class Case:
    """Something to time.

    Attributes:
        name: what it is.
        unit: unit of what ``measure`` returns.
        measure: does the work once and returns the figure.
        target: what the figure must reach.
        floor: name of the case that it is compared with, ``None`` for none.
        most: greatest permitted ratio to that one.
        limit: on which side of the target the figure must be.
        note: a remark.
    """

    name: str
    unit: str
    measure: Callable[[], float]
    target: float | None = None
    floor: str | None = None
    most: float | None = None
    limit: Limit = "at most"
    note: str = ""


def interleaved(
    cases: Sequence[Case], rounds: int, progress: Callable[[float], None]
) -> dict[str, list[float]]:
    """Let all cases take turns and return each one's figure of every round.

    There is one round more than asked for: the first warms up and doesn't count.

    Args:
        cases: what to time.
        rounds: how many figures a case gets.
        progress: called with the share done, 0 to 1.
    """
    samples: dict[str, list[float]] = {case.name: [] for case in cases}
    gc.collect()
    gc.disable()
    try:
        for turn in range(rounds + 1):
            for number, case in enumerate(cases):
                value = case.measure()
                if turn:
                    samples[case.name].append(value)
                progress((turn * len(cases) + number + 1) / ((rounds + 1) * len(cases)))
    finally:
        gc.enable()
    return samples


def measured(
    cases: Sequence[Case], rounds: int, progress: Callable[[float], None]
) -> list[Measurement]:
    """Time all cases and return their rows; ratios are to the floor in the same round."""
    samples = interleaved(cases, rounds, progress)
    return [
        measurement(
            case.name,
            case.unit,
            samples[case.name],
            None if case.floor is None else samples[case.floor],
            target=case.target,
            most=case.most,
            limit=case.limit,
            note=case.note,
        )
        for case in cases
    ]
