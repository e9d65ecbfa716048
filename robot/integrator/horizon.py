"""All steps of a lane in one call, with M and h of its chain: no border to Python is crossed.

The live session makes the same stages one by one, with M and h of Pinocchio; see
``robot.loop.steps``.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.extending import intrinsic

from slidetune.robot.integrator.cutting import (
    FROM,
    NO_ROW,
    RESULT,
    begin_parts,
    end_part,
    next_part,
)
from slidetune.robot.integrator.kernel_arrays import (
    NOMINAL_CHAIN,
    STEP,
    evaluate_arm,
    evaluate_nominal,
    settings,
)
from slidetune.robot.integrator.law_call import RAISED
from slidetune.robot.integrator.stages import FIRST, SECOND, observe, sample, substep
from slidetune.robot.kernels.by_address import called
from slidetune.robot.kernels.compiler import kernel, released
from slidetune.robot.kernels.known_shape import as_floats
from slidetune.robot.kernels.workspace import CURRENT, HALF, MEASURED_Q, MEASURED_V, Q, V

STOPPED = -4
"""What a run returns that was stopped."""
STAGE = types.int64(types.int64, types.float64, types.int64, types.int64[::1])
"""Signature of ``make_stage``."""


def _stage(_context: Any, address: Any, stage: Any, t: Any, row: Any, table: Any) -> Any:
    return called(STAGE)


_make_stage: Any = intrinsic(_stage)


@kernel
def _attempt(stage, first, t, row, table):  # type: ignore[no-untyped-def]
    """Make one step of continuous mode of the table's length from the current state."""
    state = CURRENT
    while True:
        evaluate_arm(state, table)
        evaluate_nominal(state + Q, state + V, table)
        bad = _make_stage(stage, first, t, row, table)
        if bad != 0 or first != FIRST:
            return bad
        first, state, t = SECOND, HALF, t + 0.5 * as_floats(table)[STEP]


@released
def run_continuous(stage, first, rows, stop, cutting, table):  # type: ignore[no-untyped-def]
    """Make rows of the record in continuous mode, one after the other.

    Args:
        stage: address of ``make_stage``.
        first: PLAIN, or FIRST for the extrapolated scheme.
        rows: the next row, and the one before which to return; the first is moved on. Shape (2,).
        stop: a number that another thread may set: from then on it returns. Shape (1,).
        cutting: what ``cutting_of`` returned.
        table: the lane's table, whose arms are chains and whose step is the time between two rows.

    Returns:
        0; or, for the row that is next, 1 + the joint that left its bounds, RAISED, or STOPPED.
    """
    period, _, _ = settings(table)
    for row in range(rows[0], rows[1]):
        rows[0] = row
        if stop[0] != 0:
            return STOPPED
        t = row * period
        bad = _attempt(stage, first, t, row, table)
        if bad != 0 and bad != RAISED:
            begin_parts(t, cutting, table)
            recorded = row
            while next_part(cutting, table):
                if stop[0] != 0:  # a part that can't be solved takes a millisecond
                    return STOPPED
                bad = _attempt(stage, first, cutting[FROM], recorded, table)
                end_part(bad, cutting, table)
                if bad == 0:
                    recorded = NO_ROW
            bad = int(cutting[RESULT])
        if bad != 0:
            return bad
    rows[0] = rows[1]
    return 0


@released
def run_sampled(substeps, rows, stop, table):  # type: ignore[no-untyped-def]
    """Make rows of the record in sampled mode, with ``substeps`` steps of the arm in each.

    The other arguments, and what is returned, are those of ``run_continuous``.
    """
    _, period, _ = settings(table)
    for row in range(rows[0], rows[1]):
        rows[0] = row
        if stop[0] != 0:
            return STOPPED
        t = row * period
        evaluate_arm(CURRENT, table)
        if table[NOMINAL_CHAIN] != 0:
            observe(t, row, table)
            evaluate_nominal(MEASURED_Q, MEASURED_V, table)
        bad = sample(t, row, row, table)
        for index in range(substeps):
            if bad != 0:
                return bad
            if index > 0:
                evaluate_arm(CURRENT, table)
            bad = substep(t, row, index, table)
        if bad != 0:
            return bad
    rows[0] = rows[1]
    return 0
