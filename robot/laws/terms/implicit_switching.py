r"""The set-valued sign taken at the end of a control period (Acary and Brogliato 2010).

With an exact model and the torque held for a period T, S would end at

.. math:: S^+ = S - T\,\Gamma M^{-1} r, \qquad r \in k_1 S^+ + k_2\,\mathrm{Sgn}(S^+)

Its sign then has the one value between -1 and 1 that leads there: no chattering of its own, and no
layer to choose. (INRIA RR-6886; a tutorial: hal-02523011.)
"""

from __future__ import annotations

from math import copysign

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.elimination import solve_symmetric
from slidetune.robot.kernels.workspace import (
    CURVE,
    GAIN,
    LOAD,
    MATRIX,
    PERIOD,
    REACH,
    RIGHT,
    S_V,
    TRIAL,
    YIELD,
    S,
)
from slidetune.robot.laws.terms.switching import CONSTANT, K1, K2, REACHING_CODE

SWEEPS = 50
"""Sweeps over all joints at most (*ours*); 30,000 drawn arms and gains took 5 or fewer."""
TOLERANCE = 1e-12
"""By what share of its terms a joint's torque may miss its equation (*ours*)."""


@kernel
def implicit_reach_shaped(work):  # type: ignore[no-untyped-def]
    r"""Write the reaching law that stands behind :math:`M\Gamma^{-1}` to REACH [rad/s^2].

    .. math:: \xi = \mathrm{clip}(S / (T k_2), -1, 1), \quad
        S^+ = (S - T k_2 \xi) / (1 + T k_1), \quad k_1 S^+ + k_2 \xi

    It is a saturation whose layer is exactly T k_2.

    Args:
        work: workspace; reads S, CURVE and the control period, writes REACH and GAIN.
    """
    period = work[PERIOD, 0]
    constant = work[CURVE + REACHING_CODE, 0] == CONSTANT
    for j in range(JOINTS):
        k1, k2, s = work[CURVE + K1, j], work[CURVE + K2, j], work[S, j]
        k1 = 0.0 if constant else k1
        if abs(s) < period * k2:
            work[REACH, j], work[GAIN, j] = s / period, 1.0 / period
        else:
            k2 = copysign(k2, s)
            slope = k1 / (1.0 + period * k1)
            work[REACH, j], work[GAIN, j] = slope * (s - period * k2) + k2, slope


@kernel
def implicit_reach(inertia, work):  # type: ignore[no-untyped-def]
    r"""Write the reaching law in torques, which couple the joints, to REACH [N m].

    In :math:`y = \Gamma^{-1} S^+` it is the minimum of a strictly convex function,

    .. math:: \tfrac12 y^T A y - b^T y + \sum_i (\tfrac12 k_{1i} \Gamma_i y_i^2 + k_{2i} |y_i|),
        \qquad A = M / T, \quad b = A\,\Gamma^{-1} S, \quad r = b - A y

    found by sweeps of projected Gauss-Seidel. Each sweep guesses which joints end at S = 0 and
    which signs the others have; with these the minimum is that of a linear system, as far as no
    sign changes on the way. The function falls with every guess, so that none comes twice.

    Args:
        inertia: M of the nominal arm. Shape (6, 6).
        work: workspace; reads S, S_V, CURVE and the control period, writes REACH and GAIN.
    """
    period = work[PERIOD, 0]
    constant = work[CURVE + REACHING_CODE, 0] == CONSTANT
    for i in range(JOINTS):
        load = 0.0
        for j in range(JOINTS):
            load += inertia[i, j] * (work[S, j] / work[S_V, j])
        work[LOAD, i], work[TRIAL, i] = load / period, 0.0
        work[GAIN, i] = 0.0 if constant else work[CURVE + K1, i]
    for _ in range(SWEEPS):
        _sweep(period, inertia, work)
        _settle(period, inertia, work)
        if _is_solved(period, inertia, work):
            break
    for i in range(JOINTS):
        own, k1, k2 = inertia[i, i] / (period * work[S_V, i]), work[GAIN, i], work[CURVE + K2, i]
        y = work[TRIAL, i]
        if y == 0.0 and k2 > 0.0:
            rest = _rest(i, period, inertia, work)
            work[REACH, i], work[GAIN, i] = min(max(rest, -k2), k2), own
        else:
            work[REACH, i] = k1 * work[S_V, i] * y + (copysign(k2, y) if k2 > 0.0 else 0.0)
            work[GAIN, i] = own * k1 / (own + k1)


@kernel
def _rest(i, period, inertia, work):  # type: ignore[no-untyped-def]
    """Return the torque that the others leave to joint ``i``."""
    total = 0.0
    for j in range(JOINTS):
        if j != i:
            total += inertia[i, j] * work[TRIAL, j]
    return work[LOAD, i] - total / period


@kernel
def _sweep(period, inertia, work):  # type: ignore[no-untyped-def]
    """Minimise over one joint after the other."""
    for i in range(JOINTS):
        rest, k2 = _rest(i, period, inertia, work), work[CURVE + K2, i]
        stiffness = inertia[i, i] / period + work[GAIN, i] * work[S_V, i]
        beyond = max(abs(rest) - k2, 0.0)
        work[TRIAL, i] = copysign(beyond, rest) / stiffness if beyond > 0.0 else 0.0


@kernel
def _settle(period, inertia, work):  # type: ignore[no-untyped-def]
    """Go to the minimum over the joints that move, or until one of them reaches zero; repeat."""
    for _ in range(JOINTS):
        for i in range(JOINTS):
            k2, y = work[CURVE + K2, i], work[TRIAL, i]
            moves = y != 0.0 or k2 == 0.0
            work[YIELD, i] = 1.0 if moves else 0.0
            work[RIGHT, i] = 0.0
            if moves:
                work[RIGHT, i] = work[LOAD, i] - (copysign(k2, y) if k2 > 0.0 else 0.0)
        for i in range(JOINTS):
            for j in range(i, JOINTS):
                both = work[YIELD, i] * work[YIELD, j]
                work[MATRIX + i, j] = both * inertia[i, j] / period
            work[MATRIX + i, i] += work[GAIN, i] * work[S_V, i] if work[YIELD, i] != 0.0 else 1.0
        solve_symmetric(work)
        share, first = 1.0, -1
        for i in range(JOINTS):
            y, end = work[TRIAL, i], work[RIGHT, i]
            if work[YIELD, i] != 0.0 and work[CURVE + K2, i] > 0.0 and y * end <= 0.0:
                to_zero = y / (y - end)
                if first < 0 or to_zero < share:
                    share, first = to_zero, i
        for i in range(JOINTS):
            work[TRIAL, i] += share * (work[RIGHT, i] - work[TRIAL, i])
        if first < 0:
            for i in range(JOINTS):
                work[TRIAL, i] = work[RIGHT, i]
            return
        work[TRIAL, first] = 0.0


@kernel
def _is_solved(period, inertia, work):  # type: ignore[no-untyped-def]
    """Tell whether every joint that ends at S = 0 can be held there."""
    for i in range(JOINTS):
        k2 = work[CURVE + K2, i]
        if work[TRIAL, i] != 0.0 or k2 == 0.0:
            continue
        size = abs(work[LOAD, i])
        for j in range(JOINTS):
            size += abs(inertia[i, j] * work[TRIAL, j]) / period
        if not abs(_rest(i, period, inertia, work)) <= k2 + TOLERANCE * size:
            return False
    return True
