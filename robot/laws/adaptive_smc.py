"""Adaptive SMC: the switching gain grows until it suffices, and falls where it is not needed."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, PerJoint, field
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import (
    CURVE,
    CURVE_ROWS,
    GAIN,
    NETWORK,
    PERIOD,
    REACH,
    RIGHT,
    S_FALL,
    S_FREE,
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
from slidetune.robot.laws.terms.surface import LINEAR_ROWS, LinearSurface, linear_surface
from slidetune.robot.laws.terms.switching import (
    EPSILON,
    IMPLICIT,
    K2,
    SWITCHING_CODE,
    reach,
    reaching,
)

Array = np.ndarray

LEAST, RATE = 0, 1
SURFACE, REACHING, ADAPTATION, OBSERVER = stacked(LINEAR_ROWS, CURVE_ROWS, 2, OBSERVER_ROWS)
SWITCHING_GAIN = W
"""Row of its memory: the present k₂ [rad/s^2], 0 before it has begun."""
MEMORY = 1
"""Rows of that."""


class AdaptiveSmc(LinearSurface, ShapedReachingGains, ObserverGains):
    """Gains of SMC with an adaptive switching gain."""

    law: Literal["adaptive_smc"] = "adaptive_smc"
    k2: PerJoint = field(
        200.0,
        title="Largest switching gain",
        symbol="k_max",
        unit="rad/s²",
        low=0.0,
        high=1000.0,
        step=1.0,
        group="Reaching",
        needs={"reaching": ("exponential", "constant")},
        meaning="Bound of the adapted switching gain k₂, even below k_min: the M⁻¹F that it can "
        "come to reject.",
    )
    epsilon: PerJoint = field(
        0.05,
        title="Boundary layer",
        symbol="ε",
        unit="rad/s",
        low=1e-4,
        high=10.0,
        step=0.01,
        scale="log",
        group="Reaching",
        meaning="|S| above which k₂ grows, and below which it falls; also the layer of tanh and "
        "saturation.",
    )
    k2_min: PerJoint = field(
        1.0,
        title="Smallest switching gain",
        symbol="k_min",
        unit="rad/s²",
        low=0.0,
        high=1000.0,
        step=1.0,
        group="Adaptation",
        needs={"reaching": ("exponential", "constant")},
        meaning="Switching gain at the beginning, and the one to which it falls at most.",
    )
    adaptation_rate: PerJoint = field(
        200.0,
        title="Adaptation rate",
        symbol="κ",
        unit="1/s²",
        low=0.0,
        high=100000.0,
        step=10.0,
        group="Adaptation",
        needs={"reaching": ("exponential", "constant")},
        meaning="Rate at which k₂ changes, per |S|; 0 keeps it.",
    )

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers. Shape (10, n)."""
        adaptation = np.empty((2, joints))
        adaptation[LEAST], adaptation[RATE] = self.k2_min, self.adaptation_rate
        own = self.pack_surface(joints), self.pack_reaching(joints), adaptation
        return np.vstack([*own, self.pack_observer(joints)])


@inlined
def _bounded(gain, j, gains):  # type: ignore[no-untyped-def]
    return min(max(gain, gains[ADAPTATION][LEAST, j]), gains[REACHING][K2, j])


@kernel
def control(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of SMC with the present switching gain, written to TAU [N m].

    .. math:: \tau = \tau_{eq} + M(k_1 S + k_2(t)\,\mathrm{sw}(S/\epsilon)), \qquad
        S = \lambda e + \dot e

    What the gain could give at a joint alone, :math:`M_{jj} k_2`, is recorded as f [N m]: it is
    what stands against F. With an observer f is its estimate.

    Args:
        state: first row of the state whose memory counts.
        gains: numbers of ``AdaptiveSmc.pack``. Shape (10, 6).
        nominal_M: inertia of the nominal arm. Shape (6, 6).
        nominal_nle: C v + G of the nominal arm. Shape (6,).
        work: workspace with the desired and the measured motion.
    """
    linear_surface(gains[SURFACE], work)
    reach(gains[REACHING], work)
    curve = work[CURVE : CURVE + CURVE_ROWS]
    for j in range(JOINTS):
        curve[K2, j] = _bounded(work[state + SWITCHING_GAIN, j], j, gains)
        work[REACH, j], work[GAIN, j] = reaching(curve, j, work[S, j])
    if curve[SWITCHING_CODE, 0] == IMPLICIT:
        implicit_reach_shaped(work)
    no_network(work)
    equivalent_control(nominal_M, nominal_nle, work)
    shape_by_inertia(nominal_M, work)
    if gains[OBSERVER][KIND, 0] != NONE:
        observe_loss(gains[OBSERVER], state, MEMORY, nominal_M, work)
    else:
        for j in range(JOINTS):
            work[NETWORK, j] = nominal_M[j, j] * curve[K2, j]


@kernel
def advance(h, state, into, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Adapt the switching gain (Plestan, Shtessel, Brégeault and Poznyak 2010); ``Law.advance``.

    .. math:: \dot k_2 = \kappa |S| \operatorname{sign}(|S| - \epsilon), \qquad
        k_{min} \le k_2 \le k_{max}
    """
    for j in range(JOINTS):
        s = work[S, j]
        if work[PERIOD, 0] == 0.0:
            s = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j]
        rate = gains[ADAPTATION][RATE, j] * abs(s)
        if abs(s) < gains[REACHING][EPSILON, j]:
            rate = -rate
        known = _bounded(work[state + SWITCHING_GAIN, j], j, gains)
        work[into + SWITCHING_GAIN, j] = _bounded(known + h * rate, j, gains)
    if gains[OBSERVER][KIND, 0] != NONE:
        advance_observer(h, gains[OBSERVER], into, MEMORY, nominal_M, nominal_nle, work)


LAW = Law(
    name="adaptive_smc",
    title="Adaptive SMC",
    summary="τ = τ_eq + M(k₁S + k₂sw(S)) with S = λe + de and dk₂/dt = κ|S|sign(|S| - ε)",
    lane=AdaptiveSmc,
    control=control,
    model_based=True,
    network=False,
    memory=MEMORY,
    advance=advance,
)
