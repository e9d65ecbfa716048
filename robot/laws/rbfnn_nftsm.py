"""RBFNN-NFTSM, the paper's proposal: a terminal sliding surface, and a network for the model."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import CURVE_ROWS, NETWORK, REACH, SHAPED, TAU, stacked
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.network import NETWORK_ROWS, NetworkGains, network
from slidetune.robot.laws.terms.surface import NFTSM_ROWS, NftsmSurface, nftsm_surface
from slidetune.robot.laws.terms.switching import ModelFreeReachingGains, reach

Array = np.ndarray

SURFACE, REACHING, NETWORK_GAINS = stacked(NFTSM_ROWS, CURVE_ROWS, NETWORK_ROWS)


class RbfnnNftsm(NftsmSurface, ModelFreeReachingGains, NetworkGains):
    """Gains of RBFNN-NFTSM."""

    law: Literal["rbfnn_nftsm"] = "rbfnn_nftsm"

    def pack(self, joints: int = JOINTS) -> Array:
        """Return all gains as numbers. Shape (15, n)."""
        return np.vstack(
            [self.pack_surface(joints), self.pack_reaching(joints), self.pack_network(joints)]
        )


@kernel
def control(state, gains, _M, _nle, work):  # type: ignore[no-untyped-def]
    r"""Torque of RBFNN-NFTSM (Liu et al. 2025, Eq. 22), written to TAU [N m].

    .. math:: \tau = f + k_1 S + k_2 \tanh(S/\epsilon)

    Args:
        state: first row of the state whose weights count.
        gains: numbers of ``RbfnnNftsm.pack``. Shape (15, 6).
        work: workspace with the desired and the measured motion.
    """
    nftsm_surface(gains[SURFACE], work)
    reach(gains[REACHING], work)
    network(gains[NETWORK_GAINS], state, work)
    work[SHAPED, 0] = 0.0
    for j in range(JOINTS):
        work[TAU, j] = work[NETWORK, j] + work[REACH, j]


LAW = Law(
    name="rbfnn_nftsm",
    title="RBFNN-NFTSM",
    summary="τ = f + k₁S + k₂sw(S) with S = νe + c·de + μ·sig(de)^(p/k) and a network f (Eq. 22)",
    lane=RbfnnNftsm,
    control=control,
    model_based=False,
    network=True,
)
