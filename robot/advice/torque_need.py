"""Torques that are asked for before anything runs: by a law at the start, by the motion itself."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from slidetune.robot.environment.external_torque import external_torque
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import AD, CURRENT, QD, TAU, VD, WORK_ROWS, F, V
from slidetune.robot.margins.instants import way_times
from slidetune.robot.margins.margin import evaluate
from slidetune.robot.motion.trajectory import reference

Array = np.ndarray

_INSTANTS = 60
"""Evenly spaced instants of the horizon (*ours*)."""
_FEWER = 4
"""Of so many places along the way one is looked at (*ours*): 61 in all."""


def start(packed: Packed, name: str) -> Array:
    """Return a workspace with a lane's law evaluated at the very start. Shape (WORK_ROWS, 6)."""
    simulation = packed.experiment.simulation
    work = np.zeros((WORK_ROWS, packed.joints))
    for_joints(reference, packed.joints)(0.0, packed.trajectory, work)
    q = work[QD] - np.asarray(simulation.initial_error)
    v = work[VD] if simulation.initial_velocity == "desired" else np.zeros(packed.joints)
    return evaluate(packed, name, q, v, packed.trajectory)


def initial_torque(packed: Packed, name: str) -> Array:
    """Return the torque that a lane's law asks for at the very start in [N m]. Shape (6,)."""
    torque: Array = start(packed, name)[TAU]
    return torque.copy()


def required_torque(packed: Packed) -> Array:
    r"""Return the greatest torque that the desired motion itself takes of every joint.

    .. math:: \max_t |M(q_d)\,\ddot q_d + C(q_d, \dot q_d)\,\dot q_d + G(q_d) + F|

    Args:
        packed: the experiment as numbers.

    Returns:
        Torque in [N m], of the true arm, friction and disturbance included. Shape (6,).
    """
    model, data = packed.model, packed.model.createData()
    joints = packed.joints
    work, greatest = np.zeros((WORK_ROWS, joints)), np.zeros(joints)
    motion_at, torque_at = for_joints(reference, joints), for_joints(external_torque, joints)
    even = np.linspace(0.0, packed.experiment.simulation.horizon, _INSTANTS)
    # By the way as well: a move may be short, and a disturbance has times of its own.
    for t in np.concatenate([even, way_times(packed)[::_FEWER]]).tolist():
        motion_at(t, packed.trajectory, work)
        work[CURRENT + V] = work[VD]
        torque_at(t, 0.0, CURRENT, packed.environment, work)
        inertia = pin.crba(model, data, work[QD])
        bias = pin.nonLinearEffects(model, data, work[QD], work[VD])
        greatest = np.maximum(greatest, np.abs(inertia @ work[AD] + bias + work[F]))
    return greatest
