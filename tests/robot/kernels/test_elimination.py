"""Elimination: against NumPy, with zeros on the diagonal too."""

from __future__ import annotations

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.elimination import solve, solve_symmetric
from slidetune.robot.kernels.workspace import MATRIX, RIGHT, WORK_ROWS

Array = np.ndarray


def test_any_system_is_solved_whatever_stands_on_its_diagonal() -> None:
    random = np.random.default_rng(1)
    for turn in range(200):
        matrix, right = random.normal(size=(JOINTS, JOINTS)), random.normal(size=JOINTS)
        if turn % 2:
            np.fill_diagonal(matrix, 0.0)
        work = np.zeros((WORK_ROWS, JOINTS))
        work[MATRIX : MATRIX + JOINTS], work[RIGHT] = matrix, right
        solve(work)
        expected = np.linalg.solve(matrix, right)
        np.testing.assert_allclose(work[RIGHT], expected, atol=1e-11 * np.linalg.cond(matrix))


def test_the_upper_triangle_of_an_inertia_is_enough() -> None:
    random = np.random.default_rng(2)
    for _ in range(100):
        root = random.normal(size=(JOINTS, JOINTS))
        matrix, right = root @ root.T + 0.1 * np.eye(JOINTS), random.normal(size=JOINTS)
        work = np.full((WORK_ROWS, JOINTS), np.nan)
        work[MATRIX : MATRIX + JOINTS] = matrix
        work[MATRIX : MATRIX + JOINTS][np.tril_indices(JOINTS, -1)] = np.nan
        work[RIGHT] = right
        solve_symmetric(work)
        np.testing.assert_allclose(work[RIGHT], np.linalg.solve(matrix, right), rtol=1e-7)
