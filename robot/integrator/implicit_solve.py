"""Solves the equation of an implicit step to convergence, whatever the gains.

With the slopes of the surface frozen over a step, S at its end is an affine function of the
acceleration, so that each joint's torque is a monotone function of its own acceleration alone:
reaching law, torque limit and friction, with their bends and jumps. The equation is

    M a + G(a) = 0,    G_j increasing in a_j,

the minimum of a strictly convex function: it has one solution. Newton's method on it cycles or
stalls where a joint crosses the thin part of its curve. So the unknown is not a but the load
``m_j a_j + G_j(a_j)`` that a joint alone would balance: as its function, a is nowhere steeper than
1/m_j, and flat where the torque is steep or jumps. On the load Newton's method is an active-set
method that needs few steps; where it fails, joint by joint minimisation goes on.
"""

from __future__ import annotations

from math import inf, isfinite, tanh

from slidetune.robot.environment.external_torque import COULOMB_WIDTH
from slidetune.robot.environment.layout import COULOMB, LIMIT
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.joint_curve import (
    at_joint,
    balance,
    joint_curve,
    limited,
    lost_torque,
    reaching_at,
)
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.elimination import solve
from slidetune.robot.kernels.workspace import (
    ACCELERATION,
    APPLIED,
    CARRIED,
    COMMAND,
    F_SLOPE,
    GAIN,
    GIVEN,
    HELD,
    HELD_TORQUE,
    HOLD,
    LEAKAGE,
    LOAD,
    LOST,
    MATRIX,
    NETWORK,
    NETWORK_SLOPE,
    PASSED,
    REACH,
    REACHED,
    RESIDUAL,
    RIGHT,
    S_FALL,
    S_FREE,
    SHAPE,
    SHAPED,
    SLIDING,
    TAU,
    TRIAL,
    WITHHELD,
    YIELD,
    F,
    S,
    V,
)

SOLVED = 1e-8
"""What an equation may leave of a joint's velocity in [rad/s] (*ours*)."""
_AIM = 1e-12
"""What its iterations go on for, as long as they are worth it, in [rad/s] (*ours*)."""
_ITERATIONS = 60
_HALVINGS = 6
_LOOSE = 0.1
"""Share by which a torque follows past its limit where nothing else would (*ours*)."""
_PATIENCE = 20
"""Iterations in which what is left has to halve where the equation isn't convex (*ours*)."""


@kernel
def _weight(j, inertia, work):  # type: ignore[no-untyped-def]
    """Return m_j: the inertia of a joint, in units of its load."""
    if work[SHAPED, 0] != 0.0 and work[HOLD, 0] == 0.0:
        return inertia[j, j] / work[SHAPE + j, j]
    return inertia[j, j]


@kernel
def _shaped_torque(i, h, environment, inertia, work):  # type: ignore[no-untyped-def]
    """Return the command of joint ``i`` where SHAPE spreads the reaching law, and if it is free."""
    learning = h * work[NETWORK_SLOPE, i]
    s = work[S_FREE, i] - work[S_FALL, i] * work[ACCELERATION, i]
    torque = work[GIVEN, i] + learning * s
    for j in range(JOINTS):
        reached = _weight(j, inertia, work) * work[ACCELERATION, j] - work[LOAD, j]
        torque += work[SHAPE + i, j] * reached
    return limited(torque, environment[LIMIT, i])


@kernel
def _any_limited(h, inertia, environment, work):  # type: ignore[no-untyped-def]
    """Tell whether any torque of a shaped law is at its limit."""
    for i in range(JOINTS):
        _, free = _shaped_torque(i, h, environment, inertia, work)
        if free == 0.0:
            return True
    return False


@kernel
def _measure(h, state, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    """Write what all equations leave into RESIDUAL; return it as squared velocity [rad^2/s^2]."""
    shaped = work[SHAPED, 0] != 0.0 and work[HOLD, 0] == 0.0
    total = 0.0
    for i in range(JOINTS):
        left = 0.0
        for k in range(JOINTS):
            if k != i:
                left += inertia[i, k] * work[ACCELERATION, k]
        if shaped:
            given, _ = _shaped_torque(i, h, environment, inertia, work)
            given = at_joint(given, i, work)
            torque, _ = lost_torque(work[ACCELERATION, i], i, h, state, environment, work)
            left += inertia[i, i] * work[ACCELERATION, i] + bias[i] + torque - given
        else:
            left += work[LOAD, i]
        work[RESIDUAL, i] = left
        total += (h * left / inertia[i, i]) ** 2
    return total


@kernel
def _balance_all(h, state, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    for j in range(JOINTS):
        balance(j, _weight(j, inertia, work), h, state, bias, environment, work)
    return _measure(h, state, inertia, bias, environment, work)


@kernel
def _newton_direction(loose, h, state, inertia, environment, work):  # type: ignore[no-untyped-def]
    """Solve for the change of all loads; the answer stands in RIGHT.

    A joint that is held has only its torque to give: where limits leave fewer torques than joints
    are held, the matrix is singular. Then torques follow past their limits by the share ``loose``.
    """
    shaped = work[SHAPED, 0] != 0.0 and work[HOLD, 0] == 0.0
    for i in range(JOINTS):
        work[RIGHT, i] = -work[RESIDUAL, i]
        free, slope = 0.0, 0.0
        if shaped:
            _, free = _shaped_torque(i, h, environment, inertia, work)
            free = max(free, loose) * (1.0 - work[WITHHELD, i])
            _, slope = lost_torque(work[ACCELERATION, i], i, h, state, environment, work)
        for k in range(JOINTS):
            yielding = work[YIELD, k]
            entry = inertia[i, k] * yielding
            if shaped:
                entry -= free * work[SHAPE + i, k] * (_weight(k, inertia, work) * yielding - 1.0)
                if k == i:
                    learning = free * h * work[NETWORK_SLOPE, i] * work[S_FALL, i]
                    entry += (slope + learning) * yielding
            elif k == i:
                entry = 1.0
            work[MATRIX + i, k] = entry
    solve(work)


@kernel
def _sweep(h, state, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    """Minimise over one joint after the other: slow, but it always goes down."""
    for j in range(JOINTS):
        load = 0.0
        for k in range(JOINTS):
            if k != j:
                load -= inertia[j, k] * work[ACCELERATION, k]
        work[LOAD, j] = load
        balance(j, inertia[j, j], h, state, bias, environment, work)


@kernel
def _prepare(h, state, environment, work):  # type: ignore[no-untyped-def]
    """Write GIVEN and LOST: the torques that do not depend on the acceleration."""
    shaped, held = work[SHAPED, 0] != 0.0, work[HOLD, 0] != 0.0
    for i in range(JOINTS):
        if not held:
            given = work[TAU, i] - h * work[LEAKAGE, i] * work[NETWORK, i]
            if shaped:
                for j in range(JOINTS):
                    given -= work[SHAPE + i, j] * work[REACH, j]
            else:
                given -= work[REACH, i]
            work[GIVEN, i] = given
        lost = work[F, i]
        if environment[COULOMB, i] != 0.0:
            lost -= environment[COULOMB, i] * tanh(work[state + V, i] / COULOMB_WIDTH)
        work[LOST, i] = lost


@kernel
def _passed(h, state, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    r"""Return the velocity in [rad/s] that may be wrong because a joint passed through its layer.

    A joint that enters the thin part of its curve and leaves it again within one step feels the
    torque of the end for the whole of it: nobody asked when it passed. Where the torque changes
    by more than the slopes at both ends tell, the velocity may be off by half of
    :math:`h |\Delta G| / M_{jj}`.
    """
    worst = 0.0
    for j in range(JOINTS):
        soft = _weight(j, inertia, work)
        slope, way = h * work[F_SLOPE, j], abs(work[ACCELERATION, j])
        before = bias[j] + work[F, j]
        start = 0.0 if work[S_FALL, j] == 0.0 else (work[S_FREE, j] - work[S, j]) / work[S_FALL, j]
        if work[HOLD, 0] != 0.0:
            before -= work[APPLIED, j]
        elif work[SHAPED, 0] != 0.0:
            before, slope = -work[REACH, j], work[S_FALL, j] * work[GAIN, j]
            way = abs(work[ACCELERATION, j] - start)
        else:
            given, free = limited(work[TAU, j], environment[LIMIT, j])
            before -= at_joint(given, j, work)
            free *= 1.0 - work[WITHHELD, j]
            slope += free * work[S_FALL, j] * (work[GAIN, j] + h * work[NETWORK_SLOPE, j])
            way = max(way, abs(work[ACCELERATION, j] - start))
        after, steepness = joint_curve(work[ACCELERATION, j], j, h, state, bias, environment, work)
        if work[SLIDING, j] == 0.0:
            steepest = max(slope, steepness)
            more = max(0.0, abs(after - before) - steepest * way)
            worst = max(worst, 0.5 * h * more / (soft + steepest))
    return worst


@kernel
def _keep_held_torque(h, state, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    """Write the command of joints that sign(S) holds on their surface into HELD_TORQUE."""
    shaped, any_held = work[SHAPED, 0] != 0.0, False
    for j in range(JOINTS):
        any_held = any_held or work[SLIDING, j] != 0.0
    if not any_held:
        return
    work[HELD, 0] = 1.0
    for j in range(JOINTS):
        if shaped:
            soft = _weight(j, inertia, work)
            work[REACHED, j] = soft * work[ACCELERATION, j] - work[LOAD, j]
            # One joint's set-valued force is spread over all.
            work[HELD_TORQUE, j], _ = _shaped_torque(j, h, environment, inertia, work)
            work[SLIDING, j] = 1.0
        elif work[SLIDING, j] != 0.0:
            a = work[ACCELERATION, j]
            torque, _ = lost_torque(a, j, h, state, environment, work)
            given = bias[j] + torque - (work[LOAD, j] - inertia[j, j] * a)
            share = 1.0 - work[WITHHELD, j]
            work[HELD_TORQUE, j] = (given - work[CARRIED, j]) / share


@kernel
def curved_command(h, environment, inertia, work):  # type: ignore[no-untyped-def]
    """Write the controller's torque at the end of a step that ``solve_curves`` solved to COMMAND.

    Args:
        h: step in [s].
        environment: what ``pack_environment`` returned.
        inertia: M(q). Shape (6, 6).
        work: workspace with the solution.
    """
    for j in range(JOINTS):
        limit = environment[LIMIT, j]
        if work[SHAPED, 0] != 0.0:
            work[COMMAND, j], _ = _shaped_torque(j, h, environment, inertia, work)
        elif work[SLIDING, j] != 0.0:
            work[COMMAND, j], _ = limited(work[HELD_TORQUE, j], limit)
        else:
            s = work[S_FREE, j] - work[S_FALL, j] * work[ACCELERATION, j]
            value, _ = reaching_at(s, j, work)
            torque = work[GIVEN, j] + value + h * work[NETWORK_SLOPE, j] * s
            work[COMMAND, j], _ = limited(torque, limit)


@kernel
def solve_curves(h, state, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    """Solve ``M a + G(a) = 0`` from the guess in ACCELERATION, which becomes the answer.

    Args:
        h: step in [s].
        state: first row of the state from which the step starts.
        inertia: M(q). Shape (6, 6).
        bias: C v + G. Shape (6,).
        environment: what ``pack_environment`` returned.
        work: workspace with the evaluation at ``state``, S_FREE and S_FALL.

    Returns:
        What is left of the velocity in [rad/s]: at most ``SOLVED`` where it converged.
    """
    shaped = work[SHAPED, 0] != 0.0 and work[HOLD, 0] == 0.0
    _prepare(h, state, environment, work)
    if shaped:
        for j in range(JOINTS):
            a = work[ACCELERATION, j]
            value, _ = joint_curve(a, j, h, state, bias, environment, work)
            work[LOAD, j] = _weight(j, inertia, work) * a + value
    else:
        _sweep(h, state, inertia, bias, environment, work)
    left, loose = _balance_all(h, state, inertia, bias, environment, work), 0.0
    wanted = 0.5 * left
    for iteration in range(_ITERATIONS):
        if left <= _AIM * _AIM or not isfinite(left):
            break
        if shaped and iteration % _PATIENCE == _PATIENCE - 1:
            if left > wanted:
                break
            wanted = 0.5 * left
        _newton_direction(loose, h, state, inertia, environment, work)
        for j in range(JOINTS):
            work[TRIAL, j] = work[LOAD, j]
        share, tried = 1.0, inf
        for _ in range(_HALVINGS):
            for j in range(JOINTS):
                work[LOAD, j] = work[TRIAL, j] + share * work[RIGHT, j]
            tried = _balance_all(h, state, inertia, bias, environment, work)
            if tried <= (1.0 - 0.5 * share) * left:
                break
            share *= 0.5
        if tried < left:
            loose = 0.0
        elif (
            shaped
            and isfinite(tried)
            and (loose or not _any_limited(h, inertia, environment, work))
        ):
            # Nothing goes down: on from the last small step, uphill as it is.
            loose = 0.0
        else:
            for j in range(JOINTS):
                work[LOAD, j] = work[TRIAL, j]
            tried = _balance_all(h, state, inertia, bias, environment, work)
            loose = _LOOSE
            if not shaped:
                _sweep(h, state, inertia, bias, environment, work)
                tried = _balance_all(h, state, inertia, bias, environment, work)
        if tried > 0.25 * left and min(tried, left) <= SOLVED * SOLVED:
            # As good as rounding lets it become.
            left = tried
            break
        left = tried
    passed = _passed(h, state, inertia, bias, environment, work)
    work[PASSED, 0] = max(work[PASSED, 0], passed)
    _keep_held_torque(h, state, inertia, bias, environment, work)
    return left**0.5 if isfinite(left) else inf
