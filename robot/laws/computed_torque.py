"""Computed torque with a PD loop: the baseline that everybody knows."""

from __future__ import annotations

from typing import Literal

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, PerJoint, field
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import AD, BENDS, GAIN, REACH, SHAPE, SHAPED, TAU, S, stacked
from slidetune.robot.laws.law import Law
from slidetune.robot.laws.terms.network import no_network
from slidetune.robot.laws.terms.observer import (
    KIND,
    NONE,
    OBSERVER_ROWS,
    ObserverGains,
    advance_observer,
    observe_loss,
)
from slidetune.robot.laws.terms.surface import LINEAR_ROWS, linear_surface

Array = np.ndarray

RATIO, KD = 0, 1
_, OBSERVER = stacked(2, OBSERVER_ROWS)


class ComputedTorque(ObserverGains):
    """Gains of computed torque PD."""

    law: Literal["computed_torque"] = "computed_torque"
    kp: PerJoint = field(
        400.0,
        title="Position gain",
        symbol="k_p",
        unit="1/s²",
        low=0.0,
        high=10000.0,
        step=10.0,
        group="PD",
        meaning="Stiffness per unit of inertia: the square of the natural frequency.",
    )
    kd: PerJoint = field(
        40.0,
        title="Velocity gain",
        symbol="k_d",
        unit="1/s",
        low=0.1,
        high=400.0,
        step=1.0,
        scale="log",
        group="PD",
        meaning="Damping per unit of inertia; 2√k_p is critical damping.",
    )

    def pack(self, joints: int = JOINTS) -> Array:
        """Return kp/kd, kd and the observer's gains. Shape (4, n)."""
        block = np.empty((2, joints))
        block[RATIO], block[KD] = np.divide(self.kp, self.kd), self.kd
        return np.vstack([block, self.pack_observer(joints)])


@kernel
def control(state, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    r"""Computed torque with PD feedback, written to TAU [N m].

    .. math:: \tau = M(\ddot q_d + k_d \dot e + k_p e) + C\dot q + G

    Its sliding variable is :math:`S = \dot e + (k_p/k_d) e`, so that the feedback is k_d S.

    Args:
        state: first row of the state whose memory counts.
        gains: numbers of ``ComputedTorque.pack``. Shape (4, 6).
        nominal_M: inertia of the nominal arm. Shape (6, 6).
        nominal_nle: C v + G of the nominal arm. Shape (6,).
        work: workspace with the desired and the measured motion.
    """
    linear_surface(gains[:LINEAR_ROWS], work)
    no_network(work)
    work[SHAPED, 0], work[BENDS, 0] = 1.0, 0.0
    for j in range(JOINTS):
        work[GAIN, j] = gains[KD, j]
        work[REACH, j] = gains[KD, j] * work[S, j]
    for i in range(JOINTS):
        torque = nominal_nle[i]
        for j in range(JOINTS):
            work[SHAPE + i, j] = nominal_M[i, j]
            torque += nominal_M[i, j] * (work[AD, j] + work[REACH, j])
        work[TAU, i] = torque
    if gains[OBSERVER][KIND, 0] != NONE:
        observe_loss(gains[OBSERVER], state, 0, nominal_M, work)


@kernel
def advance(h, _, into, gains, nominal_M, nominal_nle, work):  # type: ignore[no-untyped-def]
    """Move the memory of the observer on; see ``Law``."""
    advance_observer(h, gains[OBSERVER], into, 0, nominal_M, nominal_nle, work)


LAW = Law(
    name="computed_torque",
    title="Computed torque PD",
    summary="τ = M(a_d + k_d·de + k_p·e) + C·v + G with a nominal model of the arm",
    lane=ComputedTorque,
    control=control,
    model_based=True,
    network=False,
    advance=advance,
)
