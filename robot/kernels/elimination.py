"""Elimination of a system of six, in place in the workspace.

A symmetric matrix is an inertia plus a positive diagonal and needs no pivots. Others may have a
zero on their diagonal: a joint at its torque limit that is held on its surface.
"""

from __future__ import annotations

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import MATRIX, RIGHT


@kernel
def solve(work):  # type: ignore[no-untyped-def]
    """Solve MATRIX x = RIGHT, in place; the answer stands in RIGHT, NaN if there is none."""
    for k in range(JOINTS - 1):
        _pivot(k, work)
        inverse = 1.0 / work[MATRIX + k, k]
        for i in range(k + 1, JOINTS):
            factor = work[MATRIX + i, k] * inverse
            for j in range(k + 1, JOINTS):
                work[MATRIX + i, j] -= factor * work[MATRIX + k, j]
            work[RIGHT, i] -= factor * work[RIGHT, k]
    _substitute(work)


@kernel
def _pivot(k, work):  # type: ignore[no-untyped-def]
    """Bring the row with the greatest number in column ``k`` to row ``k``."""
    best = k
    for i in range(k + 1, JOINTS):
        if abs(work[MATRIX + i, k]) > abs(work[MATRIX + best, k]):
            best = i
    if best != k:
        for j in range(k, JOINTS):
            swap = work[MATRIX + k, j]
            work[MATRIX + k, j], work[MATRIX + best, j] = work[MATRIX + best, j], swap
        swap = work[RIGHT, k]
        work[RIGHT, k], work[RIGHT, best] = work[RIGHT, best], swap


@inlined
def solve_symmetric(work):  # type: ignore[no-untyped-def]
    """Do the same with the upper triangle of a symmetric MATRIX alone: half the work."""
    for k in range(JOINTS - 1):
        inverse = 1.0 / work[MATRIX + k, k]
        for i in range(k + 1, JOINTS):
            factor = work[MATRIX + k, i] * inverse
            for j in range(i, JOINTS):
                work[MATRIX + i, j] -= factor * work[MATRIX + k, j]
            work[RIGHT, i] -= factor * work[RIGHT, k]
    _substitute(work)


@inlined
def _substitute(work):  # type: ignore[no-untyped-def]
    """Substitute back from the last row to the first."""
    for i in range(JOINTS - 1, -1, -1):
        total = work[RIGHT, i]
        for j in range(i + 1, JOINTS):
            total -= work[MATRIX + i, j] * work[RIGHT, j]
        work[RIGHT, i] = total / work[MATRIX + i, i]
