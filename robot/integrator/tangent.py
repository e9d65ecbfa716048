"""The first Newton step of an implicit step: each curve replaced by its tangent, and its check.

One 6 x 6 elimination buys a step that does not care for stiffness, as long as the slopes at its
beginning still hold at its end. That is asked by a bound and, where it fails, of the curves.
"""

from __future__ import annotations

from math import inf, tanh

from slidetune.robot.environment.external_torque import COULOMB_WIDTH
from slidetune.robot.environment.layout import BITS, COULOMB, KINKS, LAGS, LIMIT
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.joint_curve import reaching_at, shaped_reaching
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.elimination import solve_symmetric
from slidetune.robot.kernels.workspace import (
    AD,
    CARRIED,
    CURVE,
    DIAGONAL,
    DRIFT,
    F_SLOPE,
    GAIN,
    HOLD,
    LEAKAGE,
    LOAD,
    MATRIX,
    NETWORK,
    NETWORK_SLOPE,
    REACH,
    RIGHT,
    S_E,
    S_FALL,
    S_FREE,
    S_V,
    SHAPE,
    SHAPED,
    TAU,
    TRIAL,
    VD,
    WITHHELD,
    YIELD,
    F,
    S,
    V,
)
from slidetune.robot.laws.terms.switching import (
    EPSILON,
    IS_REACHING,
    K2,
    POWER,
    REACHING_CODE,
    SWITCHING_CODE,
    TANH,
)

BENT = 0.385
"""Half the greatest curvature of tanh, 2/(3 sqrt 3): bounds what a tangent misses."""
TANGENT = 1e-8
"""Velocity in [rad/s] by which a tangent may be wrong before its curve is solved (*ours*)."""
_TANGENTS = 3
"""How often new tangents are tried before the curves themselves are solved (*ours*)."""


@inlined
def fill(h, state, inertia, bias, work):  # type: ignore[no-untyped-def]
    """Write the system of one step, every curve replaced by its tangent at the step's beginning.

    Args:
        h: step in [s].
        state: first row of the state from which the step starts.
        inertia: M(q). Shape (6, 6).
        bias: C v + G. Shape (6,).
        work: workspace with the evaluation at ``state``; writes MATRIX, of which only SHAPE fills
            the lower half, DIAGONAL, RIGHT, S_FREE and S_FALL.
    """
    shaped = work[SHAPED, 0] != 0.0
    for i in range(JOINTS):
        for j in range(0 if shaped else i, JOINTS):
            work[MATRIX + i, j] = inertia[i, j]
        lost = bias[i] + work[F, i]
        diagonal = inertia[i, i] + h * work[F_SLOPE, i]
        s_v, s_e, slope = work[S_V, i], work[S_E, i], work[NETWORK_SLOPE, i]
        fall = h * (s_v + h * s_e)
        ahead = s_v * work[AD, i] + s_e * (work[VD, i] - work[state + V, i])
        ahead = h * (ahead + work[DRIFT, i])
        gain = h * slope if shaped else h * slope + work[GAIN, i]
        withheld = work[WITHHELD, i]
        diagonal += gain * fall - withheld * (gain * fall)
        work[MATRIX + i, i] = work[DIAGONAL, i] = diagonal
        learning = h * (slope * work[S, i] - work[LEAKAGE, i] * work[NETWORK, i])
        torque = learning + gain * ahead
        late = work[CARRIED, i] - withheld * (work[TAU, i] + torque)
        work[RIGHT, i] = work[TAU, i] - lost + torque + late
        work[S_FREE, i], work[S_FALL, i] = work[S, i] + ahead, fall
    if shaped:
        _shape(work)


@kernel
def _shape(work):  # type: ignore[no-untyped-def]
    """Add damping and stiffness that SHAPE spreads over all joints."""
    for i in range(JOINTS):
        for j in range(JOINTS):
            gain = (1.0 - work[WITHHELD, i]) * work[SHAPE + i, j] * work[GAIN, j]
            work[MATRIX + i, j] += gain * work[S_FALL, j]
            work[RIGHT, i] += gain * (work[S_FREE, j] - work[S, j])
        work[DIAGONAL, i] = work[MATRIX + i, i]


@kernel
def _reaching_missed(h, state, j, work):  # type: ignore[no-untyped-def]
    """Return by how much the tangent of the reaching law is wrong at the end of the step.

    Returns:
        The torque that it misses [N m], and by how much the slope there is flatter, times S_FALL.
    """
    change = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j] - work[S, j]
    value, slope = reaching_at(work[S, j] + change, j, work)
    fall = work[S_FALL, j] * slope
    if work[SHAPED, 0] != 0.0:
        value, fall = shaped_reaching(value, fall, work[RIGHT, j], j, h, state, work)
    missed = abs(value - work[REACH, j] - work[GAIN, j] * change)
    return missed, min(0.0, fall - work[GAIN, j] * work[S_FALL, j])


@kernel
def _friction_missed(h, state, j, environment, work):  # type: ignore[no-untyped-def]
    """Return the same of Coulomb friction."""
    part = h * abs(work[RIGHT, j]) / COULOMB_WIDTH
    if (
        part < 0.1
        and h * BENT * environment[COULOMB, j] * part * part <= TANGENT * work[DIAGONAL, j]
    ):
        return 0.0, 0.0
    before = tanh(work[state + V, j] / COULOMB_WIDTH)
    after = tanh((work[state + V, j] + h * work[RIGHT, j]) / COULOMB_WIDTH)
    slope = h * environment[COULOMB, j] / COULOMB_WIDTH
    missed = environment[COULOMB, j] * (after - before)
    missed -= slope * (1.0 - before * before) * work[RIGHT, j]
    return abs(missed), min(0.0, slope * (before * before - after * after))


@inlined
def is_smooth(h, environment, work):  # type: ignore[no-untyped-def]
    """Tell whether nothing bends that much, by a bound and without a look at any curve.

    It answers for nearly all steps, those deep within the layer of tanh.

    Args:
        h: step in [s].
        environment: what ``pack_environment`` returned.
        work: workspace with what ``fill`` wrote and the solution in RIGHT.
    """
    if int(environment[BITS, 0]) & KINKS:
        return False
    if work[HOLD, 0] != 0.0 or work[CURVE + IS_REACHING, 0] == 0.0:
        return True
    smooth = work[CURVE + SWITCHING_CODE, 0] == TANH
    if not smooth or work[CURVE + REACHING_CODE, 0] == POWER:
        return False
    for j in range(JOINTS):
        change = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j] - work[S, j]
        square, layer = change * change, work[CURVE + EPSILON, j] * work[CURVE + EPSILON, j]
        bound, room = h * BENT * work[CURVE + K2, j] * square, TANGENT * work[DIAGONAL, j]
        smooth &= (square <= 0.01 * layer) & (bound <= room * layer)
    return smooth


@kernel
def tangents_hold(h, state, inertia, environment, work):  # type: ignore[no-untyped-def]
    """Tell whether the solution in RIGHT solves the true equation as well.

    Args:
        h: step in [s].
        state: first row of the state from which the step starts.
        inertia: M(q). Shape (6, 6).
        environment: what ``pack_environment`` returned.
        work: workspace with what ``fill`` wrote and the solution in RIGHT [rad/s^2].
    """
    shaped, held = work[SHAPED, 0] != 0.0, work[HOLD, 0] != 0.0
    bends = not held and work[CURVE + IS_REACHING, 0] != 0.0
    for j in range(JOINTS):
        size, wrong = work[DIAGONAL, j], 0.0
        if bends:
            missed, flatter = _reaching_missed(h, state, j, work)
            share = work[SHAPE + j, j] if shaped else 1.0
            wrong, size = wrong + share * missed, size + share * flatter
        if environment[COULOMB, j] != 0.0:
            missed, flatter = _friction_missed(h, state, j, environment, work)
            wrong, size = wrong + missed, size + flatter
        if not h * wrong <= TANGENT * max(size, inertia[j, j]):
            return False
        if held or environment[LIMIT, j] == inf:
            continue
        if not abs(final_torque(h, j, work)) <= environment[LIMIT, j]:
            return False
    return True


@kernel
def final_torque(h, j, work):  # type: ignore[no-untyped-def]
    """Return the controller's torque of joint ``j`` at the end of the step, by the tangents."""
    torque = work[TAU, j] - h * work[LEAKAGE, j] * work[NETWORK, j]
    torque += h * work[NETWORK_SLOPE, j] * (work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j])
    for k in range(JOINTS):
        if k == j or work[SHAPED, 0] != 0.0:
            change = work[S_FREE, k] - work[S_FALL, k] * work[RIGHT, k] - work[S, k]
            share = work[SHAPE + j, k] if work[SHAPED, 0] != 0.0 else 1.0
            torque += share * work[GAIN, k] * change
    return torque


@kernel
def follow_tanh(h, inertia, bias, environment, work):  # type: ignore[no-untyped-def]
    """Take new tangents at the end of the step, a few times; tell whether they hold in the end.

    It is Newton's method, for steps that bend within the layer of tanh and do not pass through it:
    there it converges at once and costs a tenth of solving the curves. LOAD, YIELD and TRIAL hold
    value, slope and place of the tangents.

    Args:
        h: step in [s].
        inertia: M(q). Shape (6, 6).
        bias: C v + G. Shape (6,).
        environment: what ``pack_environment`` returned.
        work: workspace with what ``fill`` wrote and the first solution in RIGHT [rad/s^2], which
            becomes the answer.
    """
    if int(environment[BITS, 0]) & (KINKS | LAGS) or work[HOLD, 0] != 0.0:
        return False
    if work[CURVE + IS_REACHING, 0] == 0.0 or work[SHAPED, 0] != 0.0:
        return False
    smooth = work[CURVE + SWITCHING_CODE, 0] == TANH
    if not smooth or work[CURVE + REACHING_CODE, 0] == POWER:
        return False
    for j in range(JOINTS):
        s = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j]
        if not abs(s - work[S, j]) <= work[CURVE + EPSILON, j]:
            return False
        work[TRIAL, j] = s
        work[LOAD, j], work[YIELD, j] = reaching_at(s, j, work)
    for _ in range(_TANGENTS):
        for i in range(JOINTS):
            for j in range(i, JOINTS):
                work[MATRIX + i, j] = inertia[i, j]
            slope, learning = work[YIELD, i], h * work[NETWORK_SLOPE, i]
            diagonal = inertia[i, i] + h * work[F_SLOPE, i]
            diagonal += (slope + learning) * work[S_FALL, i]
            work[MATRIX + i, i] = work[DIAGONAL, i] = diagonal
            given = work[TAU, i] - work[REACH, i] - h * work[LEAKAGE, i] * work[NETWORK, i]
            given += work[LOAD, i] + slope * (work[S_FREE, i] - work[TRIAL, i])
            work[RIGHT, i] = given + learning * work[S_FREE, i] - bias[i] - work[F, i]
        solve_symmetric(work)
        holds = True
        for j in range(JOINTS):
            s = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j]
            if not abs(s - work[S, j]) <= work[CURVE + EPSILON, j]:
                return False
            value, slope = reaching_at(s, j, work)
            missed = abs(value - work[LOAD, j] - work[YIELD, j] * (s - work[TRIAL, j]))
            size = work[DIAGONAL, j] + min(0.0, slope - work[YIELD, j]) * work[S_FALL, j]
            holds &= h * missed <= TANGENT * max(size, inertia[j, j])
            work[LOAD, j], work[YIELD, j], work[TRIAL, j] = value, slope, s
        if holds:
            return True
    return False
