"""SMC: the conventional sliding surface with a model of the arm, as in the textbooks."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import CURVE, CURVE_ROWS, FLAGS, REACH, SHAPED, TAU, stacked
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.equivalent_control import equivalent_control
from slidetune.robot.laws.terms.implicit_switching import implicit_reach
from slidetune.robot.laws.terms.network import no_network
from slidetune.robot.laws.terms.surface import LINEAR_ROWS, LinearSurface, linear_surface
from slidetune.robot.laws.terms.switching import (
    CODES,
    IMPLICIT,
    SWITCHING_CODE,
    ReachingGains,
    reach,
)

Array = np.ndarray

SURFACE, REACHING = stacked(LINEAR_ROWS, CURVE_ROWS)


class Smc(LinearSurface, ReachingGains):
    """Gains of SMC."""

    law: Literal["smc"] = "smc"

    def pack(self) -> Array:
        """Return all gains as numbers. Shape (6, 6)."""
        return np.vstack([self.pack_surface(), self.pack_reaching()])


@kernel
def control(_, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of SMC: equivalent control and a reaching law, written to TAU [N m].

    .. math:: \tau = \tau_{eq} + k_1 S + k_2 \tanh(S/\epsilon)

    Args:
        gains: numbers of ``Smc.pack``. Shape (6, 6).
        nominal_M: inertia of the nominal arm. Shape (6, 6).
        nominal_nle: C v + G of the nominal arm. Shape (6,).
        work: workspace with the desired and the measured motion.
    """
    linear_surface(gains[SURFACE], work)
    reach(gains[REACHING], work)
    no_network(work)
    equivalent_control(nominal_M, nominal_nle, work)
    if work[CURVE + CODES, SWITCHING_CODE] == IMPLICIT:
        implicit_reach(nominal_M, work)
    work[FLAGS, SHAPED] = 0.0
    for j in range(JOINTS):
        work[TAU, j] += work[REACH, j]


LAW = Law(
    name="smc",
    title="SMC",
    summary="τ = τ_eq + k₁S + k₂sw(S) with S = λe + de and a nominal model of the arm",
    lane=Smc,
    control=control,
    model_based=True,
    network=False,
)
