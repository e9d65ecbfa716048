"""A lane's arrays behind one table: what is refused, and what stays alive."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import LIMIT, pack_environment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.kernel_arrays import kernel_table, law_arrays, loop_arrays, settings
from slidetune.robot.integrator.stages import FIRST
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import RECORD_COLUMNS, WORK_ROWS
from tests.robot.kernel_tables import arm_of, table_of

Array = np.ndarray


@kernel
def sums(table):  # type: ignore[no-untyped-def]
    """Return the sum and the size of every array, as a kernel sees them."""
    gains, nominal_inertia, nominal_bias, work = law_arrays(table)
    inertia, bias, environment, trajectory, _, record = loop_arrays(table)
    return (
        (inertia.sum(), inertia.size),
        (bias.sum(), bias.size),
        (nominal_inertia.sum(), nominal_inertia.size),
        (nominal_bias.sum(), nominal_bias.size),
        (gains.sum(), gains.size),
        (environment.sum(), environment.size),
        (trajectory.sum(), trajectory.size),
        (work.sum(), work.size),
        (record.sum(), record.size),
    )


@kernel
def write(table):  # type: ignore[no-untyped-def]
    """Write one number into the workspace."""
    _, _, _, work = law_arrays(table)
    work[3, 4] = 7.0


def test_a_kernel_sees_every_array_whole() -> None:
    random = np.random.default_rng(3)
    square, line = (JOINTS, JOINTS), JOINTS
    truth, nominal = (
        arm_of(random.normal(size=square), random.normal(size=line)) for _ in range(2)
    )
    environment = pack_environment(Disturbance(), 1.0, 2.0, None)
    environment[LIMIT] = 9.0
    rest = [random.normal(size=shape) for shape in ((9, JOINTS), environment.shape, 23)]
    work, record = random.normal(size=(WORK_ROWS, JOINTS)), random.normal(size=(7, RECORD_COLUMNS))
    table = kernel_table(truth, nominal, *rest, work, record, FIRST, 0.25)
    arrays = [truth.inertia, truth.bias, nominal.inertia, nominal.bias, *rest, work, record]
    for (total, size), array in zip(sums(table), arrays, strict=True):
        assert size == array.size
        assert total == pytest.approx(array.sum())
    assert settings(table) == (FIRST, 0.25, 1.0)


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
        {"record": np.zeros((5, RECORD_COLUMNS + 1))},
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
