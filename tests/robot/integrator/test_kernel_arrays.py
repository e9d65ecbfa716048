"""A lane's arrays behind one table: what is refused, and what stays alive."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import numba
import numpy as np
import pytest

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import LIMIT, pack_environment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.kernel_arrays import (
    ask,
    delay_line,
    kernel_table,
    loop_arrays,
    settings,
)
from slidetune.robot.integrator.law_call import checked
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import RECORD, TAU, WORK_ROWS
from tests.robot.kernel_tables import arm_of, table_of

Array = np.ndarray


@kernel
def sums(table):  # type: ignore[no-untyped-def]
    """Return the sum and the size of every array, as the loop's kernels see them."""
    inertia, bias, environment, trajectory, work, record = loop_arrays(table)
    commands, _, _ = delay_line(table)
    return (
        (inertia.sum(), inertia.size),
        (bias.sum(), bias.size),
        (environment.sum(), environment.size),
        (trajectory.sum(), trajectory.size),
        (work.sum(), work.size),
        (record.sum(), record.size),
        (commands.sum(), commands.size),
    )


@kernel
def write(table):  # type: ignore[no-untyped-def]
    """Write one number into the workspace."""
    _, _, _, _, work, _ = loop_arrays(table)
    work[3, 4] = 7.0


def test_a_kernel_sees_every_array_whole() -> None:
    random = np.random.default_rng(3)
    square, line = (JOINTS, JOINTS), JOINTS
    truth, nominal = (
        arm_of(random.normal(size=square), random.normal(size=line)) for _ in range(2)
    )
    environment = pack_environment(Disturbance(), 1.0, 2.0, None)
    environment[LIMIT] = 9.0
    gains, trajectory = random.normal(size=(9, JOINTS)), random.normal(size=23)
    work, record = (
        random.normal(size=(WORK_ROWS, JOINTS)),
        random.normal(size=(7, len(RECORD), JOINTS)),
    )
    commands = random.normal(size=(3, JOINTS))
    rest = (gains, environment, trajectory, work, record)
    asked: list[list[Array]] = []

    def control(state: int, *given: Array) -> None:
        asked.append([array.copy() for array in given])

    table = kernel_table(
        truth, nominal, *rest, control=control, step=0.25, period=2.5, commands=commands
    )
    arrays = [truth.inertia, truth.bias, environment, trajectory, work, record, commands]
    for (total, size), array in zip(sums(table), arrays, strict=True):
        assert size == array.size
        assert total == pytest.approx(array.sum())
    assert settings(table) == (0.25, 2.5, 1.0)
    assert ask(0, table) == 0
    # The law gets the nominal arm.
    for found, array in zip(asked[0], (gains, *nominal[-2:], work), strict=True):
        np.testing.assert_array_equal(found, array)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_law_gets_its_own_arrays_and_what_it_raises_comes_out(compiled: bool) -> None:
    @numba.njit
    def raising(state, gains, _M, _nle, work):  # type: ignore[no-untyped-def]
        work[TAU, 0] = gains[0, 0] + state
        if gains[0, 0] > 1.0:
            raise ArithmeticError("too much")

    control: Any = raising if compiled else raising.py_func
    work = np.zeros((WORK_ROWS, JOINTS))
    assert ask(2, table_of(work, gains=np.ones((1, JOINTS)), control=control)) == 0
    assert work[TAU, 0] == 3.0
    table = table_of(work, gains=2.0 * np.ones((1, JOINTS)), control=control)
    with pytest.raises(ArithmeticError, match="too much"):
        checked(ask(0, table))


def test_what_a_kernel_writes_is_in_the_array() -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    table = table_of(work)
    write(table)
    assert work[3, 4] == 7.0
    assert work.sum() == 7.0


def test_arrays_live_as_long_as_their_wiring() -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    alive, table = weakref.ref(work), table_of(work)
    del work
    gc.collect()
    assert alive() is not None
    write(table)
    del table
    gc.collect()
    assert alive() is None


@pytest.mark.parametrize(
    "wrong",
    [
        {"work": np.zeros((WORK_ROWS - 1, JOINTS))},
        {"work": np.zeros((WORK_ROWS, JOINTS), np.float32)},
        {"work": np.zeros((WORK_ROWS, 2 * JOINTS))[:, ::2]},
        {"record": np.zeros((5, len(RECORD) + 1, JOINTS))},
        {"gains": np.zeros((4, JOINTS - 1))},
        {"environment": np.zeros((3, JOINTS))},
        {"trajectory": np.zeros((4, 2))},
        {"arm": arm_of(np.zeros((JOINTS, JOINTS - 1)), np.zeros(JOINTS))},
        {"arm": arm_of(np.eye(JOINTS), np.zeros(JOINTS - 1))},
    ],
)
def test_what_a_kernel_would_misread_is_refused(wrong: dict[str, Array]) -> None:
    with pytest.raises(ValueError, match="one block of float64 of shape"):
        table_of(**wrong)
