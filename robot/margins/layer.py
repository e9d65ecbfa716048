"""The boundary layer that a lane has in its loop: its own, or the one that its period makes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import QD, S_V, WORK_ROWS
from slidetune.robot.laws.terms.switching import HELD
from slidetune.robot.margins.margin import evaluate
from slidetune.robot.motion.trajectory import QUINTIC, reference

Array = np.ndarray


def layer_of(packed: Packed, name: str) -> Array:
    r"""Return within which S counts as reached in [rad/s], 0 for a law without a reaching law.

    The implicit sign of a sampled loop is a saturation of width T k_2 if ``inertia_shaped``. If
    not, its joints couple, and it is what each has by itself at the beginning of the motion:

    .. math:: \epsilon_j = T\,\Gamma_j\,(M^{-1})_{jj}\,k_{2j}

    Args:
        packed: the experiment as numbers.
        name: the lane.

    Returns:
        Shape (6,).
    """
    lane, period = packed.experiment.lanes[name], packed.experiment.simulation.hold
    if getattr(lane, "switching", "") != "implicit" or period == 0.0:
        return np.broadcast_to(np.asarray(getattr(lane, "layer", 0.0), dtype=float), packed.joints)
    width = period * np.broadcast_to(np.asarray(lane.k2, dtype=float), packed.joints)
    if not getattr(lane, "inertia_shaped", False):
        width = width * mobility_at(packed, name, 0.0)
    return np.where(width > 0.0, width, HELD)


def mobility_at(packed: Packed, name: str, time: float) -> Array:
    r"""Return the diagonal of :math:`\Gamma M^{-1}`, of the nominal arm on its desired motion.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        time: when, in [s].

    Returns:
        What a torque on a joint alone does to the rate of its S in [1/(kg m^2)]. Shape (6,).
    """
    work, model = np.zeros((WORK_ROWS, packed.joints)), packed.nominal or packed.model
    for_joints(reference, packed.joints)(time, packed.trajectory, work)
    q = work[QD].copy()
    held = np.concatenate([[QUINTIC, 1.0], q, q])
    slope = evaluate(packed, name, q, np.zeros(packed.joints), held)[S_V]
    M = pin.crba(model, model.createData(), q)
    mobility: Array = slope * np.diag(np.linalg.inv(M))
    return mobility
