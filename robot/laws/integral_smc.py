"""Integral sliding mode: the error obeys a chosen linear equation from the first moment on."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, PerJoint, field
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import (
    CURVE,
    CURVE_ROWS,
    DRIFT,
    MEASURED_Q,
    MEASURED_V,
    QD,
    S_E,
    S_V,
    VD,
    S,
    W,
    stacked,
)
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.equivalent_control import equivalent_control
from slidetune.robot.laws.terms.implicit_switching import implicit_reach_shaped
from slidetune.robot.laws.terms.inertia_shaping import ShapedReachingGains, shape_by_inertia
from slidetune.robot.laws.terms.network import no_network
from slidetune.robot.laws.terms.observer import (
    KIND,
    NONE,
    OBSERVER_ROWS,
    ObserverGains,
    advance_observer,
    observe_loss,
)
from slidetune.robot.laws.terms.switching import IMPLICIT, SWITCHING_CODE, reach

Array = np.ndarray

KP, KD = 0, 1
ERROR, REACHING, OBSERVER = stacked(2, CURVE_ROWS, OBSERVER_ROWS)
INTEGRAL, BEGUN = W, W + 1
"""Rows of its memory: the integral [rad/s], and whether it has begun [-]."""
MEMORY = 2
"""How many they are."""


class IntegralSmc(ShapedReachingGains, ObserverGains):
    """Gains of integral sliding mode control."""

    law: Literal["integral_smc"] = "integral_smc"
    kp: PerJoint = field(
        400.0,
        title="Position gain",
        symbol="k_p",
        unit="1/s²",
        low=0.0,
        high=10000.0,
        step=10.0,
        group="Error equation",
        meaning="Stiffness of the error equation ë + k_d·ė + k_p·e = 0, which S = 0 means.",
    )
    kd: PerJoint = field(
        40.0,
        title="Velocity gain",
        symbol="k_d",
        unit="1/s",
        low=0.1,
        high=200.0,
        step=1.0,
        scale="log",
        group="Error equation",
        meaning="Damping of the error equation; 2√k_p is critical damping.",
    )

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers. Shape (9, n)."""
        error = np.empty((2, joints))
        error[KP], error[KD] = self.kp, self.kd
        return np.vstack([error, self.pack_reaching(joints), self.pack_observer(joints)])


@kernel
def control(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of integral sliding mode control (Utkin and Shi 1996), written to TAU [N m].

    .. math:: S = \dot e + k_d e + k_p \int e\,dt - (\dot e + k_d e)(0), \qquad
        \tau = M(\ddot q_d + k_d \dot e + k_p e + k_1 S + k_2\,\mathrm{sw}(S/\epsilon))
        + C\dot q + G

    S is 0 at the beginning, so that there is no reaching phase: a disturbance within k_2 is
    rejected from the first moment on.

    Args:
        state: first row of the state whose memory counts.
        gains: numbers of ``IntegralSmc.pack``. Shape (9, 6).
        nominal_M: inertia of the nominal arm. Shape (6, 6).
        nominal_nle: C v + G of the nominal arm. Shape (6,).
        work: workspace with the desired and the measured motion.
    """
    for j in range(JOINTS):
        e = work[QD, j] - work[MEASURED_Q, j]
        moving = work[VD, j] - work[MEASURED_V, j] + gains[KD, j] * e
        begun = work[state + BEGUN, j] != 0.0
        work[S, j] = moving + work[state + INTEGRAL, j] if begun else 0.0
        work[S_V, j], work[S_E, j] = 1.0, gains[KD, j]
        work[DRIFT, j] = gains[KP, j] * e
    reach(gains[REACHING], work)
    if work[CURVE + SWITCHING_CODE, 0] == IMPLICIT:
        implicit_reach_shaped(work)
    no_network(work)
    equivalent_control(nominal_M, nominal_nle, work)
    shape_by_inertia(nominal_M, work)
    if gains[OBSERVER][KIND, 0] != NONE:
        observe_loss(gains[OBSERVER], state, MEMORY, nominal_M, work)


@kernel
def advance(h, state, into, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    """Integrate k_p e; begin where S is 0. See ``Law.advance``."""
    for j in range(JOINTS):
        e = work[QD, j] - work[MEASURED_Q, j]
        integral = work[state + INTEGRAL, j]
        if work[state + BEGUN, j] == 0.0:
            integral = -(work[VD, j] - work[MEASURED_V, j] + gains[KD, j] * e)
        work[into + INTEGRAL, j] = integral + h * gains[KP, j] * e
        work[into + BEGUN, j] = 1.0
    if gains[OBSERVER][KIND, 0] != NONE:
        advance_observer(h, gains[OBSERVER], into, MEMORY, nominal_M, nominal_nle, work)


LAW = Law(
    name="integral_smc",
    title="Integral SMC",
    summary="τ = M(a_d + k_d·de + k_p·e + k₁S + k₂sw(S)) + C·v + G with S = de + k_d·e + k_p∫e, "
    "0 at the beginning",
    lane=IntegralSmc,
    control=control,
    model_based=True,
    network=False,
    memory=MEMORY,
    states=(INTEGRAL - W,),
    advance=advance,
)
