"""Kernels for other numbers of joints: what they are compiled from, and that it is used whole."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from slidetune.robot.fields.quantity import JOINTS, MOST_JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.elimination import solve
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import MATRIX, RIGHT, WORK_ROWS

CONSTANTS = """
import sys
import slidetune.robot.fields.quantity as quantity
quantity.JOINTS = int(sys.argv[1])
from slidetune.robot.kernels import compiler
from slidetune.robot.loop import simulate
for one in compiler._compilers:
    source = one.py_func
    for name in sorted(source.__code__.co_names):
        value = source.__globals__.get(name)
        if isinstance(value, int | float | tuple) and name != "JOINTS":
            print(source.__module__, source.__qualname__, name, value)
"""


def constants(joints: int) -> list[str]:
    """Return every constant that a kernel reads, in a process of an arm of so many joints."""
    command = [sys.executable, "-c", CONSTANTS, str(joints)]
    root = Path(__file__).parents[3]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root)
    return done.stdout.splitlines()


def test_no_constant_of_a_kernel_depends_on_the_number_of_joints_but_that_itself() -> None:
    shipped, other = constants(JOINTS), constants(7)
    assert len(shipped) > 200
    assert shipped == other


@pytest.mark.parametrize("joints", [1, 2, JOINTS, 7, MOST_JOINTS])
def test_a_system_of_any_size_is_solved(joints: int) -> None:
    random = np.random.default_rng(joints)
    for _ in range(20):
        matrix, right = random.normal(size=(joints, joints)), random.normal(size=joints)
        work = np.zeros((WORK_ROWS, joints))
        work[MATRIX : MATRIX + joints], work[RIGHT] = matrix, right
        for_joints(solve, joints)(work)
        assert np.abs(matrix @ work[RIGHT] - right).max() < 1e-9 * np.linalg.cond(matrix)


def test_it_is_the_same_one_each_time_and_the_shipped_one_itself() -> None:
    assert for_joints(solve, JOINTS) is solve
    assert for_joints(solve, 7) is for_joints(solve, 7)
    assert for_joints(solve, 7) is not for_joints(solve, 2)


def test_what_is_no_kernel_stays_what_it_is() -> None:
    assert for_joints(constants, 7) is constants
    assert for_joints(None, 7) is None


@kernel
def _counted(work):  # type: ignore[no-untyped-def]
    return _also_counted(work) + JOINTS


@kernel
def _also_counted(work):  # type: ignore[no-untyped-def]
    return 100 * JOINTS


def test_a_kernel_calls_those_for_its_own_number_also_when_they_come_later() -> None:
    assert [for_joints(_counted, n)(np.zeros(1)) for n in (1, JOINTS, 9)] == [101, 606, 909]
