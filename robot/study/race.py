"""The trials of a batch at many draws: made in tasks of a few runs, given up where they are beaten.

Whether a trial is given up is asked now and then, of its draws before that alone. What follows is
under way meanwhile, so that many cores have enough to do; of a trial that is given up it is
cancelled and looked at no more. So the outcomes are the same however the draws are
cut into tasks, however many of these are under way, and in whatever order they end.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from itertools import pairwise
from math import ceil

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.outcome import Outcome

AT_ONCE = 64
"""Tasks of a batch that are under way at once (*ours*): as many cores can have something to do."""
TASK = 0.05
"""Least time that the runs of a task take in [s] (*ours*), so that a cluster adds little to it."""
ROW, STEP = 2.2e-6, 7e-7
"""Time of a row in continuous time, and of a step of the arm in a sampled loop, with all figures,
in [s] (*ours*, measured)."""

MOST_DRAWS = 8
"""Draws that a task makes at most (*ours*)."""

Submit = Callable[[int, Sequence[int]], Future[list[list[Outcome]]]]


def draws_a_task(experiment: Experiment) -> int:
    """Return how many draws of a lane one task makes."""
    simulation = experiment.simulation
    row = STEP * simulation.plant_substeps if simulation.mode == "sampled" else ROW
    return min(MOST_DRAWS, ceil(TASK / (row * simulation.rows)))


def race(
    numbers: Sequence[int],
    draws: Sequence[int],
    looks: Sequence[int],
    size: int,
    submit: Submit,
    is_beaten: Callable[[Sequence[Outcome]], bool],
    at_once: int = AT_ONCE,
) -> dict[int, list[Outcome]]:
    """Return the outcomes of each trial, in the order of the draws, as far as it came.

    Args:
        numbers: of the trials.
        draws: indices of the draws, in the order in which they are made.
        looks: after how many of them it is asked whether a trial is beaten, the last time of all.
        size: how many of them one task makes.
        submit: begins a task: some draws of a trial, whose outcomes are the first of its result.
        is_beaten: tells of the outcomes of a trial's first draws whether the rest is left out.
        at_once: how many tasks are under way at most.
    """
    met: dict[int, list[Outcome]] = {number: [] for number in numbers}
    racing = set(numbers)
    pieces = (
        (number, draws[first : min(first + size, end)])
        for start, end in pairwise([0, *looks])
        for number in numbers
        for first in range(start, end, size)
    )
    under_way: deque[tuple[int, Future[list[list[Outcome]]]]] = deque()

    def fill() -> None:
        while len(under_way) < at_once and (piece := next(pieces, None)) is not None:
            number, some = piece
            if number in racing:
                under_way.append((number, submit(number, some)))

    try:
        fill()
        while under_way:
            number, task = under_way[0]
            met[number] += task.result()[0]
            under_way.popleft()
            if len(met[number]) in looks and is_beaten(met[number]):
                racing.discard(number)
                for late in [one for one in under_way if one[0] == number]:
                    late[1].cancel()
                    under_way.remove(late)
            fill()
    finally:
        for _, task in under_way:
            task.cancel()
    return met
