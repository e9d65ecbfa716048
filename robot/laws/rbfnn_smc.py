"""RBFNN-SMC, the paper's first rival: a conventional sliding surface with the same network."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import CURVE_ROWS, NETWORK, REACH, SHAPED, TAU, stacked
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.network import NETWORK_ROWS, NetworkGains, network
from slidetune.robot.laws.terms.surface import LINEAR_ROWS, LinearSurface, linear_surface
from slidetune.robot.laws.terms.switching import ModelFreeReachingGains, reach

Array = np.ndarray

SURFACE, REACHING, NETWORK_GAINS = stacked(LINEAR_ROWS, CURVE_ROWS, NETWORK_ROWS)


class RbfnnSmc(LinearSurface, ModelFreeReachingGains, NetworkGains):
    """Gains of RBFNN-SMC."""

    law: Literal["rbfnn_smc"] = "rbfnn_smc"

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers. Shape (12, n)."""
        return np.vstack(
            [self.pack_surface(joints), self.pack_reaching(joints), self.pack_network(joints)]
        )


@kernel
def control(state, gains, _M, _nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of RBFNN-SMC (Li and Xu 2023, as compared by Liu et al. 2025), written to TAU [N m].

    .. math:: \tau = f + k_1 S + k_2 \tanh(S/\epsilon)

    Args:
        state: first row of the state whose weights count.
        gains: numbers of ``RbfnnSmc.pack``. Shape (12, 6).
        work: workspace with the desired and the measured motion.
    """
    linear_surface(gains[SURFACE], work)
    reach(gains[REACHING], work)
    network(gains[NETWORK_GAINS], state, work)
    work[SHAPED, 0] = 0.0
    for j in range(JOINTS):
        work[TAU, j] = work[NETWORK, j] + work[REACH, j]


LAW = Law(
    name="rbfnn_smc",
    title="RBFNN-SMC",
    summary="τ = f + k₁S + k₂sw(S) with S = λe + de and a network f",
    lane=RbfnnSmc,
    control=control,
    model_based=False,
    network=True,
)
