"""The linearly implicit step: the controller's own damping and stiffness join the inertia.

With the published gains the closed loop is far too stiff for any explicit scheme at 1 ms: k1 c is
1500 N m s/rad on a wrist of 0.001 kg m^2. One 6 x 6 elimination buys a step that does not care.
"""

from __future__ import annotations

from math import inf, isfinite

from robot.compiled import kernel
from robot.quantity import JOINTS
from robot.workspace import (
    AD,
    CURRENT,
    F_SLOPE,
    FLAGS,
    FULL,
    GAIN,
    HALF,
    HELD,
    HIDDEN,
    KEPT,
    LEAKAGE,
    LEARNING,
    LEARNT,
    MATRIX,
    NETWORK,
    NETWORK_SLOPE,
    NODES,
    RIGHT,
    S_E,
    S_V,
    SHAPE,
    TAU,
    VD,
    F,
    Q,
    S,
    V,
    W,
)

MAX_ANGLE = 100.0
"""Angle [rad] past which a lane counts as diverged (*ours*: 16 turns)."""
MAX_VELOCITY = 200.0
"""Velocity [rad/s] past which a lane counts as diverged (*ours*: 64 times the arm's limit)."""


@kernel
def solve(work):  # type: ignore[no-untyped-def]
    """Solve MATRIX x = RIGHT by elimination, in place; the answer stands in RIGHT.

    The matrix is an inertia plus a positive diagonal, or an inertia times one, so that no pivoting
    is needed.
    """
    for k in range(JOINTS - 1):
        inverse = 1.0 / work[MATRIX + k, k]
        for i in range(k + 1, JOINTS):
            factor = work[MATRIX + i, k] * inverse
            for j in range(k + 1, JOINTS):
                work[MATRIX + i, j] -= factor * work[MATRIX + k, j]
            work[RIGHT, i] -= factor * work[RIGHT, k]
    for i in range(JOINTS - 1, -1, -1):
        total = work[RIGHT, i]
        for j in range(i + 1, JOINTS):
            total -= work[MATRIX + i, j] * work[RIGHT, j]
        work[RIGHT, i] = total / work[MATRIX + i, i]


@kernel
def _fill(h, base, inertia, bias, limits, work):  # type: ignore[no-untyped-def]
    """Write the system of one step, but for the joints that HELD marks as limited."""
    shaped = work[FLAGS, 0] != 0.0
    for i in range(JOINTS):
        for j in range(JOINTS):
            work[MATRIX + i, j] = inertia[i, j]
        lost = bias[i] + work[F, i]
        diagonal = inertia[i, i] + h * work[F_SLOPE, i]
        if work[HELD, i] != 0.0:
            work[MATRIX + i, i], work[RIGHT, i] = diagonal, work[HELD, i] * limits[i] - lost
            continue
        s_v, s_e, slope = work[S_V, i], work[S_E, i], work[NETWORK_SLOPE, i]
        ahead = h * (s_v * work[AD, i] + s_e * (work[VD, i] - work[base + V, i]))
        gain = h * slope if shaped else h * slope + work[GAIN, i]
        work[MATRIX + i, i] = diagonal + h * gain * (s_v + h * s_e)
        learning = h * (slope * work[S, i] - work[LEAKAGE, i] * work[NETWORK, i])
        work[RIGHT, i] = work[TAU, i] - lost + learning + gain * ahead
    if shaped:
        _shape(h, base, work)


@kernel
def _shape(h, base, work):  # type: ignore[no-untyped-def]
    """Add damping and stiffness that SHAPE spreads over all joints."""
    for i in range(JOINTS):
        if work[HELD, i] != 0.0:
            continue
        for j in range(JOINTS):
            gain = h * work[SHAPE + i, j] * work[GAIN, j]
            damping, stiffness = gain * work[S_V, j], gain * work[S_E, j]
            work[MATRIX + i, j] += damping + h * stiffness
            work[RIGHT, i] += damping * work[AD, j]
            work[RIGHT, i] += stiffness * (work[VD, j] - work[base + V, j])


@kernel
def _saturate(h, base, inertia, bias, limits, work):  # type: ignore[no-untyped-def]
    """Mark the joints whose torque at the end of the step would pass its limit."""
    changed = False
    for i in range(JOINTS):
        if work[HELD, i] != 0.0 or limits[i] == inf:
            continue
        torque = bias[i] + work[F, i] + h * work[F_SLOPE, i] * work[RIGHT, i]
        for j in range(JOINTS):
            torque += inertia[i, j] * work[RIGHT, j]
        if abs(torque) > limits[i]:
            work[HELD, i] = 1.0 if torque > 0.0 else -1.0
            changed = True
    return changed


@kernel
def implicit_step(h, base, target, inertia, bias, limits, work):  # type: ignore[no-untyped-def]
    r"""One linearly implicit Euler step of the closed loop from state ``base`` to ``target``.

    .. math:: (M + h(D+B) + h^2(K + H s_v) + h^3 H s_e)\,a = r
        + h[D \ddot q_d + K(v_d - v)] + hH[S + h(s_v \ddot q_d + s_e(v_d - v))]

    followed by :math:`v_1 = v + ha`, :math:`q_1 = q + hv_1` and the network's own implicit step.
    A joint whose torque would end the step beyond its limit keeps the limit instead.

    Args:
        h: step in [s].
        base: first row of the state to start from.
        target: first row of the state to write.
        inertia: M(q). Shape (6, 6).
        bias: C v + G. Shape (6,).
        limits: torque limits in [N m], infinite where there are none. Shape (6,).
        work: workspace with the evaluation at ``base``.
    """
    for j in range(JOINTS):
        work[HELD, j] = 0.0
    for _ in range(JOINTS + 1):
        _fill(h, base, inertia, bias, limits, work)
        solve(work)
        if not _saturate(h, base, inertia, bias, limits, work):
            break
    for j in range(JOINTS):
        a, v = work[RIGHT, j], work[base + V, j]
        v_next = v + h * a
        work[target + V, j] = v_next
        work[target + Q, j] = work[base + Q, j] + h * v_next
        s_next = work[S, j] + h * (
            work[S_V, j] * (work[AD, j] - a) + work[S_E, j] * (work[VD, j] - v_next)
        )
        work[LEARNT, j] = h * work[LEARNING, j] * s_next
        work[KEPT, j] = 1.0 - h * work[LEAKAGE, j]
    for n in range(NODES):
        for j in range(JOINTS):
            kept = work[KEPT, j] * work[base + W + n, j]
            work[target + W + n, j] = kept + work[LEARNT, j] * work[HIDDEN + n, j]


@kernel
def within_bounds(base, work):  # type: ignore[no-untyped-def]
    """Return 0 for a state that may go on, else 1 + the joint that left its bounds."""
    for j in range(JOINTS):
        q, v = work[base + Q, j], work[base + V, j]
        if not (abs(q) <= MAX_ANGLE and abs(v) <= MAX_VELOCITY):
            return j + 1
        # One sum instead of ten questions: it isn't finite if a weight is not.
        weights = 0.0
        for n in range(NODES):
            weights += work[base + W + n, j]
        if not isfinite(weights):
            return j + 1
    return 0


@kernel
def accept(extrapolated, work):  # type: ignore[no-untyped-def]
    r"""Make the new state current if it is finite: ``2 y_half - y_full``, or ``y_full`` alone.

    The second half step has been written over HALF. Richardson extrapolation cancels the error of
    first order: 1.1e-5 rad instead of 9.9e-4 rad at a step of 1 ms with the published gains.

    Returns:
        0, or 1 + the joint that left its bounds; the current state is then untouched.
    """
    rows = HALF - FULL
    if extrapolated:
        for i in range(rows):
            for j in range(JOINTS):
                work[FULL + i, j] = 2.0 * work[HALF + i, j] - work[FULL + i, j]
    joint = within_bounds(FULL, work)
    if joint == 0:
        for i in range(rows):
            for j in range(JOINTS):
                work[CURRENT + i, j] = work[FULL + i, j]
    return joint
