"""One control step of one lane, bound to its arrays: Pinocchio, then the loop's kernels.

Everything that a step needs is bound once, so that a step looks up nothing: M and h are views that
Pinocchio refills, the state is a view of the workspace, and a kernel takes all of it as one number.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.dynamics import Dynamics, dynamics
from slidetune.robot.environment.layout import BITS, LAGS, LIMIT, SENSOR_Q, SENSOR_V
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.integrator.cutting import (
    FROM,
    LOOSENESS,
    NO_ROW,
    RESULT,
    begin_parts,
    end_part,
    next_part,
)
from slidetune.robot.integrator.kernel_arrays import STEP, TOLERANCE, kernel_table
from slidetune.robot.integrator.law_call import RAISED, checked
from slidetune.robot.integrator.stages import (
    FIRST,
    PLAIN,
    SECOND,
    make_stage,
    observe,
    sample,
    substep,
)
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import (
    BENDS,
    BETWEEN,
    CURRENT,
    CURVE,
    CURVE_ROWS,
    DELIVERED,
    DRIFT,
    GAIN,
    HALF,
    LEAKAGE,
    LEARNING,
    MEASURED_Q,
    MEASURED_V,
    NETWORK,
    NETWORK_SLOPE,
    REACH,
    S_E,
    S_FALL,
    S_FREE,
    S_V,
    SHAPED,
    TAU,
    Q,
    S,
    V,
)
from slidetune.robot.laws.law import Law

Array = np.ndarray
_OF_A_LAW = (S, S_V, S_E, GAIN, NETWORK, NETWORK_SLOPE, LEARNING, LEAKAGE, REACH, DRIFT)
"""Rows that a law writes besides its torque, each time or never."""
Step = Callable[[float, int, int], int]
"""``step(t, number, row)``: time [s], number of the step, row to record; 0 or 1 + bad joint."""


def _nominal(packed: Packed, work: Array, angles: int, velocities: int) -> Dynamics:
    return dynamics(packed.nominal or packed.model, work[angles], work[velocities])


def continuous_step(
    law: Law, packed: Packed, gains: Array, work: Array, record: Array, cutting: Array
) -> Step:
    """Return a step of continuous mode; the extrapolated one has both sizes begin with one M."""
    crba, bias = pin.crba, pin.nonLinearEffects
    simulation = packed.experiment.simulation
    q, v = work[CURRENT + Q], work[CURRENT + V]
    q2, v2 = work[HALF + Q], work[HALF + V]
    truth = nominal = dynamics(packed.model, q, v)
    model, data = truth.model, truth.data
    separate = law.model_based and packed.nominal is not None
    if separate:
        nominal = _nominal(packed, work, CURRENT + Q, CURRENT + V)
    rest = (gains, packed.environment, packed.trajectory, work, record)
    table = kernel_table(truth, nominal, *rest, **law.kernels, step=simulation.step)
    numbers = table.view(np.float64)
    numbers[TOLERANCE] = cutting[LOOSENESS]
    nominal_model, nominal_data = nominal.model, nominal.data
    first = FIRST if simulation.scheme == "extrapolated" else PLAIN
    make, begin, following, end = (
        for_joints(one, packed.joints) for one in (make_stage, begin_parts, next_part, end_part)
    )

    def attempt(t: float, half: float, row: int) -> int:
        crba(model, data, q)
        bias(model, data, q, v)
        if separate:
            crba(nominal_model, nominal_data, q)
            bias(nominal_model, nominal_data, q, v)
        bad: int = make(first, t, row, table)
        if bad or not first:
            return bad
        crba(model, data, q2)
        bias(model, data, q2, v2)
        if separate:
            crba(nominal_model, nominal_data, q2)
            bias(nominal_model, nominal_data, q2, v2)
        bad = make(SECOND, t + half, row, table)
        return bad

    def in_parts(t: float, row: int) -> int:
        begin(t, cutting, table)
        while following(cutting, table):
            bad = attempt(float(cutting[FROM]), 0.5 * float(numbers[STEP]), row)
            end(bad, cutting, table)
            if not bad:
                row = NO_ROW
        return int(cutting[RESULT])

    whole_half = 0.5 * simulation.step

    def step(t: float, number: int, row: int) -> int:
        bad = attempt(t, whole_half, row)
        if not bad:
            return 0
        return checked(bad if bad == RAISED else in_parts(t, row))

    return step


def torques_on_the_way(packed: Packed, work: Array, before: Array) -> Array:
    """Return the torques that wait for the input delay to pass; step ``n`` writes row ``n % size``.

    Args:
        packed: the experiment as numbers.
        work: the lane's workspace.
        before: those of the experiment so far; they stay on their way if the size is the same, or
            else an edit every few steps would keep every later torque from ever arriving.

    Returns:
        Torques in [N m], none in continuous mode. Shape (size, n).
    """
    simulation, limit = packed.experiment.simulation, packed.environment[LIMIT]
    if simulation.mode == "continuous":
        return np.empty((0, packed.joints))
    size = simulation.delay[0] + 2
    if len(before) != size:
        before = np.tile(work[TAU], (size, 1))
    bounded: Array = np.clip(before, -limit, limit)
    return bounded


def begin_drives(packed: Packed, work: Array) -> None:
    """Let drives that had no lag so far begin at the torque that they gave.

    Args:
        packed: the experiment as numbers.
        work: the lane's workspace; one without lags is left without their torques.
    """
    limit, lagging = packed.environment[LIMIT], int(packed.environment[BITS, 0]) & LAGS
    drives = work[DELIVERED : BETWEEN + 1]
    if not lagging:
        drives[:] = 0.0
    elif not drives.any():
        drives[:] = np.clip(work[TAU], -limit, limit)


def measures_apart(law: Law, packed: Packed) -> bool:
    """Tell whether a sampled law needs M and h of another arm, or of another state, than the arm.

    Args:
        law: the lane's law.
        packed: the experiment as numbers.
    """
    noisy = bool(packed.environment[SENSOR_Q, 0] or packed.environment[SENSOR_V, 0])
    return law.model_based and (noisy or packed.nominal is not None)


def sampled_step(
    law: Law, packed: Packed, gains: Array, work: Array, record: Array, commands: Array
) -> Step:
    """Return one control period of sampled mode: measure, hold the torque, step the arm."""
    simulation = packed.experiment.simulation
    substeps = simulation.plant_substeps
    truth = nominal = dynamics(packed.model, work[CURRENT + Q], work[CURRENT + V])
    apart = measures_apart(law, packed)
    if apart:
        nominal = _nominal(packed, work, MEASURED_Q, MEASURED_V)
    refill, refill_nominal = truth.refill, nominal.refill
    table = kernel_table(
        truth,
        nominal,
        gains,
        packed.environment,
        packed.trajectory,
        work,
        record,
        **law.kernels,
        step=simulation.arm_step,
        period=simulation.row_period,
        commands=commands,
        delay=simulation.delay,
    )

    look, ask, move = (for_joints(one, packed.joints) for one in (observe, sample, substep))

    def step(t: float, number: int, row: int) -> int:
        refill()
        if apart:
            look(t, number, table)
            refill_nominal()
        bad: int = ask(t, number, row, table)
        if bad:
            return checked(bad)
        for index in range(substeps):
            if index:
                refill()
            bad = move(t, number, index, table)
            if bad:
                return bad
        return 0

    return step


def bind_step(
    law: Law,
    packed: Packed,
    gains: Array,
    work: Array,
    record: Array,
    commands: Array,
    cutting: Array,
) -> Step:
    """Return the step that an experiment asks for.

    Args:
        law: the lane's law.
        packed: the experiment as numbers.
        gains: the lane's gains. Shape (m, n).
        work: the lane's workspace, which holds its state.
        record: rows to write. Shape (m, 8, n).
        commands: what ``torques_on_the_way`` returned; only sampled mode uses it.
        cutting: how far a step of continuous mode may be cut; see ``cutting_of``.

    Returns:
        ``step(t, number, row)``, which raises what the law raises.
    """
    # What another law or mode left there is not this one's.
    work[CURVE : CURVE + CURVE_ROWS] = work[S_FREE] = work[S_FALL] = 0.0
    for row in _OF_A_LAW:
        work[row] = 0.0
    work[SHAPED, 0] = work[BENDS, 0] = 0.0
    if packed.experiment.simulation.mode == "sampled":
        return sampled_step(law, packed, gains, work, record, commands)
    return continuous_step(law, packed, gains, work, record, cutting)
