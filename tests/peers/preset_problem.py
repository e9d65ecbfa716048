"""A shipped experiment as the numbers that every contestant is given."""

from __future__ import annotations

import numpy as np

from slidetune.robot.arm.description import URDF_PATH
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.laws.rbfnn_nftsm import RbfnnNftsm
from slidetune.robot.motion.trajectory import SineTrajectory
from tests.peers.ours import LANE
from tests.peers.problem import Problem


def _joints(value: object) -> np.ndarray:
    return np.broadcast_to(np.asarray(value, dtype=float), JOINTS).copy()


def preset_problem(name: str) -> Problem:
    """Return the loop of a shipped preset.

    Raises:
        TypeError: if it is not RBFNN-NFTSM on a sine.
    """
    return problem_of(load_preset(name), name)


def problem_of(experiment: Experiment, name: str) -> Problem:
    """Return the loop of an experiment that is a shipped preset with other gains.

    Raises:
        TypeError: if it is not RBFNN-NFTSM on a sine.
    """
    gains, path = experiment.lanes[LANE], experiment.trajectory
    if not isinstance(gains, RbfnnNftsm) or not isinstance(path, SineTrajectory):
        raise TypeError(f"{name} is not RBFNN-NFTSM on a sine")
    start = _joints(path.amplitude) * _joints(path.angular_frequency)
    moving = experiment.simulation.initial_velocity == "desired"
    return Problem(
        urdf=str(URDF_PATH),
        preset=name,
        h=experiment.simulation.step,
        amplitude=_joints(path.amplitude),
        omega=_joints(path.angular_frequency),
        external=_joints(experiment.disturbance.constant),
        v0=start if moving else np.zeros(JOINTS),
        nu=_joints(gains.nu),
        c=_joints(gains.c),
        mu=_joints(gains.mu),
        ratio=np.divide(_joints(gains.p), _joints(gains.k)),
        k1=_joints(gains.k1),
        k2=_joints(gains.k2),
        epsilon=_joints(gains.epsilon),
        width=_joints(gains.width),
        learning_rate=_joints(gains.learning_rate),
        centers=gains.centers(),
    )
