"""One control step of one lane, bound to its arrays: Pinocchio, then the law's kernel.

Everything that a step needs is bound once, so that a step looks up nothing: M and h are views that
Pinocchio refills, the state is a view of the workspace.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from robot.disturbance import LIMIT, SENSOR, SENSOR_Q, SENSOR_V
from robot.laws.law import Law
from robot.packed import Packed
from robot.quantity import JOINTS
from robot.stages import FIRST, PLAIN, SECOND, observe, plant_step
from robot.workspace import APPLIED, CURRENT, HALF, MEASURED_Q, MEASURED_V, TAU, Q, V

Array = np.ndarray
Step = Callable[[float, int, int], int]
"""``step(t, number, row)``: time [s], number of the step, row to record; 0 or 1 + bad joint."""
Evaluation = tuple[Callable[[], None], Array, Array]


def _dynamics(model: pin.Model, q: Array, v: Array) -> Evaluation:
    """Return a call that refills M and h at (q, v), and their views."""
    data = model.createData()
    crba, bias = pin.crba, pin.nonLinearEffects

    def evaluate() -> None:
        crba(model, data, q)
        bias(model, data, q, v)

    return evaluate, data.M.T, data.nle


def _true_and_nominal(
    law: Law, packed: Packed, q: Array, v: Array
) -> tuple[Evaluation, Evaluation]:
    """Return the evaluation of both arms; the first refreshes both."""
    truth = _dynamics(packed.model, q, v)
    if packed.nominal is None or not law.model_based:
        return truth, truth
    belief = _dynamics(packed.nominal, q, v)
    refresh_truth, refresh_belief = truth[0], belief[0]

    def evaluate() -> None:
        refresh_truth()
        refresh_belief()

    return (evaluate, *truth[1:]), belief


def plain_step(law: Law, packed: Packed, gains: Array, work: Array, record: Array) -> Step:
    """Return the plain linearly implicit step of continuous mode."""
    h = packed.experiment.simulation.step
    world, trajectory, kernel = packed.world, packed.trajectory, law.step
    truth, belief = _true_and_nominal(law, packed, work[CURRENT + Q], work[CURRENT + V])
    evaluate, M, nle = truth
    _, nominal_M, nominal_nle = belief

    def step(t: float, number: int, row: int) -> int:
        evaluate()
        return kernel(
            PLAIN, t, h, row, M, nle, nominal_M, nominal_nle, gains, world, trajectory, work, record
        )

    return step


def extrapolated_step(law: Law, packed: Packed, gains: Array, work: Array, record: Array) -> Step:
    """Return the extrapolated step of continuous mode: what is known at t serves both sizes."""
    h = packed.experiment.simulation.step
    half = 0.5 * h
    world, trajectory, kernel = packed.world, packed.trajectory, law.step
    truth, belief = _true_and_nominal(law, packed, work[CURRENT + Q], work[CURRENT + V])
    later, later_belief = _true_and_nominal(law, packed, work[HALF + Q], work[HALF + V])
    evaluate, M, nle = truth
    evaluate_later, M2, nle2 = later
    nominal, nominal2 = belief[1:], later_belief[1:]
    nominal_M, nominal_nle = nominal
    nominal_M2, nominal_nle2 = nominal2

    def step(t: float, number: int, row: int) -> int:
        evaluate()
        bad: int = kernel(
            FIRST, t, h, row, M, nle, nominal_M, nominal_nle, gains, world, trajectory, work, record
        )
        if bad:
            return bad
        evaluate_later()
        bad = kernel(
            SECOND,
            t + half,
            h,
            row,
            M2,
            nle2,
            nominal_M2,
            nominal_nle2,
            gains,
            world,
            trajectory,
            work,
            record,
        )
        return bad

    return step


def torques_on_the_way(packed: Packed, work: Array, before: Array | None) -> Array:
    """Return the torques that wait for the input delay to pass; step ``n`` writes row ``n % size``.

    Args:
        packed: the experiment as numbers.
        work: the lane's workspace.
        before: those of the experiment so far; they stay on their way if the size is the same, or
            else an edit every few steps would keep every later torque from ever arriving.

    Returns:
        Torques in [N m], none in continuous mode. Shape (size, 6).
    """
    simulation, limit = packed.experiment.simulation, packed.world[LIMIT]
    if simulation.mode == "continuous":
        return np.empty((0, JOINTS))
    size = simulation.delay[0] + 2
    if before is None or len(before) != size:
        before = np.tile(work[TAU], (size, 1))
    bounded: Array = np.clip(before, -limit, limit)
    return bounded


def sampled_step(
    law: Law, packed: Packed, gains: Array, work: Array, record: Array, commands: Array
) -> Step:
    """Return one control period of sampled mode: measure, hold the torque, step the arm.

    A torque reaches the joints ``input_delay`` after its measurement, rounded to steps of the arm.
    """
    simulation = packed.experiment.simulation
    period, substeps = 1.0 / simulation.control_rate, simulation.plant_substeps
    h = period / substeps
    (whole, part), size = simulation.delay, len(commands)
    world, trajectory, sample = packed.world, packed.trajectory, law.sample
    refresh, M, nle = _dynamics(packed.model, work[CURRENT + Q], work[CURRENT + V])
    applied, torque = work[APPLIED], work[TAU]
    noisy = bool(world[SENSOR, SENSOR_Q] or world[SENSOR, SENSOR_V])
    believes, nominal_M, nominal_nle = (None, M, nle)
    if law.model_based and (noisy or packed.nominal is not None):
        model = packed.nominal or packed.model
        believes, nominal_M, nominal_nle = _dynamics(model, work[MEASURED_Q], work[MEASURED_V])

    def step(t: float, number: int, row: int) -> int:
        refresh()
        if believes is not None:
            observe(t, number, trajectory, world, work)
            believes()
        bad: int = sample(
            t, period, number, row, nominal_M, nominal_nle, gains, world, trajectory, work, record
        )
        if bad:
            return bad
        commands[number % size] = torque
        applied[:] = commands[(number - whole - (part > 0)) % size]
        for substep in range(substeps):
            if substep:
                refresh()
                if substep == part:
                    applied[:] = commands[(number - whole) % size]
            bad = plant_step(t + substep * h, h, M, nle, world, work)
            if bad:
                return bad
        return 0

    return step


def bind_step(
    law: Law, packed: Packed, gains: Array, work: Array, record: Array, commands: Array
) -> Step:
    """Return the step that an experiment asks for.

    Args:
        law: the lane's law.
        packed: the experiment as numbers.
        gains: the lane's gains. Shape (n, 6).
        work: the lane's workspace, which holds its state.
        record: rows to write. Shape (n, 48).
        commands: what ``torques_on_the_way`` returned; only sampled mode uses it.

    Returns:
        ``step(t, number, row)``.
    """
    simulation = packed.experiment.simulation
    if simulation.mode == "sampled":
        return sampled_step(law, packed, gains, work, record, commands)
    bind = extrapolated_step if simulation.scheme == "extrapolated" else plain_step
    return bind(law, packed, gains, work, record)
