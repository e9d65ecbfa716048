"""One control step of one lane, bound to its arrays: Pinocchio, then the law's kernel.

Everything that a step needs is bound once, so that a step looks up nothing: M and h are views that
Pinocchio refills, the state is a view of the workspace, and a kernel takes all of it as one number.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.environment.layout import LIMIT, SENSOR, SENSOR_Q, SENSOR_V
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.cutting import Cutting, Parts, Step
from slidetune.robot.integrator.kernel_arrays import STEP, TOLERANCE, kernel_table
from slidetune.robot.integrator.stages import FIRST, PLAIN, SECOND, observe, plant_step
from slidetune.robot.kernels.workspace import (
    APPLIED,
    CURRENT,
    CURVE,
    CURVE_ROWS,
    HALF,
    MEASURED_Q,
    MEASURED_V,
    S_FALL,
    S_FREE,
    TAU,
    Q,
    V,
)
from slidetune.robot.laws.law import Law

Array = np.ndarray


class Stage(NamedTuple):
    """One stage of a step of continuous mode.

    Attributes:
        arm: what Pinocchio takes before the state: the arm and what it writes.
        q: joint angles of the stage in [rad], a view. Shape (6,).
        v: joint velocities of the stage in [rad/s], a view. Shape (6,).
        refill_nominal: lets Pinocchio write the nominal arm anew, where there is another one.
        table: what the kernel takes.
    """

    arm: tuple[pin.Model, pin.Data]
    q: Array
    v: Array
    refill_nominal: Callable[[], None] | None
    table: Array


def _stage(
    stage: int, state: int, law: Law, packed: Packed, gains: Array, work: Array, record: Array
) -> Stage:
    """Return a stage at the state whose first row is ``state``."""
    q, v = work[state + Q], work[state + V]
    truth = nominal = dynamics(packed.model, q, v)
    if law.model_based and packed.nominal is not None:
        nominal = dynamics(packed.nominal, q, v)
    arrays = (truth, nominal, gains, packed.environment, packed.trajectory, work, record)
    table = kernel_table(*arrays, stage=stage, step=packed.experiment.simulation.step)
    refill_nominal = None if nominal is truth else nominal.refill
    return Stage((truth.model, truth.data), q, v, refill_nominal, table)


def plain_step(
    law: Law, packed: Packed, gains: Array, work: Array, record: Array, cutting: Cutting
) -> Step:
    """Return the plain implicit step of continuous mode."""
    kernel, crba, bias = law.step, pin.crba, pin.nonLinearEffects
    (arm, data), q, v, refill_nominal, table = _stage(
        PLAIN, CURRENT, law, packed, gains, work, record
    )
    numbers = table.view(np.float64)

    def settle(h: float, tolerance: float) -> None:
        numbers[STEP], numbers[TOLERANCE] = h, tolerance

    def bound(parts: Callable[[float, int], int] | None) -> Step:
        def step(t: float, number: int, row: int) -> int:
            crba(arm, data, q)
            bias(arm, data, q, v)
            if refill_nominal is not None:
                refill_nominal()
            bad = kernel(t, row, table)
            return parts(t, row) if bad and parts else bad

        return step

    h = packed.experiment.simulation.step
    return bound(Parts(settle, bound(None), h, cutting, work).make)


def extrapolated_step(
    law: Law, packed: Packed, gains: Array, work: Array, record: Array, cutting: Cutting
) -> Step:
    """Return the extrapolated step of continuous mode: what is known at t serves both sizes."""
    kernel, crba, bias = law.step, pin.crba, pin.nonLinearEffects
    (arm, data), q, v, refill_nominal, first = _stage(
        FIRST, CURRENT, law, packed, gains, work, record
    )
    later = _stage(SECOND, HALF, law, packed, gains, work, record)
    (_, data2), q2, v2, refill_nominal2, second = later
    numbers, numbers2 = first.view(np.float64), second.view(np.float64)
    half = 0.0

    def settle(h: float, tolerance: float) -> None:
        nonlocal half
        half = 0.5 * h
        numbers[STEP] = numbers2[STEP] = h
        numbers[TOLERANCE] = numbers2[TOLERANCE] = tolerance

    def bound(parts: Callable[[float, int], int] | None) -> Step:
        def step(t: float, number: int, row: int) -> int:
            crba(arm, data, q)
            bias(arm, data, q, v)
            if refill_nominal is not None:
                refill_nominal()
            bad = kernel(t, row, first)
            if not bad:
                crba(arm, data2, q2)
                bias(arm, data2, q2, v2)
                if refill_nominal2 is not None:
                    refill_nominal2()
                bad = kernel(t + half, row, second)
            return parts(t, row) if bad and parts else bad

        return step

    h = packed.experiment.simulation.step
    return bound(Parts(settle, bound(None), h, cutting, work).make)


def torques_on_the_way(packed: Packed, work: Array, before: Array) -> Array:
    """Return the torques that wait for the input delay to pass; step ``n`` writes row ``n % size``.

    Args:
        packed: the experiment as numbers.
        work: the lane's workspace.
        before: those of the experiment so far; they stay on their way if the size is the same, or
            else an edit every few steps would keep every later torque from ever arriving.

    Returns:
        Torques in [N m], none in continuous mode. Shape (size, 6).
    """
    simulation, limit = packed.experiment.simulation, packed.environment[LIMIT]
    if simulation.mode == "continuous":
        return np.empty((0, JOINTS))
    size = simulation.delay[0] + 2
    if len(before) != size:
        before = np.tile(work[TAU], (size, 1))
    bounded: Array = np.clip(before, -limit, limit)
    return bounded


def sampled_step(
    law: Law, packed: Packed, gains: Array, work: Array, record: Array, commands: Array
) -> Step:
    """Return one control period of sampled mode: measure, hold the torque, step the arm.

    A torque reaches the joints ``input_delay`` after its measurement. Where that is within a step
    of the arm, the step is made under the mean of both torques: their impulse is exact, and what
    the angle lacks is of the step's own order.
    """
    simulation = packed.experiment.simulation
    period, substeps = 1.0 / simulation.control_rate, simulation.plant_substeps
    h = period / substeps
    (whole, part), size = simulation.delay, len(commands)
    split, arrived, share = int(part), ceil(part), ceil(part) - part
    sample = law.sample
    truth = dynamics(packed.model, work[CURRENT + Q], work[CURRENT + V])
    refill, applied, torque = truth.refill, work[APPLIED], work[TAU]
    noisy = bool(packed.environment[SENSOR, SENSOR_Q] or packed.environment[SENSOR, SENSOR_V])
    nominal = None
    if law.model_based and (noisy or packed.nominal is not None):
        nominal = dynamics(packed.nominal or packed.model, work[MEASURED_Q], work[MEASURED_V])
    rest = (gains, packed.environment, packed.trajectory, work, record)
    controller = kernel_table(truth, nominal or truth, *rest, step=period)
    arm = kernel_table(truth, truth, *rest, step=h)

    def step(t: float, number: int, row: int) -> int:
        refill()
        if nominal is not None:
            observe(t, number, controller)
            nominal.refill()
        bad: int = sample(t, number, row, controller)
        if bad:
            return bad
        commands[number % size] = torque
        new = commands[(number - whole) % size]
        applied[:] = commands[(number - whole - 1) % size]
        for substep in range(substeps):
            if substep:
                refill()
            if substep <= arrived:
                if substep == arrived:
                    applied[:] = new
                elif substep == split:
                    applied[:] += share * (new - applied)
            bad = plant_step(t + substep * h, arm)
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
    cutting: Cutting,
) -> Step:
    """Return the step that an experiment asks for.

    Args:
        law: the lane's law.
        packed: the experiment as numbers.
        gains: the lane's gains. Shape (n, 6).
        work: the lane's workspace, which holds its state.
        record: rows to write. Shape (n, 48).
        commands: what ``torques_on_the_way`` returned; only sampled mode uses it.
        cutting: how far a step of continuous mode may be cut.

    Returns:
        ``step(t, number, row)``.
    """
    simulation = packed.experiment.simulation
    # What another law or mode left there is not this one's.
    work[CURVE : CURVE + CURVE_ROWS] = work[S_FREE] = work[S_FALL] = 0.0
    if simulation.mode == "sampled":
        return sampled_step(law, packed, gains, work, record, commands)
    bind = extrapolated_step if simulation.scheme == "extrapolated" else plain_step
    return bind(law, packed, gains, work, record, cutting)
