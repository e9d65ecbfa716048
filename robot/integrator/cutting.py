"""Makes a step in parts where its own error is too great.

What is made next is decided here; the step itself is made by the loop that asks.
"""

from __future__ import annotations

from math import inf

import numpy as np

from slidetune.robot.integrator.implicit_step import STUCK
from slidetune.robot.integrator.kernel_arrays import STEP, TOLERANCE, loop_arrays
from slidetune.robot.integrator.law_call import RAISED
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.known_shape import as_floats
from slidetune.robot.kernels.workspace import CAPPED, CUT, OVER, RESIGNED, UNSOLVED, WRONG

Array = np.ndarray

NO_ROW = -1
"""Row of a step that is only part of one: nothing is recorded."""

HALVINGS = 10
"""How often one step is halved at most (*ours*): down to a thousandth of it."""
RUN_PARTS = 40
"""Parts that the rows of a whole run may have on average (*ours*)."""
LIVE_PARTS = 3.0
"""Parts that the rows of a live session may have on average (*ours*): it has to keep its pace."""
LIVE_BURST = 600.0
"""Parts that a live session may spend at once (*ours*): some 3 ms."""
RUN_STUCK = 0.5
"""Attempts a row, on average, whose equation may not be solved (*ours*): each takes about 1 ms."""
LIVE_STUCK = 0.02
"""The same of a live session (*ours*)."""
UNSOLVED_PARTS = 300.0
"""Parts that take as long as one whose equation is not solved (*ours*): some 0.5 ms."""

# Numbers of a cutting: how far a lane's steps may be cut, how much of that is left, and the parts
# of the step that is being made.
MOST, REFILL, LOOSENESS, LEFT, UNSOLVABLE, FILLED, WHOLE, DEPTH, FROM, LAST, RESULT = range(11)
COUNTED = 11
PENDING = 12  # parts still to be made: time [s], length [s] and how often it may be halved
PENDING_SIZE = 3
MOST_HALVINGS = 30
CUTTING_SIZE = PENDING + PENDING_SIZE * (MOST_HALVINGS + 1)


def cutting_of(
    halvings: int = HALVINGS,
    left: float = LIVE_BURST,
    refill: float = LIVE_PARTS,
    tolerance: float = 1.0,
    stuck: float = LIVE_STUCK * LIVE_BURST,
) -> Array:
    """Return how far a lane's steps may be cut: a token bucket; by default as in a live session.

    Args:
        halvings: how often one step may be halved.
        left: how many parts the rows may still have together, beyond one each.
        refill: by how many parts that grows with every row, up to ``LIVE_BURST``.
        tolerance: how many times its tolerance the error of a step may be.
        stuck: how many attempts may still fail to be solved; it grows with every row of a live
            session as well. Then a step that isn't solved is not cut any more, and counted.

    Returns:
        Numbers for ``begin_parts``. Shape (CUTTING_SIZE,).
    """
    cutting = np.zeros(CUTTING_SIZE)
    cutting[[MOST, REFILL, LOOSENESS]] = halvings, refill, tolerance
    cutting[[LEFT, UNSOLVABLE]] = left, stuck
    return cutting


def cutting_of_whole_run(rows: int, tolerance: float = 1.0) -> Array:
    """Return what a run of so many rows may take (*ours*)."""
    parts, stuck = float(RUN_PARTS * rows), RUN_STUCK * rows
    return cutting_of(left=parts, refill=0.0, tolerance=tolerance, stuck=stuck)


BUCKETS = slice(LEFT, WHOLE)
"""Numbers of a cutting that the next steps depend on besides its settings."""


@kernel
def _fill(t, h, cutting):  # type: ignore[no-untyped-def]
    """Add what the rows of length ``h`` until ``t`` are worth."""
    if cutting[REFILL] > 0.0:
        rows = max(0.0, (t - cutting[FILLED]) / h)
        cutting[LEFT] = min(LIVE_BURST, cutting[LEFT] + cutting[REFILL] * rows)
        more = cutting[UNSOLVABLE] + LIVE_STUCK * rows
        cutting[UNSOLVABLE] = min(LIVE_STUCK * LIVE_BURST, more)
    cutting[FILLED] = t


@kernel
def _pend(t, h, halvings, cutting):  # type: ignore[no-untyped-def]
    """Put a part on top of those to be made; the one on top is next."""
    place = PENDING + PENDING_SIZE * int(cutting[DEPTH])
    cutting[place], cutting[place + 1], cutting[place + 2] = t, h, halvings
    cutting[DEPTH] += 1.0


@kernel
def begin_parts(t, cutting, table):  # type: ignore[no-untyped-def]
    """Begin to make the step from ``t`` [s] of the table's length in parts, after it was refused.

    Args:
        t: time in [s].
        cutting: what ``cutting_of`` returned.
        table: the lane's table.
    """
    _, _, _, _, work, _ = loop_arrays(table)
    h, halvings = as_floats(table)[STEP], cutting[MOST]
    work[CUT, 0] += 1.0
    work[OVER, 0] = 0.0
    _fill(t, h, cutting)
    cutting[WHOLE], cutting[DEPTH], cutting[RESULT] = h, 0.0, 0.0
    spent = cutting[UNSOLVABLE] <= 0.0 and cutting[LEFT] < 0.0
    if halvings <= 0.0 or spent:
        _pend(t, h, 0.0, cutting)
    else:
        _pend(t + 0.5 * h, 0.5 * h, halvings - 1.0, cutting)
        _pend(t, 0.5 * h, halvings - 1.0, cutting)


@kernel
def next_part(cutting, table):  # type: ignore[no-untyped-def]
    """Prepare the next part: its length and tolerance in the table, its time in FROM [s].

    Returns:
        Whether there is one. When there is none, RESULT is 0 or 1 + the joint that left its bounds,
        or RAISED, and the table is as it was before.
    """
    numbers = as_floats(table)
    _, _, _, _, work, _ = loop_arrays(table)
    if cutting[DEPTH] == 0.0 or cutting[RESULT] != 0.0:
        if work[OVER, 0] > 1.0:
            work[CAPPED, 0] += 1.0
        numbers[STEP], numbers[TOLERANCE] = cutting[WHOLE], cutting[LOOSENESS]
        work[RESIGNED, 0] = 0.0
        return False
    place = PENDING + PENDING_SIZE * int(cutting[DEPTH] - 1.0)
    cutting[LEFT] -= 1.0
    last = cutting[place + 2] <= 0.0 or cutting[LEFT] < 0.0
    cutting[FROM], cutting[LAST] = cutting[place], 1.0 if last else 0.0
    cutting[COUNTED] = work[UNSOLVED, 0]
    numbers[STEP] = cutting[place + 1]
    numbers[TOLERANCE] = inf if last else cutting[LOOSENESS]
    work[RESIGNED, 0] = 1.0 if cutting[UNSOLVABLE] <= 0.0 else 0.0
    return True


@kernel
def end_part(bad, cutting, table):  # type: ignore[no-untyped-def]
    """Take note of what became of a part: if it has to be cut too, its halves come next.

    Args:
        bad: what the step returned: 0, 1 + joint, REFUSED, STUCK or RAISED.
        cutting: what ``cutting_of`` returned.
        table: the lane's table.
    """
    _, _, _, _, work, _ = loop_arrays(table)
    cutting[DEPTH] -= 1.0
    place = PENDING + PENDING_SIZE * int(cutting[DEPTH])
    if work[RESIGNED, 0] != 0.0:
        # Too many were not solved: from now on those count for what they take.
        cutting[LEFT] -= UNSOLVED_PARTS * (work[UNSOLVED, 0] - cutting[COUNTED])
    if bad == STUCK:
        cutting[UNSOLVABLE] -= 1.0
    if cutting[LAST] != 0.0:
        work[OVER, 0] = max(work[OVER, 0], work[WRONG, 0])
    if bad == RAISED or (cutting[LAST] != 0.0 and bad != 0):
        cutting[RESULT] = bad
    elif bad != 0:
        t, half, halvings = cutting[place], 0.5 * cutting[place + 1], cutting[place + 2] - 1.0
        _pend(t + half, half, halvings, cutting)
        _pend(t, half, halvings, cutting)
