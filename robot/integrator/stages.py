"""What every law's kernel does before and after its own torque: the closed loop's common part.

Continuous mode asks for one stage (PLAIN) or two (FIRST at t, SECOND at t + h/2) a step; sampled
mode for one ``sample`` a control period and several ``substep``.
"""

from __future__ import annotations

from math import inf

from slidetune.robot.environment.external_torque import (
    changes_within_a_step,
    disturbance_torque,
    external_torque,
)
from slidetune.robot.environment.layout import LIMIT
from slidetune.robot.environment.sensor import measure
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.drive import drive, lags
from slidetune.robot.integrator.implicit_step import (
    REFUSED,
    STUCK,
    TOLERANCE_V,
    accept,
    accept_motion,
    arm_step,
    implicit_step,
    keep_command,
    step_error,
    unsolved,
    within_bounds,
)
from slidetune.robot.integrator.kernel_arrays import (
    ADVANCE,
    HAS_WEIGHTS,
    ask,
    delay_line,
    loop_arrays,
    move_memory,
    settings,
)
from slidetune.robot.kernels.compiler import inlined, kernel, part
from slidetune.robot.kernels.workspace import (
    APPLIED,
    COMMAND,
    CURRENT,
    DISTURBANCE,
    DISTURBANCE_HALF,
    EDGE,
    FULL,
    HALF,
    HELD,
    HELD_TORQUE,
    HIDDEN,
    LEAKAGE,
    LEARNING,
    MEASURED_Q,
    MEASURED_V,
    NETWORK,
    NODES,
    PASSED,
    QD,
    R_F,
    R_Q,
    R_QD,
    R_S,
    R_TAU,
    R_V,
    R_VD,
    R_WEIGHTS,
    SLIDING,
    TAU,
    TRIAL,
    VD,
    WRONG,
    F,
    Q,
    S,
    V,
    W,
)
from slidetune.robot.motion.trajectory import reference

PLAIN, FIRST, SECOND = 0, 1, 2


@part
def _begin(stage, t, table):  # type: ignore[no-untyped-def]
    """Evaluate desired motion and environment at the state of a stage; return its first row."""
    h, _, _ = settings(table)
    _, _, environment, trajectory, work, _ = loop_arrays(table)
    state = HALF if stage == SECOND else CURRENT
    reference(t, trajectory, work)
    if stage == FIRST and changes_within_a_step(environment):
        disturbance_torque(t, 0.5 * h, environment, work)
        for j in range(JOINTS):
            work[DISTURBANCE_HALF, j] = work[DISTURBANCE, j]
    external_torque(t, 0.5 * h if stage == SECOND else h, state, environment, work)
    for j in range(JOINTS):
        work[MEASURED_Q, j] = work[state + Q, j]
        work[MEASURED_V, j] = work[state + V, j]
    return state


@inlined
def write_record(row, weights, environment, work, record):  # type: ignore[no-untyped-def]
    """Record the current state and what the law said of it, in the order of ``RECORD``."""
    # Row by row, so that all six are added at once.
    for j in range(JOINTS):
        work[TRIAL, j] = 0.0
    for n in range(NODES if weights != 0 else 0):
        for j in range(JOINTS):
            work[TRIAL, j] += work[CURRENT + W + n, j] * work[CURRENT + W + n, j]
    for j in range(JOINTS):
        limit = environment[LIMIT, j]
        record[row, R_Q, j] = work[CURRENT + Q, j]
        record[row, R_V, j] = work[CURRENT + V, j]
        record[row, R_TAU, j] = min(max(work[TAU, j], -limit), limit)
        record[row, R_S, j] = work[S, j]
        record[row, R_F, j] = work[NETWORK, j]
        record[row, R_WEIGHTS, j] = work[TRIAL, j] ** 0.5
        record[row, R_QD, j] = work[QD, j]
        record[row, R_VD, j] = work[VD, j]


@kernel
def _remember(h, state, into, table):  # type: ignore[no-untyped-def]
    """Let a law move its memory on after an implicit step; return 0 or RAISED."""
    inertia, _, environment, _, work, _ = loop_arrays(table)
    keep_command(h, inertia, environment, work)
    return move_memory(h, state, into, table)


@part
def _finish(stage, state, row, table):  # type: ignore[no-untyped-def]
    """Record (but for SECOND) and integrate one stage."""
    h, _, tolerance = settings(table)
    inertia, bias, environment, _, work, record = loop_arrays(table)
    # Of a step's three sizes each goes through here: compiled once, with its states as numbers.
    second = stage == SECOND
    if second:
        left = implicit_step(0.5 * h, state, state, inertia, bias, environment, work)
        if unsolved(left, tolerance, work):
            return STUCK
        if table[ADVANCE] != 0:
            bad = _remember(0.5 * h, state, state, table)
            if bad != 0:
                return bad
        work[WRONG, 0] = step_error(h, tolerance, work)
        if work[WRONG, 0] > tolerance:
            return REFUSED
        return accept(second, lags(environment), work)
    if row >= 0:
        write_record(row, table[HAS_WEIGHTS], environment, work, record)
    if work[EDGE, 0] != 0.0 and tolerance != inf:
        return REFUSED
    work[HELD, 0], work[PASSED, 0] = 0.0, 0.0
    left = implicit_step(h, state, state + FULL, inertia, bias, environment, work)
    if row >= 0 and work[HELD, 0] != 0.0:
        _record_held_torque(row, work, record)
    if unsolved(left, tolerance, work):
        return STUCK
    if table[ADVANCE] != 0:
        bad = _remember(h, state, state + FULL, table)
        if bad != 0:
            return bad
    if stage == PLAIN:
        if work[PASSED, 0] > tolerance * TOLERANCE_V:
            return REFUSED
        return accept(second, lags(environment), work)
    if changes_within_a_step(environment):
        for j in range(JOINTS):
            work[F, j] += work[DISTURBANCE_HALF, j] - work[DISTURBANCE, j]
    half = state + HALF
    left = implicit_step(0.5 * h, state, half, inertia, bias, environment, work)
    if unsolved(left, tolerance, work):
        return STUCK
    if table[ADVANCE] != 0:
        bad = _remember(0.5 * h, state, half, table)
        if bad != 0:
            return bad
    return within_bounds(half, work)


@kernel
def _record_held_torque(row, work, record):  # type: ignore[no-untyped-def]
    """Record the torque that holds a joint on S = 0: sign(S) alone does not tell it there."""
    for j in range(JOINTS):
        if work[SLIDING, j] != 0.0:
            record[row, R_TAU, j] = work[HELD_TORQUE, j]


@kernel
def observe(t, sample, table):  # type: ignore[no-untyped-def]
    """Evaluate the desired motion at ``t`` and measure the current state, with sensor noise."""
    _, _, environment, trajectory, work, _ = loop_arrays(table)
    reference(t, trajectory, work)
    measure(sample, environment, work)


@part
def command(row, table):  # type: ignore[no-untyped-def]
    """Record, limit the torque and let the law learn or remember for one control period."""
    _, period, _ = settings(table)
    _, _, environment, _, work, record = loop_arrays(table)
    write_record(row, table[HAS_WEIGHTS], environment, work, record)
    for j in range(JOINTS):
        limit = environment[LIMIT, j]
        work[TAU, j] = min(max(work[TAU, j], -limit), limit)
        if not abs(work[TAU, j]) < 1e12:
            return j + 1
        gain, leak = period * work[LEARNING, j] * work[S, j], period * work[LEAKAGE, j]
        for n in range(NODES):
            weight = work[CURRENT + W + n, j]
            work[CURRENT + W + n, j] = weight + gain * work[HIDDEN + n, j] - leak * weight
    bad = move_memory(period, CURRENT, CURRENT, table)
    return bad if bad != 0 else within_bounds(CURRENT, work)


@kernel
def make_stage(stage, t, row, table):  # type: ignore[no-untyped-def]
    """One stage of a step of continuous mode, with M and h known at its state.

    Args:
        stage: PLAIN, FIRST or SECOND.
        t: time of its state in [s].
        row: row of the record to write; below 0 none.
        table: the lane's table; its step is the whole step for every stage.

    Returns:
        0; 1 + the joint that left its bounds; REFUSED or STUCK where the step has to be cut;
        RAISED.
    """
    state = _begin(stage, t, table)
    bad = ask(state, table)
    return bad if bad != 0 else _finish(stage, state, row, table)


@kernel
def sample(t, number, row, table):  # type: ignore[no-untyped-def]
    """One control period of sampled mode, but for the arm, with the nominal M and h known.

    Args:
        t: time in [s].
        number: number of the control period, which the sensor noise follows.
        row: row of the record to write.
        table: the lane's table.

    Returns:
        0; 1 + the joint whose torque or weights are no longer finite; RAISED.
    """
    observe(t, number, table)
    bad = ask(CURRENT, table)
    if bad == 0:
        bad = command(row, table)
    if bad == 0:
        commands, _, _ = delay_line(table)
        _, _, _, _, work, _ = loop_arrays(table)
        for j in range(JOINTS if len(commands) > 0 else 0):
            commands[number % len(commands), j] = work[TAU, j]
    return bad


@part
def _hold(number, index, table):  # type: ignore[no-untyped-def]
    """Write the mean torque of the joints in a step of the arm to APPLIED [N m].

    A torque reaches their drives ``input_delay`` after its measurement. Where that is within a
    step, the step is made under the mean of both torques: their impulse is exact, and what the
    angle lacks is of the step's own order.
    """
    commands, periods, substeps = delay_line(table)
    _, _, environment, _, work, _ = loop_arrays(table)
    before = commands[(number - periods - 1) % len(commands)]
    after = commands[(number - periods) % len(commands)]
    late = min(max(substeps - index, 0.0), 1.0)
    if not lags(environment):
        for j in range(JOINTS):
            work[APPLIED, j] = late * before[j] + (1.0 - late) * after[j]
        return
    h, _, _ = settings(table)
    for j in range(JOINTS):
        work[APPLIED, j], work[COMMAND, j] = 0.0, before[j]
    if late > 0.0:
        drive(late * h, late, environment, work)
    for j in range(JOINTS):
        work[COMMAND, j] = after[j]
    if late < 1.0:
        drive((1.0 - late) * h, 1.0 - late, environment, work)


@kernel
def substep(t, number, index, table):  # type: ignore[no-untyped-def]
    """One step of the arm within a control period, with M and h known.

    Args:
        t: time of the control period in [s].
        number: its number.
        index: which step of the arm.
        table: the lane's table.

    Returns:
        0, or 1 + the joint that left its bounds; the current state is then untouched.
    """
    _hold(number, index, table)
    h, _, _ = settings(table)
    return plant_step(t + index * h, table)


@kernel
def plant_step(t, table):  # type: ignore[no-untyped-def]
    """One step of the arm alone under the torque APPLIED, implicit in friction.

    Args:
        t: time in [s].
        table: the arm's table.

    Returns:
        0, or 1 + the joint that left its bounds; the current state is then untouched.
    """
    h, _, _ = settings(table)
    inertia, bias, environment, _, work, _ = loop_arrays(table)
    external_torque(t, h, CURRENT, environment, work)
    unsolved(arm_step(h, inertia, bias, environment, work), inf, work)
    return accept_motion(work)
