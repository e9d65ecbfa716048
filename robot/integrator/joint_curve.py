"""The torque of one joint as a function of its own acceleration over an implicit step.

With the slopes of the surface frozen, S at the end of the step falls evenly with the acceleration:
reaching law, torque limit and friction become one rising curve, with bends and jumps.
"""

from __future__ import annotations

from math import inf, tanh

from slidetune.robot.environment.external_torque import COULOMB_WIDTH
from slidetune.robot.environment.layout import COULOMB, LIMIT, VISCOUS
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import (
    ACCELERATION,
    AD,
    APPLIED,
    BENDS,
    CARRIED,
    CURVE,
    CURVE_ROWS,
    GAIN,
    GIVEN,
    HOLD,
    LOAD,
    LOST,
    NETWORK_SLOPE,
    REACH,
    S_E,
    S_FALL,
    S_FREE,
    S_V,
    SHAPED,
    SLIDING,
    TERMINAL_C,
    TERMINAL_MU,
    TERMINAL_RATIO,
    VD,
    WITHHELD,
    YIELD,
    S,
    V,
)
from slidetune.robot.laws.terms.switching import (
    IS_REACHING,
    K2,
    POWER,
    REACHING_CODE,
    SIGN,
    SWITCHING_CODE,
    reaching,
)

_ITERATIONS = 100
_EXACT = 1e-14
"""Relative change at which one joint's own equation counts as solved (*ours*)."""
_FLATTEST = 1e-3
"""Share of a joint's inertia below which its curve is not taken to fall (*ours*)."""
_STILL = 1e-12
"""Velocity in [rad/s] below which an error stands still (*ours*): its power has no slope there."""


@kernel
def reaching_at(s, j, work):  # type: ignore[no-untyped-def]
    """Return the reaching law of joint ``j`` at ``s`` and its slope; linear if only that is known.

    A law that calls ``reach`` leaves the whole curve in CURVE. One that writes
    REACH and GAIN itself is taken to be linear in S.
    """
    curve = work[CURVE : CURVE + CURVE_ROWS]
    if curve[IS_REACHING, 0] == 0.0:
        return work[REACH, j] + work[GAIN, j] * (s - work[S, j]), work[GAIN, j]
    return reaching(curve, j, s)


@kernel
def lost_torque(a, j, h, state, environment, work):  # type: ignore[no-untyped-def]
    """Return the torque that joint ``j`` loses at acceleration ``a``, and its slope."""
    slope = h * environment[VISCOUS, j]
    torque, coulomb = work[LOST, j] + slope * a, environment[COULOMB, j]
    if coulomb != 0.0:
        rubbing = tanh((work[state + V, j] + h * a) / COULOMB_WIDTH)
        torque += coulomb * rubbing
        slope += h * coulomb * (1.0 - rubbing * rubbing) / COULOMB_WIDTH
    return torque, slope


@kernel
def limited(torque, limit):  # type: ignore[no-untyped-def]
    """Return a torque within its limit, and 0 where the limit holds it, else 1."""
    if torque > limit:
        return limit, 0.0
    if torque < -limit:
        return -limit, 0.0
    return torque, 1.0


@inlined
def at_joint(command, j, work):  # type: ignore[no-untyped-def]
    """Return what the drive of joint ``j`` makes of a command at the end of the step in [N m]."""
    return work[CARRIED, j] + command - work[WITHHELD, j] * command


@kernel
def shaped_reaching(value, fall, a, j, h, state, work):  # type: ignore[no-untyped-def]
    r"""Return what SHAPE spreads of joint ``j``, and by how much it falls with the acceleration.

    SHAPE may be an inertia over :math:`\Gamma = \partial S/\partial\dot e`, which changes a
    hundredfold where the velocity error turns: within one step the torque changes with it. So what
    such a law puts behind the inertia is taken with Gamma at the end of the step,

    .. math:: r_j(a_j) = \frac{\Gamma}{\Gamma_1}\,[R(S_1) + \nu\,\dot e_1] - \nu\,\dot e, \qquad
        \dot e_1 = \dot e + h(\ddot q_d - a_j)

    Args:
        value: the reaching law at the end of the step.
        fall: by how much that falls with the acceleration.
        a: acceleration in [rad/s^2].
        j: joint.
        h: step in [s].
        state: first row of the state from which the step starts.
        work: workspace; reads the TERMINAL rows where BENDS is set.
    """
    if work[BENDS, 0] == 0.0:
        return value, fall
    nu, ratio, before = work[S_E, j], work[TERMINAL_RATIO, j], work[VD, j] - work[state + V, j]
    de = before + h * (work[AD, j] - a)
    size = max(abs(de), _STILL)
    steeper = ratio * work[TERMINAL_MU, j] * size ** (ratio - 1.0)
    gamma = work[TERMINAL_C, j] + steeper
    bend = (ratio - 1.0) * steeper * de / (size * size)
    share, whole = work[S_V, j] / gamma, value + nu * de
    return share * whole - nu * before, share * (fall + h * nu - h * whole * bend / gamma)


@kernel
def joint_curve(a, j, h, state, bias, environment, work):  # type: ignore[no-untyped-def]
    """Return G_j(a) in [N m] and its slope.

    Where SHAPE spreads the reaching law over all joints, it is the reaching law alone; only there
    its slope may be negative.
    """
    if work[HOLD, 0] != 0.0:
        torque, slope = lost_torque(a, j, h, state, environment, work)
        return bias[j] + torque - work[APPLIED, j], slope
    s, fall = work[S_FREE, j] - work[S_FALL, j] * a, work[S_FALL, j]
    value, steepness = reaching_at(s, j, work)
    if work[SHAPED, 0] != 0.0:
        value, slope = shaped_reaching(value, fall * steepness, a, j, h, state, work)
        return -value, slope
    learning = h * work[NETWORK_SLOPE, j]
    given, free = limited(work[GIVEN, j] + value + learning * s, environment[LIMIT, j])
    torque, slope = lost_torque(a, j, h, state, environment, work)
    free *= 1.0 - work[WITHHELD, j]
    return bias[j] + torque - at_joint(given, j, work), slope + free * fall * (steepness + learning)


@kernel
def _jump(j, h, state, bias, environment, work):  # type: ignore[no-untyped-def]
    """Return where the curve of joint ``j`` jumps, and its values before and after.

    Only sign(S) jumps; ``inf`` says that there is none.
    """
    curve, fall = work[CURVE : CURVE + CURVE_ROWS], work[S_FALL, j]
    jumps = curve[IS_REACHING, 0] != 0.0 and curve[SWITCHING_CODE, 0] == SIGN
    if not jumps or curve[REACHING_CODE, 0] == POWER or fall == 0.0:
        return inf, 0.0, 0.0
    if work[HOLD, 0] != 0.0:
        return inf, 0.0, 0.0
    a, k2 = work[S_FREE, j] / fall, curve[K2, j]
    if work[SHAPED, 0] != 0.0:
        before, _ = shaped_reaching(k2, 0.0, a, j, h, state, work)
        after, _ = shaped_reaching(-k2, 0.0, a, j, h, state, work)
        return a, -before, -after
    torque, _ = lost_torque(a, j, h, state, environment, work)
    before, _ = limited(work[GIVEN, j] + k2, environment[LIMIT, j])
    after, _ = limited(work[GIVEN, j] - k2, environment[LIMIT, j])
    before, after = at_joint(before, j, work), at_joint(after, j, work)
    return a, bias[j] + torque - before, bias[j] + torque - after


@kernel
def balance(j, m, h, state, bias, environment, work):  # type: ignore[no-untyped-def]
    """Solve ``m a + G_j(a) = LOAD`` of one joint; write ACCELERATION and YIELD.

    A bracket and Newton's method: where a step leaves the bracket, its middle is taken.
    """
    load, low, high = work[LOAD, j], -inf, inf
    at, before, after = _jump(j, h, state, bias, environment, work)
    if at != inf:
        if m * at + before <= load <= m * at + after:
            work[ACCELERATION, j], work[YIELD, j], work[SLIDING, j] = at, 0.0, 1.0
            return
        if load < m * at + before:
            high = at
        else:
            low = at
    elif work[S_FALL, j] > 0.0:
        # The curve is steepest at S = 0: started there, Newton's method comes from one side.
        pivot = work[S_FREE, j] / work[S_FALL, j]
        value, _ = joint_curve(pivot, j, h, state, bias, environment, work)
        if m * pivot + value > load:
            high = pivot
        else:
            low = pivot
    if environment[COULOMB, j] != 0.0:
        pivot = -work[state + V, j] / h
        if low < pivot < high:
            value, _ = joint_curve(pivot, j, h, state, bias, environment, work)
            if m * pivot + value > load:
                high = pivot
            else:
                low = pivot
    a = work[ACCELERATION, j]
    if not low < a < high:
        a = low if low != -inf else high
    slope = m
    for _ in range(_ITERATIONS):
        value, steepness = joint_curve(a, j, h, state, bias, environment, work)
        wrong, slope = m * a + value - load, max(m + steepness, _FLATTEST * m)
        if abs(wrong) <= _EXACT * (abs(load) + m * abs(a)):
            break
        if wrong > 0.0:
            high = a
        else:
            low = a
        step = wrong / slope
        better = a - step
        if not low <= better <= high:
            better = 0.5 * (low + high)
        if abs(better - a) <= _EXACT * (abs(a) + 1.0):
            a = better
            break
        a = better
    work[ACCELERATION, j], work[YIELD, j], work[SLIDING, j] = a, 1.0 / slope, 0.0
