"""NFTSM, the paper's second rival: the terminal sliding surface with a model of the arm."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, field
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import (
    BENDS,
    CURVE,
    CURVE_ROWS,
    REACH,
    S_V,
    SHAPE,
    SHAPED,
    TAU,
    TERMINAL_C,
    TERMINAL_MU,
    TERMINAL_RATIO,
    stacked,
)
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.equivalent_control import equivalent_control
from slidetune.robot.laws.terms.implicit_switching import implicit_reach, implicit_reach_shaped
from slidetune.robot.laws.terms.network import no_network
from slidetune.robot.laws.terms.observer import (
    KIND,
    NONE,
    OBSERVER_ROWS,
    ObserverGains,
    advance_observer,
    observe_loss,
)
from slidetune.robot.laws.terms.surface import MU, NFTSM_ROWS, RATIO, C, NftsmSurface, nftsm_surface
from slidetune.robot.laws.terms.switching import IMPLICIT, SWITCHING_CODE, ReachingGains, reach

Array = np.ndarray

SURFACE, REACHING, INERTIA_SHAPED, OBSERVER = stacked(NFTSM_ROWS, CURVE_ROWS, 1, OBSERVER_ROWS)


class Nftsm(NftsmSurface, ReachingGains, ObserverGains):
    """Gains of NFTSM."""

    law: Literal["nftsm"] = "nftsm"
    inertia_shaped: bool = field(
        False,
        title="Inertia shaping",
        symbol="MΓ⁻¹",
        group="Reaching",
        meaning="Multiplies the reaching law by MΓ⁻¹, so that dS/dt = -k₁S - k₂sw(S) with "
        "k₁ in 1/s and k₂ in rad/s², if the model is exact and F = 0; not in the paper.",
    )

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers. Shape (12, n)."""
        shaped = np.full((1, joints), float(self.inertia_shaped))
        observer = self.pack_observer(joints)
        return np.vstack([self.pack_surface(joints), self.pack_reaching(joints), shaped, observer])


@kernel
def control(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of NFTSM (Liu et al. 2025, Eq. 9, 13, 14, corrected), written to TAU [N m].

    .. math:: \tau = \tau_{eq} + k_1 S + k_2 \tanh(S/\epsilon)

    With ``inertia_shaped`` the reaching law stands behind :math:`M\Gamma^{-1}` (ours).

    Args:
        state: first row of the state whose memory counts.
        gains: numbers of ``Nftsm.pack``. Shape (12, 6).
        nominal_M: inertia of the nominal arm. Shape (6, 6).
        nominal_nle: C v + G of the nominal arm. Shape (6,).
        work: workspace with the desired and the measured motion.
    """
    nftsm_surface(gains[SURFACE], work)
    reach(gains[REACHING], work)
    no_network(work)
    equivalent_control(nominal_M, nominal_nle, work)
    shaped = gains[INERTIA_SHAPED][0, 0] != 0.0
    if work[CURVE + SWITCHING_CODE, 0] == IMPLICIT:
        if shaped:
            implicit_reach_shaped(work)
        else:
            implicit_reach(nominal_M, work)
    work[SHAPED, 0] = work[BENDS, 0] = 1.0 if shaped else 0.0
    for i in range(JOINTS):
        if shaped:
            work[TERMINAL_C, i], work[TERMINAL_MU, i] = gains[C, i], gains[MU, i]
            work[TERMINAL_RATIO, i] = gains[RATIO, i]
            for j in range(JOINTS):
                share = nominal_M[i, j] / work[S_V, j]
                work[SHAPE + i, j] = share
                work[TAU, i] += share * work[REACH, j]
        else:
            work[TAU, i] += work[REACH, i]
    if gains[OBSERVER][KIND, 0] != NONE:
        observe_loss(gains[OBSERVER], state, 0, nominal_M, work)


@kernel
def advance(h, _, into, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    """Move the memory of the observer on; see ``Law``."""
    advance_observer(h, gains[OBSERVER], into, 0, nominal_M, nominal_nle, work)


LAW = Law(
    name="nftsm",
    title="NFTSM",
    summary="τ = τ_eq + k₁S + k₂sw(S) with S = νe + c·de + μ·sig(de)^(p/k) and a model (Eq. 14)",
    lane=Nftsm,
    control=control,
    model_based=True,
    network=False,
    advance=advance,
)
