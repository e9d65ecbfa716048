"""The implicit step: the controller's own damping and stiffness join the inertia.

With the published gains the closed loop is far too stiff for any explicit scheme at 1 ms: k1 c is
1500 N m s/rad on a wrist of 0.001 kg m^2. One 6 x 6 elimination buys a step that does not care, as
long as the slopes at its beginning still hold at its end. Where they do not, at the edge of the
boundary layer, at a torque limit or where Coulomb friction turns, ``implicit_solve`` solves
the whole equation.
"""

from __future__ import annotations

from math import inf, isfinite

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.drive import begin_lag, end_lag, lags, without_lag
from slidetune.robot.integrator.implicit_solve import SOLVED, curved_command, solve_curves
from slidetune.robot.integrator.joint_curve import reaching_at
from slidetune.robot.integrator.tangent import (
    fill,
    final_torque,
    follow_tanh,
    is_smooth,
    tangents_hold,
)
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.elimination import solve, solve_symmetric
from slidetune.robot.kernels.known_shape import square, workspace
from slidetune.robot.kernels.workspace import (
    ACCELERATION,
    APPLIED,
    CHANGE_Q,
    CHANGE_V,
    COMMAND,
    CURRENT,
    CURVE,
    CURVED,
    DELIVERED,
    DIAGONAL,
    F_SLOPE,
    FULL,
    HALF,
    HIDDEN,
    HOLD,
    KEPT,
    KNOWN,
    LEAKAGE,
    LEARNING,
    LEARNT,
    LEFT,
    MATRIX,
    NETWORK,
    NETWORK_SLOPE,
    NODES,
    PASSED,
    REACH,
    RESIGNED,
    RIGHT,
    S_FALL,
    S_FREE,
    SHAPED,
    STATE_ROWS,
    TAU,
    TRIAL,
    UNSOLVED,
    F,
    Q,
    V,
    W,
)
from slidetune.robot.laws.terms.switching import ALPHA, K2, REACHING_CODE, TWISTING

BY_TANGENTS, BY_NEW_TANGENTS, BY_CURVES = range(3)
MAX_ANGLE = 100.0
"""Angle [rad] past which a lane counts as diverged (*ours*: 16 turns)."""
MAX_VELOCITY = 200.0
"""Velocity [rad/s] past which a lane counts as diverged (*ours*: 64 times the arm's limit)."""
REFUSED = -1
"""What a stage returns when its step has to be cut."""
STUCK = -2
"""What it returns when that is because its equation was not solved."""
TOLERANCE_Q = 5e-7
"""Error of one step in an angle from which on it is cut in [rad] (*ours*)."""
TOLERANCE_V = 5e-5
"""Error of one step in a velocity from which on it is cut in [rad/s] (*ours*)."""


@kernel
def _solve(h, state, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    """Solve the filled system and, where its tangents fail, the true one; the answer in RIGHT.

    Returns:
        What is left of the velocity in [rad/s].
    """
    if work[SHAPED, 0] != 0.0 and work[HOLD, 0] == 0.0:
        solve(work)
    else:
        solve_symmetric(work)
    work[CURVED, 0] = BY_TANGENTS
    if is_smooth(h, environment, work) or tangents_hold(h, state, inertia, environment, work):
        return 0.0
    if follow_tanh(h, inertia, bias, environment, work):
        work[CURVED, 0] = BY_NEW_TANGENTS
        return 0.0
    work[CURVED, 0] = BY_CURVES
    for j in range(JOINTS):
        work[ACCELERATION, j] = work[RIGHT, j]
    left = solve_curves(h, state, inertia, bias, environment, work)
    for j in range(JOINTS):
        work[RIGHT, j] = work[ACCELERATION, j]
    return left


@kernel
def keep_command(h, inertia, environment, work):  # type: ignore[no-untyped-def]
    """Write the controller's torque at the end of the step just solved to COMMAND [N m]."""
    if work[CURVED, 0] == BY_CURVES:
        curved_command(h, environment, inertia, work)
        return
    for j in range(JOINTS):
        if work[CURVED, 0] == BY_TANGENTS:
            work[COMMAND, j] = final_torque(h, j, work)
        else:
            # Its last tangents are not those of the beginning.
            s = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j]
            value, _ = reaching_at(s, j, work)
            learnt = h * (work[NETWORK_SLOPE, j] * s - work[LEAKAGE, j] * work[NETWORK, j])
            work[COMMAND, j] = work[TAU, j] - work[REACH, j] + value + learnt


@kernel
def implicit_step(h, state, into, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    r"""One implicit Euler step of the closed loop from state ``state`` to ``into``.

    .. math:: M a = \tau_r + R(S_1) + h H S_1 - h_{nle} - F(v_1), \qquad
        S_1 = S + h[s_v(\ddot q_d - a) + s_e(v_d - v_1) + d]

    followed by :math:`v_1 = v + ha`, :math:`q_1 = q + hv_1` and the network's own implicit step. R
    is the reaching law, :math:`\tau_r` the rest of the torque; M, the slopes s_v, s_e and the drift
    d of the surface and all else that depends on the angles stay as they are at ``state``. The sum
    of the controller's terms keeps its torque limit. The first Newton step, which mostly is enough,
    is (without drift)

    .. math:: (M + h(D+B) + h^2(K + H s_v) + h^3 H s_e)\,a = r
        + h[D \ddot q_d + K(v_d - v)] + hH[S + h(s_v \ddot q_d + s_e(v_d - v))]

    Args:
        h: step in [s].
        state: first row of the state to start from.
        into: first row of the state to write.
        inertia: M(q). Shape (6, 6).
        bias: C v + G. Shape (6,).
        environment: what ``pack_environment`` returned.
        work: workspace with the evaluation at ``state``.

    Returns:
        What the equation leaves of the velocity in [rad/s]; above ``SOLVED`` it did not converge.
    """
    work, inertia = workspace(work), square(inertia)
    work[HOLD, 0] = 0.0
    lagging = lags(environment)
    if lagging:
        begin_lag(h, state, environment, work)
    else:
        without_lag(work)
    if work[CURVE + REACHING_CODE, 0] == TWISTING:
        for j in range(JOINTS):
            work[CURVE + K2, j] = h * work[CURVE + ALPHA, j]
    fill(h, state, inertia, bias, work)
    left = _solve(h, state, inertia, bias, environment, work)
    if lagging:
        keep_command(h, inertia, environment, work)
        end_lag(h, state, into, environment, work)
    for j in range(JOINTS):
        a, v = work[RIGHT, j], work[state + V, j]
        v_next = v + h * a
        work[into + V, j] = v_next
        work[into + Q, j] = work[state + Q, j] + h * v_next
        s_next = work[S_FREE, j] - work[S_FALL, j] * a
        work[LEARNT, j] = h * work[LEARNING, j] * s_next
        work[KEPT, j] = 1.0 - h * work[LEAKAGE, j]
    for n in range(NODES):
        for j in range(JOINTS):
            kept = work[KEPT, j] * work[state + W + n, j]
            work[into + W + n, j] = kept + work[LEARNT, j] * work[HIDDEN + n, j]
    return left


@kernel
def arm_step(h, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    """One implicit Euler step of the arm alone under APPLIED, from CURRENT to FULL but for weights.

    Returns:
        What the equation leaves of the velocity in [rad/s].
    """
    work, inertia = workspace(work), square(inertia)
    for i in range(JOINTS):
        for j in range(i, JOINTS):
            work[MATRIX + i, j] = inertia[i, j]
        work[MATRIX + i, i] += h * work[F_SLOPE, i]
        work[DIAGONAL, i] = work[MATRIX + i, i]
        work[RIGHT, i] = work[APPLIED, i] - bias[i] - work[F, i]
    work[HOLD, 0] = 1.0
    # A sum is no constant to numba, which compiles what is called anew for each of those.
    left = _solve(h, CURRENT + Q, inertia, bias, environment, work)
    for j in range(JOINTS):
        v = work[CURRENT + V, j] + h * work[RIGHT, j]
        work[FULL + V, j] = v
        work[FULL + Q, j] = work[CURRENT + Q, j] + h * v
    return left


@inlined
def unsolved(left, tolerance, work):  # type: ignore[no-untyped-def]
    """Tell whether a step has to be cut because its equation was not solved.

    Args:
        left: what the equation left of the velocity in [rad/s].
        tolerance: ``inf`` where the step can't be cut any further: then it is counted.
        work: workspace; reads RESIGNED, writes UNSOLVED and LEFT.
    """
    if left <= SOLVED:
        return False
    if tolerance != inf and work[RESIGNED, 0] == 0.0:
        return True
    work[UNSOLVED, 0] += 1.0
    # What has no end freezes the lane, and is told there.
    work[LEFT, 0] = max(work[LEFT, 0], min(left, MAX_VELOCITY))
    return False


@inlined
def step_error(h, tolerance, work):  # type: ignore[no-untyped-def]
    r"""Estimate what an extrapolated step got wrong, as a multiple of what it may.

    The difference of the two sizes, :math:`y_{half} - y_{full} = C h^2`, is the error of first
    order, which extrapolation cancels. What remains is how C changes, from one step to the next.

    Args:
        h: step in [s].
        tolerance: up to where the step is accepted, and its C kept for the next one.
        work: workspace; reads FULL, HALF and the C of the step before.
    """
    square, worst = h * h, work[PASSED, 0] * (1.0 / TOLERANCE_V)
    known, inverse = square * work[KNOWN, 0], 1.0 / square
    for j in range(JOINTS):
        change_q = work[HALF + Q, j] - work[FULL + Q, j]
        change_v = work[HALF + V, j] - work[FULL + V, j]
        wrong_q = abs(change_q - known * work[CHANGE_Q, j]) * (1.0 / TOLERANCE_Q)
        wrong_v = abs(change_v - known * work[CHANGE_V, j]) * (1.0 / TOLERANCE_V)
        worst = max(worst, wrong_q, wrong_v)
    if worst <= tolerance:
        for j in range(JOINTS):
            work[CHANGE_Q, j] = inverse * (work[HALF + Q, j] - work[FULL + Q, j])
            work[CHANGE_V, j] = inverse * (work[HALF + V, j] - work[FULL + V, j])
        work[KNOWN, 0] = 1.0
    return worst


@inlined
def within_bounds(state, work):  # type: ignore[no-untyped-def]
    """Return 0 for a state that may go on, else 1 + the joint that left its bounds."""
    # One sum a joint instead of ten questions: it isn't finite if a weight is not. Row by row, so
    # that all six are added at once.
    for j in range(JOINTS):
        work[TRIAL, j] = work[state + W, j]
    for n in range(1, NODES):
        for j in range(JOINTS):
            work[TRIAL, j] += work[state + W + n, j]
    for j in range(JOINTS):
        q, v = work[state + Q, j], work[state + V, j]
        if not (abs(q) <= MAX_ANGLE and abs(v) <= MAX_VELOCITY and isfinite(work[TRIAL, j])):
            return j + 1
    return 0


@inlined
def accept_motion(work):  # type: ignore[no-untyped-def]
    """Do as ``accept`` for a step of the arm alone, which leaves the weights as they are."""
    for j in range(JOINTS):
        if not (abs(work[FULL + Q, j]) <= MAX_ANGLE and abs(work[FULL + V, j]) <= MAX_VELOCITY):
            return j + 1
    for j in range(JOINTS):
        work[CURRENT + Q, j] = work[FULL + Q, j]
        work[CURRENT + V, j] = work[FULL + V, j]
    return 0


@inlined
def _extrapolate(first, end, work):  # type: ignore[no-untyped-def]
    for i in range(first, end):
        for j in range(JOINTS):
            work[FULL + i, j] = 2.0 * work[HALF + i, j] - work[FULL + i, j]


@inlined
def _make_current(first, end, work):  # type: ignore[no-untyped-def]
    for i in range(first, end):
        for j in range(JOINTS):
            work[CURRENT + i, j] = work[FULL + i, j]


@inlined
def accept(extrapolated, lagging, work):  # type: ignore[no-untyped-def]
    r"""Make the new state current if it is finite: ``2 y_half - y_full``, or ``y_full`` alone.

    The second half step has been written over HALF. Richardson extrapolation cancels the error of
    first order: 1.1e-5 rad instead of 9.9e-4 rad at a step of 1 ms with the published gains.

    Args:
        extrapolated: whether the step was made in both sizes.
        lagging: whether the state has torques of drives with a lag, its last rows.
        work: workspace; writes the current state.

    Returns:
        0, or 1 + the joint that left its bounds; the current state is then untouched.
    """
    if extrapolated:
        _extrapolate(0, DELIVERED, work)
        if lagging:
            _extrapolate(DELIVERED, STATE_ROWS, work)
    joint = within_bounds(FULL, work)
    if joint == 0:
        _make_current(0, DELIVERED, work)
        if lagging:
            _make_current(DELIVERED, STATE_ROWS, work)
    return joint
