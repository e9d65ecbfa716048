"""Super-twisting: a second-order sliding mode, whose torque is continuous."""

from __future__ import annotations

from math import copysign
from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, PerJoint, field
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import (
    CURVE,
    CURVE_ROWS,
    CURVED,
    GAIN,
    NETWORK,
    PERIOD,
    REACH,
    REACHED,
    RIGHT,
    S_FALL,
    S_FREE,
    SLIDING,
    TAU,
    S,
    W,
    stacked,
)
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.equivalent_control import equivalent_control
from slidetune.robot.laws.terms.inertia_shaping import shape_by_inertia
from slidetune.robot.laws.terms.network import no_network
from slidetune.robot.laws.terms.observer import (
    KIND,
    NONE,
    OBSERVER_ROWS,
    ObserverGains,
    advance_observer,
    observe_loss,
)
from slidetune.robot.laws.terms.surface import LINEAR_ROWS, LinearSurface, linear_surface
from slidetune.robot.laws.terms.switching import (
    ALPHA,
    EPSILON,
    HELD,
    IS_REACHING,
    K1,
    REACHING_CODE,
    SIGN,
    SWITCHING_CODE,
    TWISTING,
    reaching,
)

Array = np.ndarray

SURFACE, TWIST, BOUND, OBSERVER = stacked(LINEAR_ROWS, CURVE_ROWS, 1, OBSERVER_ROWS)
INTEGRAL = W
"""Row of its memory: z [rad/s^2]."""
MEMORY = 1
"""Rows of that."""
_STILL = 1e-9
"""|S| in [rad/s] below which a joint that a step holds is held on S = 0 (*ours*)."""


class SuperTwisting(LinearSurface, ObserverGains):
    """Gains of the super-twisting controller."""

    law: Literal["super_twisting"] = "super_twisting"
    k1: PerJoint = field(
        15.0,
        title="Root gain",
        symbol="k₁",
        unit="√(rad/s³)",
        low=0.0,
        high=1000.0,
        step=1.0,
        group="Twisting",
        meaning="Gain of |S|^½ sign(S). Where M⁻¹F changes by at most L, in rad/s³, 1.5√L: 15 for "
        "L = 100.",
    )
    k2: PerJoint = field(
        110.0,
        title="Integral gain",
        symbol="k₂",
        unit="rad/s³",
        low=0.0,
        high=100000.0,
        step=10.0,
        group="Twisting",
        meaning="Rate of the integral z of sign(S), which comes to balance M⁻¹F: 1.1 L, that is "
        "110 for L = 100 rad/s³.",
    )
    z_max: PerJoint = field(
        200.0,
        title="Bound of the integral",
        symbol="z_max",
        unit="rad/s²",
        low=0.0,
        high=10000.0,
        step=10.0,
        group="Twisting",
        meaning="Bound of |z|, against windup at a torque limit: the M⁻¹F that it can balance.",
    )

    @property
    def layer(self) -> PerJoint:
        """Within which S counts as reached in [rad/s]; it has no boundary layer."""
        return HELD

    @property
    def swing(self) -> float:
        """|S| in [rad/s] at which a margin takes its slope, which has no end at S = 0."""
        return HELD

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers. Shape (9, n)."""
        twist = np.zeros((CURVE_ROWS, joints))
        # The row K2 is what z changes by in one step, which only the step knows.
        twist[K1], twist[ALPHA], twist[EPSILON] = self.k1, self.k2, 1.0
        twist[[SWITCHING_CODE, REACHING_CODE, IS_REACHING], 0] = SIGN, TWISTING, 1.0
        bound = np.full((1, joints), self.z_max)
        return np.vstack([self.pack_surface(joints), twist, bound, self.pack_observer(joints)])


@kernel
def control(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of the super-twisting controller (Levant 1993, 1998), written to TAU [N m].

    .. math:: \tau = \tau_{eq} + M(k_1 |S|^{1/2}\operatorname{sign} S + z), \qquad
        \dot z = k_2 \operatorname{sign} S, \qquad S = \lambda e + \dot e

    With :math:`|\tfrac{d}{dt} M^{-1}F| \le L` it reaches S = dS/dt = 0 in finite time for
    k_1 = 1.5 sqrt(L), k_2 = 1.1 L. M z is recorded as f [N m], with what an observer adds: it
    comes to balance F. Continuous mode takes the set-valued sign of S at the end of the step, in z
    as well:

    .. math:: k_1 |S_1|^{1/2}\operatorname{sign} S_1 + z + h k_2 \xi, \qquad
        \xi \in \operatorname{Sgn} S_1

    Args:
        state: first row of the state whose memory counts.
        gains: numbers of ``SuperTwisting.pack``. Shape (9, 6).
        nominal_M: inertia of the nominal arm. Shape (6, 6).
        nominal_nle: C v + G of the nominal arm. Shape (6,).
        work: workspace with the desired and the measured motion.
    """
    linear_surface(gains[SURFACE], work)
    no_network(work)
    equivalent_control(nominal_M, nominal_nle, work)
    twist = gains[TWIST]
    for j in range(JOINTS):
        for row in range(CURVE_ROWS):
            work[CURVE + row, j] = twist[row, j]
        work[REACH, j], work[GAIN, j] = reaching(twist, j, work[S, j])
        if work[PERIOD, 0] != 0.0 and abs(work[S, j]) < HELD:
            # Only margins ask: the slope that a swing of that size feels.
            work[GAIN, j] = twist[K1, j] / HELD**0.5
    shape_by_inertia(nominal_M, work)
    for i in range(JOINTS):
        for j in range(JOINTS):
            work[NETWORK, i] += nominal_M[i, j] * work[state + INTEGRAL, j]
        work[TAU, i] += work[NETWORK, i]
    if gains[OBSERVER][KIND, 0] != NONE:
        observe_loss(gains[OBSERVER], state, MEMORY, nominal_M, work)


@inlined
def _sign(s):  # type: ignore[no-untyped-def]
    return 0.0 if s == 0.0 else copysign(1.0, s)


@kernel
def advance(h, state, into, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    """Integrate the sign of S, explicitly in sampled mode; see ``Law.advance``.

    Where a joint is held on S = 0, the step has found the one value of the sign that holds it.
    """
    for j in range(JOINTS):
        s, k2 = work[S, j], gains[TWIST][ALPHA, j]
        rate = k2 * _sign(s)
        if work[PERIOD, 0] == 0.0:
            s = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j]
            rate = k2 * _sign(s)
            if work[CURVED, 0] != 0.0 and work[SLIDING, j] != 0.0 and abs(s) < _STILL:
                rate = min(max(work[REACHED, j] / h, -k2), k2)
        z, bound = work[state + INTEGRAL, j] + h * rate, gains[BOUND][0, j]
        work[into + INTEGRAL, j] = min(max(z, -bound), bound)
    if gains[OBSERVER][KIND, 0] != NONE:
        advance_observer(h, gains[OBSERVER], into, MEMORY, nominal_M, nominal_nle, work)


LAW = Law(
    name="super_twisting",
    title="Super-twisting",
    summary="τ = τ_eq + M(k₁|S|^½sign(S) + z) with dz/dt = k₂sign(S) and S = λe + de",
    lane=SuperTwisting,
    control=control,
    model_based=True,
    network=False,
    memory=MEMORY,
    states=(INTEGRAL - W,),
    advance=advance,
)
