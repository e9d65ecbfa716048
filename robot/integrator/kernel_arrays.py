"""Everything that a lane's kernels work on, as the one array that they take.

A numba call pays some 50 ns for every array that it is given, which for nine of them is half the
cost of a control law. So the addresses of a lane's arrays stand in one table, written when the
lane is bound, and a kernel takes that table.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.numpy_support import carray

from slidetune.robot.arm.dynamics import Dynamics
from slidetune.robot.environment.layout import SENSOR
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import RECORD_COLUMNS, WORK_ROWS

Array = np.ndarray

INERTIA, BIAS, NOMINAL_INERTIA, NOMINAL_BIAS, GAINS, ENVIRONMENT, TRAJECTORY, WORK, RECORD = range(
    9
)
STAGE, STEP, TOLERANCE, TRAJECTORY_SIZE, GAIN_ROWS, RECORD_ROWS, SIZE = range(9, 16)
ENVIRONMENT_SHAPE = (SENSOR + 1, JOINTS)


class _Kept:
    """Memory of a table: as the base of its array it keeps the lane's arrays alive."""

    def __init__(self, table: Array, *owners: object) -> None:
        self.__array_interface__ = table.__array_interface__
        self._alive = table, owners


def kernel_table(
    truth: Dynamics,
    nominal: Dynamics,
    gains: Array,
    environment: Array,
    trajectory: Array,
    work: Array,
    record: Array,
    stage: int = 0,
    step: float = 0.0,
) -> Array:
    """Return the table of a lane's arrays; they live as long as it does.

    Args:
        truth: the true arm.
        nominal: the nominal arm of a model-based law.
        gains: numbers of the lane's law. Shape (n, 6).
        environment: what ``pack_environment`` returned.
        trajectory: what ``pack_trajectory`` returned. Shape (m,).
        work: the lane's workspace.
        record: rows to write. Shape (k, 48).
        stage: what a kernel of continuous mode is asked for; see ``robot.integrator.stages``.
        step: step or control period in [s]. It and TOLERANCE, how many times its tolerance the
            error of a step may be, can be changed in the table.

    Raises:
        ValueError: if an array is not one block of float64, or has another shape.
    """
    square, line = (JOINTS, JOINTS), (JOINTS,)
    shaped = (
        (truth.inertia, square),
        (truth.bias, line),
        (nominal.inertia, square),
        (nominal.bias, line),
        (gains, (len(gains), JOINTS)),
        (environment, ENVIRONMENT_SHAPE),
        (trajectory, (len(trajectory),)),
        (work, (WORK_ROWS, JOINTS)),
        (record, (len(record), RECORD_COLUMNS)),
    )
    for array, shape in shaped:
        if array.shape != shape or array.dtype != np.float64 or not array.flags.c_contiguous:
            raise ValueError(
                f"a kernel takes one block of float64 of shape {shape}, "
                f"got {array.dtype} of shape {array.shape}"
            )
    arrays = [array for array, _ in shaped]
    table = np.zeros(SIZE, np.int64)
    table[:STAGE] = [array.ctypes.data for array in arrays]
    table[STAGE], table[TRAJECTORY_SIZE] = stage, len(trajectory)
    table[GAIN_ROWS], table[RECORD_ROWS] = len(gains), len(record)
    table.view(np.float64)[STEP] = step
    table.view(np.float64)[TOLERANCE] = 1.0
    # Pinocchio's own memory goes with its data, which the dynamics hold.
    return np.asarray(_Kept(table, arrays, truth, nominal))


def _as_pointer(_context: Any, address: Any) -> Any:
    def build(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(address), build


_pointer: Any = intrinsic(_as_pointer)
"""Takes a number for an address, in a kernel."""


@kernel
def settings(table):  # type: ignore[no-untyped-def]
    """Return the stage, the step [s] and the tolerance of a table."""
    numbers = table.view(np.float64)
    return table[STAGE], numbers[STEP], numbers[TOLERANCE]


@kernel
def law_arrays(table):  # type: ignore[no-untyped-def]
    """Return what a law asks for: gains, nominal inertia, nominal bias, workspace."""
    return (
        carray(_pointer(table[GAINS]), (table[GAIN_ROWS], JOINTS), np.float64),
        carray(_pointer(table[NOMINAL_INERTIA]), (JOINTS, JOINTS), np.float64),
        carray(_pointer(table[NOMINAL_BIAS]), (JOINTS,), np.float64),
        carray(_pointer(table[WORK]), (WORK_ROWS, JOINTS), np.float64),
    )


@kernel
def loop_arrays(table):  # type: ignore[no-untyped-def]
    """Return what surrounds a law: inertia, bias, environment, trajectory, workspace, record."""
    return (
        carray(_pointer(table[INERTIA]), (JOINTS, JOINTS), np.float64),
        carray(_pointer(table[BIAS]), (JOINTS,), np.float64),
        carray(_pointer(table[ENVIRONMENT]), ENVIRONMENT_SHAPE, np.float64),
        carray(_pointer(table[TRAJECTORY]), (table[TRAJECTORY_SIZE],), np.float64),
        carray(_pointer(table[WORK]), (WORK_ROWS, JOINTS), np.float64),
        carray(_pointer(table[RECORD]), (table[RECORD_ROWS], RECORD_COLUMNS), np.float64),
    )
