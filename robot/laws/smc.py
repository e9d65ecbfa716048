"""SMC: the conventional sliding surface with a model of the arm, as in the textbooks."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import CURVE, CURVE_ROWS, REACH, SHAPED, TAU, stacked
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.equivalent_control import equivalent_control
from slidetune.robot.laws.terms.implicit_switching import implicit_reach
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
from slidetune.robot.laws.terms.switching import IMPLICIT, SWITCHING_CODE, ReachingGains, reach

Array = np.ndarray

SURFACE, REACHING, OBSERVER = stacked(LINEAR_ROWS, CURVE_ROWS, OBSERVER_ROWS)


class Smc(LinearSurface, ReachingGains, ObserverGains):
    """Gains of SMC."""

    law: Literal["smc"] = "smc"

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers. Shape (8, n)."""
        return np.vstack(
            [self.pack_surface(joints), self.pack_reaching(joints), self.pack_observer(joints)]
        )


@kernel
def control(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of SMC: equivalent control and a reaching law, written to TAU [N m].

    .. math:: \tau = \tau_{eq} + k_1 S + k_2 \tanh(S/\epsilon)

    Args:
        state: first row of the state whose memory counts.
        gains: numbers of ``Smc.pack``. Shape (8, 6).
        nominal_M: inertia of the nominal arm. Shape (6, 6).
        nominal_nle: C v + G of the nominal arm. Shape (6,).
        work: workspace with the desired and the measured motion.
    """
    linear_surface(gains[SURFACE], work)
    reach(gains[REACHING], work)
    no_network(work)
    equivalent_control(nominal_M, nominal_nle, work)
    if work[CURVE + SWITCHING_CODE, 0] == IMPLICIT:
        implicit_reach(nominal_M, work)
    work[SHAPED, 0] = 0.0
    for j in range(JOINTS):
        work[TAU, j] += work[REACH, j]
    if gains[OBSERVER][KIND, 0] != NONE:
        observe_loss(gains[OBSERVER], state, 0, nominal_M, work)


@kernel
def advance(h, _, into, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    """Move the memory of the observer on; see ``Law``."""
    advance_observer(h, gains[OBSERVER], into, 0, nominal_M, nominal_nle, work)


LAW = Law(
    name="smc",
    title="SMC",
    summary="τ = τ_eq + k₁S + k₂sw(S) with S = λe + de and a nominal model of the arm",
    lane=Smc,
    control=control,
    model_based=True,
    network=False,
    advance=advance,
)
