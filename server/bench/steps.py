"""The control step on this machine: Pinocchio alone, the kernels alone, whole runs.

Steps are counted in processor time, whole runs in time on the wall. All cases take turns in every
round, so that a busy moment hits all of them and ratios keep their meaning on a loaded machine.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter, thread_time
from typing import Any

import numba
import numpy as np
import pinocchio as pin

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.integrator.kernel_arrays import kernel_table
from slidetune.robot.integrator.stages import FIRST, make_stage
from slidetune.robot.kernels.workspace import RECORD_COLUMNS, Q, V
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.lane import Lane
from slidetune.robot.loop.simulate import simulate
from slidetune.server.bench.result import Measurement, measurement

MICROSECOND = 1e-6
LOOPS = 10_000
"""Calls timed at once (*ours*)."""
WARM, WARM_STEP = 1000, 0.001
"""Steps, and their length in [s], after which a single stage is timed (*ours*): past the start."""
LAW = "rbfnn_nftsm"
COMPARISON = {
    name: {"law": law}
    for name, law in (
        ("RBFNN-NFTSM", "rbfnn_nftsm"),
        ("RBFNN-SMC", "rbfnn_smc"),
        ("NFTSM", "nftsm"),
    )
}
SAMPLED = {
    "robot": {"inertials": "datasheet", "armature": [0.6] * 3 + [0.15] * 3},
    "lanes": {
        "A": {
            "law": LAW,
            "nu": 10,
            "c": 1,
            "mu": 0.1,
            "k1": [80, 80, 40, 8, 8, 8],
            "k2": [40, 40, 25, 5, 5, 5],
            "learning_rate": [40, 40, 20, 4, 4, 4],
        }
    },
}
"""Gains that a sampled loop at 1 kHz bears (*ours*)."""

FLOOR = "Pinocchio once: crba + nonLinearEffects from Python"
FLOOR_TWICE = "Pinocchio twice"
PLAIN_STEP = "plain step, RBFNN-NFTSM"
EXTRAPOLATED_STEP = "extrapolated step, RBFNN-NFTSM"


@dataclass(frozen=True)
class Case:
    """Something to time.

    Attributes:
        name: what it is.
        unit: unit of what ``measure`` returns.
        measure: does the work once and returns the figure.
        target: greatest permitted figure.
        floor: name of the case that it is compared with, ``None`` for none.
        most: greatest permitted ratio to that one.
    """

    name: str
    unit: str
    measure: Callable[[], float]
    target: float | None = None
    floor: str | None = None
    most: float | None = None


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


def _timed(call: Callable[[], Any], loops: int) -> float:
    """Return the processor time of one call in [µs]."""
    begin = thread_time()
    for _ in range(loops):
        call()
    return (thread_time() - begin) / loops / MICROSECOND


def _dynamics(packed: Packed, loops: int) -> tuple[Callable[[], float], Callable[[], float]]:
    """Return the timings in [µs] of one evaluation of M and h, and of two."""
    model, data = packed.model, packed.model.createData()
    crba, bias = pin.crba, pin.nonLinearEffects
    q, v = np.linspace(0.1, 0.6, 6), np.linspace(0.6, 0.1, 6)

    def once() -> float:
        begin = thread_time()
        for _ in range(loops):
            crba(model, data, q)
            bias(model, data, q, v)
        return (thread_time() - begin) / loops / MICROSECOND

    def twice() -> float:
        begin = thread_time()
        for _ in range(loops):
            crba(model, data, q)
            bias(model, data, q, v)
            crba(model, data, q)
            bias(model, data, q, v)
        return (thread_time() - begin) / loops / MICROSECOND

    return once, twice


def _empty(t, row, table):  # type: ignore[no-untyped-def]
    return 0


def _kernels(packed: Packed, loops: int) -> tuple[Callable[[], float], Callable[[], float]]:
    """Return timings in [µs] of a compiled function without a body and of a law's first stage."""
    lane = Lane("A", packed, np.zeros((WARM, RECORD_COLUMNS)))
    for row in range(WARM):
        lane.step(row * WARM_STEP, row, row)
    arm = dynamics(packed.model, lane.work[Q], lane.work[V])
    arm.refill()
    rest = (packed.gains["A"], packed.environment, packed.trajectory, lane.work, lane.record)
    table = kernel_table(arm, arm, *rest, control=LAWS[LAW].control, step=WARM_STEP)
    t, empty = WARM * WARM_STEP, numba.njit(_empty)
    # The first stage leaves the state as it is, so that all calls do the same.
    first, nothing = lambda: make_stage(FIRST, t, 0, table), lambda: empty(0.0, 0, table)
    return lambda: _timed(nothing, loops), lambda: _timed(first, loops)


def _run(document: dict[str, Any], horizon: float, whole: bool = False) -> Callable[[], float]:
    """Return the timing of ``simulate``: in [s], or in [µs] a step of one lane."""
    settings = {"horizon": horizon, **document.get("simulation", {})}
    experiment = Experiment.from_document({**document, "simulation": settings})
    steps = experiment.simulation.rows * len(experiment.lanes)

    clock = perf_counter if whole else thread_time

    def measure() -> float:
        begin = clock()
        run = simulate(experiment, estimate=False)
        taken = clock() - begin
        if any(lane.freeze for lane in run.lanes.values()):
            raise ArithmeticError("a lane left its bounds: its steps can't be counted")
        return taken if whole else taken / steps / MICROSECOND

    return measure


def _law(law: str, scheme: str, horizon: float) -> Callable[[], float]:
    return _run({"lanes": {"A": {"law": law}}, "simulation": {"scheme": scheme}}, horizon)


def step_cases(quick: bool) -> list[Case]:
    """Return everything to time, the floor first.

    Args:
        quick: short horizons and few calls, for a look instead of a verdict.
    """
    horizon, loops = (0.2, 200) if quick else (10.0, LOOPS)
    packed = pack(Experiment.from_document({"lanes": {"A": {"law": LAW}}}))
    once, twice = _dynamics(packed, loops)
    empty, stage = _kernels(packed, loops)
    cases = [
        Case(FLOOR, "µs", once),
        Case(FLOOR_TWICE, "µs", twice),
        Case("empty numba call", "µs", empty),
        Case("numba call of the first stage, RBFNN-NFTSM", "µs", stage),
        Case(PLAIN_STEP, "µs", _law(LAW, "plain", horizon), 5.0, FLOOR, 2.0),
        Case(EXTRAPOLATED_STEP, "µs", _law(LAW, "extrapolated", horizon), 9.0, FLOOR_TWICE, 2.0),
    ]
    for name, law in LAWS.items():
        if name != LAW:
            title = f"extrapolated step, {law.title}"
            measure = _law(name, "extrapolated", horizon)
            cases.append(Case(title, "µs", measure, floor=FLOOR_TWICE))
    sampled = {**SAMPLED, "simulation": {"mode": "sampled"}}
    comparison = {"lanes": COMPARISON}
    coarse = {**comparison, "simulation": {"step": 0.002}}
    whole = f"3 lanes, {horizon:g} s in steps of"
    return [
        *cases,
        Case("sampled period of 10 steps of the arm", "µs", _run(sampled, horizon), floor=FLOOR),
        Case(f"{whole} 1 ms", "s", _run(comparison, horizon, True), 0.3),
        Case(f"{whole} 2 ms", "s", _run(coarse, horizon, True), 0.15),
    ]


def measure_steps(quick: bool, progress: Callable[[float], None]) -> list[Measurement]:
    """Time all cases and return their rows; ratios are to Pinocchio in the same round."""
    cases = step_cases(quick)
    samples = interleaved(cases, 2 if quick else 9, progress)
    return [
        measurement(
            case.name,
            case.unit,
            samples[case.name],
            None if case.floor is None else samples[case.floor],
            target=case.target,
            most=case.most,
        )
        for case in cases
    ]
