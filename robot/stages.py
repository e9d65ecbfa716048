"""What every law's kernel does before and after its own torque: the closed loop's common part.

Continuous mode asks for one stage (PLAIN) or two (FIRST at t, SECOND at t + h/2) a step; sampled
mode for one ``observe`` and ``command`` a control period and several ``plant_step``.
"""

from __future__ import annotations

from robot.compiled import kernel
from robot.disturbance import LIMIT, external_torque, measure
from robot.implicit_step import accept, implicit_step, solve, within_bounds
from robot.quantity import JOINTS
from robot.trajectory import reference
from robot.wiring import loop_arrays, settings
from robot.workspace import (
    APPLIED,
    CURRENT,
    F_SLOPE,
    FULL,
    HALF,
    HIDDEN,
    LEAKAGE,
    LEARNING,
    MATRIX,
    MEASURED_Q,
    MEASURED_V,
    NETWORK,
    NODES,
    QD,
    RIGHT,
    TAU,
    VD,
    F,
    Q,
    S,
    V,
    W,
)

PLAIN, FIRST, SECOND = 0, 1, 2


@kernel
def begin(t, wiring):  # type: ignore[no-untyped-def]
    """Evaluate the desired motion and the world at the state of a stage; return its first row."""
    stage, _ = settings(wiring)
    _, _, world, trajectory, work, _ = loop_arrays(wiring)
    base = HALF if stage == SECOND else CURRENT
    reference(t, trajectory, work)
    external_torque(t, base, world, work)
    for j in range(JOINTS):
        work[MEASURED_Q, j] = work[base + Q, j]
        work[MEASURED_V, j] = work[base + V, j]
    return base


@kernel
def write_record(row, world, work, record):  # type: ignore[no-untyped-def]
    """Record the current state and what the law said of it, in the order of ``RECORD``."""
    for j in range(JOINTS):
        squares = 0.0
        for n in range(NODES):
            squares += work[CURRENT + W + n, j] ** 2
        limit = world[LIMIT, j]
        record[row, j] = work[CURRENT + Q, j]
        record[row, JOINTS + j] = work[CURRENT + V, j]
        record[row, 2 * JOINTS + j] = min(max(work[TAU, j], -limit), limit)
        record[row, 3 * JOINTS + j] = work[S, j]
        record[row, 4 * JOINTS + j] = work[NETWORK, j]
        record[row, 5 * JOINTS + j] = squares**0.5
        record[row, 6 * JOINTS + j] = work[QD, j]
        record[row, 7 * JOINTS + j] = work[VD, j]


@kernel
def finish(row, wiring):  # type: ignore[no-untyped-def]
    """Record (but for SECOND) and integrate one stage.

    Args:
        row: row of the record to write.
        wiring: the lane's wiring; its workspace holds the evaluation of the law, its step is
            the whole step for every stage.

    Returns:
        0, or 1 + the joint that left its bounds.
    """
    stage, h = settings(wiring)
    inertia, bias, world, _, work, record = loop_arrays(wiring)
    limits = world[LIMIT]
    if stage == SECOND:
        implicit_step(0.5 * h, HALF, HALF, inertia, bias, limits, work)
        return accept(True, work)
    write_record(row, world, work, record)
    implicit_step(h, CURRENT, FULL, inertia, bias, limits, work)
    if stage == PLAIN:
        return accept(False, work)
    implicit_step(0.5 * h, CURRENT, HALF, inertia, bias, limits, work)
    return within_bounds(HALF, work)


@kernel
def observe(t, sample, wiring):  # type: ignore[no-untyped-def]
    """Evaluate the desired motion at ``t`` and measure the current state, with sensor noise."""
    _, _, world, trajectory, work, _ = loop_arrays(wiring)
    reference(t, trajectory, work)
    measure(sample, world, work)


@kernel
def command(row, wiring):  # type: ignore[no-untyped-def]
    """Record, limit the torque and let the network learn for one control period, the step.

    Returns:
        0, or 1 + the joint whose torque or weights are no longer finite.
    """
    _, period = settings(wiring)
    _, _, world, _, work, record = loop_arrays(wiring)
    write_record(row, world, work, record)
    for j in range(JOINTS):
        limit = world[LIMIT, j]
        work[TAU, j] = min(max(work[TAU, j], -limit), limit)
        if not abs(work[TAU, j]) < 1e12:
            return j + 1
        gain, leak = period * work[LEARNING, j] * work[S, j], period * work[LEAKAGE, j]
        for n in range(NODES):
            weight = work[CURRENT + W + n, j]
            work[CURRENT + W + n, j] = weight + gain * work[HIDDEN + n, j] - leak * weight
    return within_bounds(CURRENT, work)


@kernel
def plant_step(t, wiring):  # type: ignore[no-untyped-def]
    """One step of the arm alone under the torque APPLIED, linearly implicit in friction.

    Args:
        t: time in [s].
        wiring: the arm's wiring.

    Returns:
        0, or 1 + the joint that left its bounds; the current state is then untouched.
    """
    _, h = settings(wiring)
    inertia, bias, world, _, work, _ = loop_arrays(wiring)
    external_torque(t, CURRENT, world, work)
    for i in range(JOINTS):
        for j in range(JOINTS):
            work[MATRIX + i, j] = inertia[i, j]
        work[MATRIX + i, i] += h * work[F_SLOPE, i]
        work[RIGHT, i] = work[APPLIED, i] - bias[i] - work[F, i]
    solve(work)
    for j in range(JOINTS):
        v = work[CURRENT + V, j] + h * work[RIGHT, j]
        work[FULL + V, j] = v
        work[FULL + Q, j] = work[CURRENT + Q, j] + h * v
        for n in range(NODES):
            work[FULL + W + n, j] = work[CURRENT + W + n, j]
    return accept(False, work)
