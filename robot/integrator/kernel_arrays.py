"""Everything that a lane's kernels work on, as the one array that they take.

A numba call pays some 50 ns for every array that it is given, which for nine of them is half the
cost of a control law. So the addresses of a lane's arrays stand in one table, written when the
lane is bound, and a kernel takes that table.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from slidetune.robot.arm.dynamics import ChainDynamics, Dynamics
from slidetune.robot.arm.recursion import CHAIN_COLUMNS, SCRATCH_COLUMNS, chain_dynamics
from slidetune.robot.environment.layout import ENVIRONMENT_ROWS
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.law_call import (
    Advance,
    Control,
    advance_callback,
    call_advance,
    call_advance_back,
    call_back,
    call_law,
    callback,
    compiled_advance,
    compiled_law,
)
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.known_shape import as_floats
from slidetune.robot.kernels.workspace import RECORD as GROUPS
from slidetune.robot.kernels.workspace import WORK_ROWS, Q, V

Array = np.ndarray

# Addresses.
INERTIA, BIAS, NOMINAL_INERTIA, NOMINAL_BIAS, GAINS, ENVIRONMENT, TRAJECTORY, WORK, RECORD = range(
    9
)
COMMANDS, CHAIN, NOMINAL_CHAIN, SCRATCH, COMPILED_LAW, LAW_CALLBACK, ADVANCE = range(9, 16)
# Whether ADVANCE is called back; whether the state holds weights of a network.
ADVANCE_IS_CALLBACK, HAS_WEIGHTS = range(16, 18)
# Sizes, and the whole substeps of the input delay.
TRAJECTORY_SIZE, GAIN_ROWS, RECORD_ROWS, COMMAND_ROWS, DELAY_PERIODS = range(18, 23)
# Numbers as float64.
STEP, PERIOD, TOLERANCE, DELAY_SUBSTEPS = range(23, 27)
SIZE = 27


class _Kept:
    """Memory of a table: as the base of its array it keeps the lane's arrays alive."""

    def __init__(self, table: Array, *owners: object) -> None:
        self.__array_interface__ = table.__array_interface__
        self._alive = table, owners


def kernel_table(
    truth: Dynamics | ChainDynamics,
    nominal: Dynamics | ChainDynamics,
    gains: Array,
    environment: Array,
    trajectory: Array,
    work: Array,
    record: Array,
    control: Control | None = None,
    advance: Advance | None = None,
    network: bool = True,
    step: float = 0.0,
    period: float = 0.0,
    commands: Array | None = None,
    delay: tuple[int, float] = (0, 0.0),
) -> Array:
    """Return the table of a lane's arrays; they live as long as it does.

    Args:
        truth: the true arm.
        nominal: the nominal arm of a model-based law.
        gains: numbers of the lane's law. Shape (m, n).
        environment: what ``pack_environment`` returned.
        trajectory: what ``pack_trajectory`` returned. Shape (m,).
        work: the lane's workspace.
        record: rows to write. Shape (k, 8, n).
        control: the lane's law; ``None`` for kernels that do without.
        advance: what moves its memory on; ``None`` where it has none.
        network: whether the rows W of the state may hold weights: they are recorded as such.
        step: step of the arm in [s]. It and TOLERANCE, how many times its tolerance the error of a
            step may be, can be changed in the table.
        period: control period of sampled mode in [s].
        commands: memory for the torques that wait for the input delay to pass. Shape (k, n).
        delay: the input delay: control periods, and steps of the arm.

    Raises:
        ValueError: if an array is not one block of float64, or has another shape.
    """
    joints = len(truth.bias)
    square, line = (joints, joints), (joints,)
    commands = np.empty((0, joints)) if commands is None else commands
    shaped = (
        (truth.inertia, square),
        (truth.bias, line),
        (nominal.inertia, square),
        (nominal.bias, line),
        (gains, (len(gains), joints)),
        (environment, (ENVIRONMENT_ROWS, joints)),
        (trajectory, (len(trajectory),)),
        (work, (WORK_ROWS, joints)),
        (record, (len(record), len(GROUPS), joints)),
        (commands, (len(commands), joints)),
    )
    for array, shape in shaped:
        if array.shape != shape or array.dtype != np.float64 or not array.flags.c_contiguous:
            raise ValueError(
                f"a kernel takes one block of float64 of shape {shape}, "
                f"got {array.dtype} of shape {array.shape}"
            )
    arrays = [array for array, _ in shaped]
    table = np.zeros(SIZE, np.int64)
    table[: len(arrays)] = [array.ctypes.data for array in arrays]
    table[TRAJECTORY_SIZE], table[GAIN_ROWS] = len(trajectory), len(gains)
    table[RECORD_ROWS], table[COMMAND_ROWS] = len(record), len(commands)
    numbers = table.view(np.float64)
    numbers[STEP], numbers[PERIOD], numbers[TOLERANCE] = step, period, 1.0
    table[DELAY_PERIODS], numbers[DELAY_SUBSTEPS] = delay
    if isinstance(truth, ChainDynamics):
        table[CHAIN], table[SCRATCH] = truth.chain.ctypes.data, truth.scratch.ctypes.data
    if isinstance(nominal, ChainDynamics) and nominal is not truth:
        table[NOMINAL_CHAIN] = nominal.chain.ctypes.data
    called, called_after = None, None
    if control is not None:
        control = for_joints(control, joints)
        table[COMPILED_LAW] = compiled_law(control)
        if not table[COMPILED_LAW]:
            called = callback(control, gains, nominal.inertia, nominal.bias, work)
            table[LAW_CALLBACK] = ctypes.cast(called, ctypes.c_void_p).value or 0
    if advance is not None:
        advance = for_joints(advance, joints)
        table[ADVANCE] = compiled_advance(advance)
        if not table[ADVANCE]:
            called_after = advance_callback(advance, gains, nominal.inertia, nominal.bias, work)
            table[ADVANCE] = ctypes.cast(called_after, ctypes.c_void_p).value or 0
            table[ADVANCE_IS_CALLBACK] = 1
    table[HAS_WEIGHTS] = network
    # Pinocchio's own memory goes with its data, which the dynamics hold.
    return np.asarray(_Kept(table, arrays, truth, nominal, control, called, advance, called_after))


def _as_pointer(_context: Any, address: Any) -> Any:
    def build(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(address), build


_pointer: Any = intrinsic(_as_pointer)
"""Takes a number for an address, in a kernel."""


@inlined
def settings(table):  # type: ignore[no-untyped-def]
    """Return step [s], control period [s] and tolerance of a table."""
    numbers = as_floats(table)
    return numbers[STEP], numbers[PERIOD], numbers[TOLERANCE]


@inlined
def loop_arrays(table):  # type: ignore[no-untyped-def]
    """Return what surrounds a law: inertia, bias, environment, trajectory, workspace, record."""
    return (
        carray(_pointer(table[INERTIA]), (JOINTS, JOINTS), np.float64),
        carray(_pointer(table[BIAS]), (JOINTS,), np.float64),
        carray(_pointer(table[ENVIRONMENT]), (ENVIRONMENT_ROWS, JOINTS), np.float64),
        carray(_pointer(table[TRAJECTORY]), (table[TRAJECTORY_SIZE],), np.float64),
        carray(_pointer(table[WORK]), (WORK_ROWS, JOINTS), np.float64),
        carray(_pointer(table[RECORD]), (table[RECORD_ROWS], len(GROUPS), JOINTS), np.float64),
    )


@inlined
def delay_line(table):  # type: ignore[no-untyped-def]
    """Return the torques on their way, and the input delay: control periods, steps of the arm."""
    commands = carray(_pointer(table[COMMANDS]), (table[COMMAND_ROWS], JOINTS), np.float64)
    return commands, table[DELAY_PERIODS], as_floats(table)[DELAY_SUBSTEPS]


@kernel
def ask(state, table):  # type: ignore[no-untyped-def]
    """Let the table's law write its torque to TAU [N m].

    Args:
        state: first row of the state whose weights count.
        table: the lane's table.

    Returns:
        0, or RAISED.
    """
    if table[COMPILED_LAW] == 0:
        return call_back(table[LAW_CALLBACK], state)
    gains = carray(_pointer(table[GAINS]), (table[GAIN_ROWS], JOINTS), np.float64)
    nominal_M = carray(_pointer(table[NOMINAL_INERTIA]), (JOINTS, JOINTS), np.float64)
    nominal_nle = carray(_pointer(table[NOMINAL_BIAS]), (JOINTS,), np.float64)
    work = carray(_pointer(table[WORK]), (WORK_ROWS, JOINTS), np.float64)
    call_law(table[COMPILED_LAW], state, gains, nominal_M, nominal_nle, work)
    return 0


@kernel
def move_memory(h, state, into, table):  # type: ignore[no-untyped-def]
    """Let the table's law move its memory on, where it has one.

    Args:
        h: step or control period in [s].
        state: first row of the state from which the step started.
        into: first row of the state after it; it may be the same.
        table: the lane's table.

    Returns:
        0, or RAISED.
    """
    if table[ADVANCE] == 0:
        return 0
    if table[ADVANCE_IS_CALLBACK] != 0:
        return call_advance_back(table[ADVANCE], h, state, into)
    gains = carray(_pointer(table[GAINS]), (table[GAIN_ROWS], JOINTS), np.float64)
    nominal_M = carray(_pointer(table[NOMINAL_INERTIA]), (JOINTS, JOINTS), np.float64)
    nominal_nle = carray(_pointer(table[NOMINAL_BIAS]), (JOINTS,), np.float64)
    work = carray(_pointer(table[WORK]), (WORK_ROWS, JOINTS), np.float64)
    call_advance(table[ADVANCE], h, state, into, gains, nominal_M, nominal_nle, work)
    return 0


@kernel
def evaluate_arm(state, table):  # type: ignore[no-untyped-def]
    """Write M and h of the true arm at the state whose first row is ``state``, by its chain."""
    chain = carray(_pointer(table[CHAIN]), (JOINTS + 1, CHAIN_COLUMNS), np.float64)
    scratch = carray(_pointer(table[SCRATCH]), (JOINTS, SCRATCH_COLUMNS), np.float64)
    inertia = carray(_pointer(table[INERTIA]), (JOINTS, JOINTS), np.float64)
    bias = carray(_pointer(table[BIAS]), (JOINTS,), np.float64)
    work = carray(_pointer(table[WORK]), (WORK_ROWS, JOINTS), np.float64)
    chain_dynamics(chain, work[state + Q], work[state + V], inertia, bias, scratch)


@kernel
def evaluate_nominal(angles, velocities, table):  # type: ignore[no-untyped-def]
    """Write M and h of the nominal arm, where that is another one, at two rows of the workspace."""
    if table[NOMINAL_CHAIN] != 0:
        chain = carray(_pointer(table[NOMINAL_CHAIN]), (JOINTS + 1, CHAIN_COLUMNS), np.float64)
        scratch = carray(_pointer(table[SCRATCH]), (JOINTS, SCRATCH_COLUMNS), np.float64)
        inertia = carray(_pointer(table[NOMINAL_INERTIA]), (JOINTS, JOINTS), np.float64)
        bias = carray(_pointer(table[NOMINAL_BIAS]), (JOINTS,), np.float64)
        work = carray(_pointer(table[WORK]), (WORK_ROWS, JOINTS), np.float64)
        chain_dynamics(chain, work[angles], work[velocities], inertia, bias, scratch)
