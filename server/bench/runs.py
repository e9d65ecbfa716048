"""Whole runs in time on the wall: the lanes of a comparison, one by one and on two cores."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import simulate
from slidetune.server.bench.rounds import Case

CORES = 2
"""How many cores the targets speak of."""
COMPARISON = {
    name: {"law": law}
    for name, law in (
        ("RBFNN-NFTSM", "rbfnn_nftsm"),
        ("RBFNN-SMC", "rbfnn_smc"),
        ("NFTSM", "nftsm"),
    )
}


def cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def finished(experiment: Experiment, estimate: bool = False) -> None:
    """Simulate an experiment to its end.

    Raises:
        ArithmeticError: if a lane left its bounds: then its steps can't be counted.
    """
    run = simulate(experiment, estimate=estimate)
    if any(lane.freeze for lane in run.lanes.values()):
        raise ArithmeticError("a lane left its bounds: its steps can't be counted")


def _wall(work: Callable[[], object]) -> Callable[[], float]:
    def measure() -> float:
        begin = perf_counter()
        work()
        return perf_counter() - begin

    return measure


def run_cases(horizon: float, batch: int) -> list[Case]:
    """Return the cases of whole runs.

    Args:
        horizon: of every run in [s].
        batch: how many runs are made at once where runs a second are counted.
    """
    simulation = {"horizon": horizon}
    comparison = Experiment.from_document({"lanes": COMPARISON, "simulation": simulation})
    lanes = [only_lane(comparison, name) for name in COMPARISON]
    # A thread for each lane, as the server has: on fewer cores all of them end at the same time.
    pool, each = ThreadPoolExecutor(CORES), ThreadPoolExecutor(len(lanes))
    apart = _wall(lambda: list(each.map(finished, lanes)))
    many = _wall(lambda: list(pool.map(finished, lanes[:1] * batch)))
    enough = cores() >= CORES
    note = "" if enough else "only one core here"
    length = f"{horizon:g} s"
    return [
        Case(f"3 lanes, {length} in steps of 1 ms", "s", _wall(lambda: finished(comparison)), 0.06),
        Case("the same, a thread for each lane", "s", apart, 0.035 if enough else None, note=note),
        Case(
            f"whole runs a second, RBFNN-NFTSM, {length}, two threads",
            "Hz",
            lambda: batch / many(),
            85.0 if enough else None,
            limit="at least",
            note=note,
        ),
    ]
