"""What a step of the live session costs: Pinocchio alone, the kernels alone, a lane's steps."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import thread_time
from typing import Any

import numba
import numpy as np
import pinocchio as pin

from slidetune.robot.arm.dynamics import chain_of, dynamics
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.kernel_arrays import evaluate_arm, kernel_table
from slidetune.robot.integrator.stages import FIRST, make_stage
from slidetune.robot.kernels.workspace import CURRENT, RECORD, Q, V
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.horizon import stepped_rows
from slidetune.robot.loop.lane import Lane
from slidetune.robot.loop.simulate import stop_flag
from slidetune.server.bench.rounds import Case

Timing = Callable[[], float]
"""Does something once and returns its processor time, in [µs] a call or a step."""

MICROSECOND = 1e-6
WARM, WARM_STEP = 1000, 0.001
"""Steps, and their length in [s], after which a single stage is timed (*ours*): past the start."""
LAW = "rbfnn_nftsm"
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
    "simulation": {"mode": "sampled"},
}
"""Gains that a sampled loop at 1 kHz bears (*ours*)."""

FLOOR = "Pinocchio once: crba + nonLinearEffects from Python"
FLOOR_TWICE = "Pinocchio twice"
RECURSION = "M and h by the compiled recursion, called from Python"
PLAIN_STEPPED = "step of the live session, plain"
EXTRAPOLATED_STEPPED = "step of the live session, extrapolated"


def _timed(call: Callable[[], Any], loops: int) -> float:
    begin = thread_time()
    for _ in range(loops):
        call()
    return (thread_time() - begin) / loops / MICROSECOND


def _dynamics(packed: Packed, loops: int) -> tuple[Timing, Timing]:
    """Return the timings of one evaluation of M and h by Pinocchio, and of two."""
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


def _kernels(packed: Packed, loops: int) -> tuple[Timing, Timing]:
    """Return the timings of a compiled function without a body and of a law's first stage."""
    lane = Lane("A", packed, np.zeros((WARM, len(RECORD), JOINTS)))
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


def _recursion(packed: Packed, loops: int) -> list[Case]:
    """Return the case of the compiled recursion; none where it can't stand for Pinocchio."""
    if packed.chain is None:
        return []
    lane = Lane("A", packed, np.zeros((1, len(RECORD), JOINTS)))
    arm = chain_of(packed.chain)
    rest = (packed.gains["A"], packed.environment, packed.trajectory, lane.work, lane.record)
    table = kernel_table(arm, arm, *rest)
    evaluate = partial(evaluate_arm, CURRENT, table)
    return [Case(RECURSION, "µs", partial(_timed, evaluate, loops), floor=FLOOR)]


def stepped(document: dict[str, Any], horizon: float) -> Timing:
    """Return the timing of a step of a lane as the live session makes it: over Pinocchio.

    Args:
        document: an experiment with the lane A.
        horizon: how long it is stepped, in [s].
    """
    settings = {"horizon": horizon, **document["simulation"]}
    packed = pack(Experiment.from_document({**document, "simulation": settings}))
    count = packed.experiment.simulation.rows
    lane = Lane("A", packed, np.zeros((count, len(RECORD), JOINTS)))

    def measure() -> float:
        lane.restart(packed)
        make, rows, stop = stepped_rows(lane, packed), np.array([0, count]), stop_flag()
        begin = thread_time()
        bad = make(rows, stop)
        taken = thread_time() - begin
        if bad:
            raise ArithmeticError("the lane left its bounds: its steps can't be counted")
        return taken / count / MICROSECOND

    return measure


def stepped_cases(horizon: float, loops: int) -> list[Case]:
    """Return the cases of the live step, the floor first.

    Args:
        horizon: of a run in [s].
        loops: how many calls are timed at once.
    """
    document: dict[str, Any] = {"lanes": {"A": {"law": LAW}}}
    packed = pack(Experiment.from_document(document))
    once, twice = _dynamics(packed, loops)
    empty, stage = _kernels(packed, loops)
    plain, extrapolated = (
        stepped({**document, "simulation": {"scheme": scheme}}, horizon)
        for scheme in ("plain", "extrapolated")
    )
    sampled = stepped(SAMPLED, horizon)
    return [
        Case(FLOOR, "µs", once),
        Case(FLOOR_TWICE, "µs", twice),
        *_recursion(packed, loops),
        Case("empty numba call", "µs", empty),
        Case("numba call of the first stage, RBFNN-NFTSM", "µs", stage),
        Case(PLAIN_STEPPED, "µs", plain, floor=FLOOR, most=2.0),
        Case(EXTRAPOLATED_STEPPED, "µs", extrapolated, floor=FLOOR_TWICE, most=2.0),
        Case("period of the live session, sampled, 10 steps of the arm", "µs", sampled),
    ]
