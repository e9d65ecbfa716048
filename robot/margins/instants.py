"""At which instants of a desired motion a loop is looked at: where its poses differ most.

Not evenly in time: a short move within a long horizon would be seen at its ends alone, and a sine
whose period fits the spacing at one pose.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.arm import build_arm
from slidetune.robot.arm.section import Robot
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.motion.along import desired_motion

Array = np.ndarray

POSES = 12
"""Instants by their poses alone (*ours*); where the arm is lightest is one more."""
_FINE = 241
"""Places along the way of which these are chosen (*ours*)."""
_FEWEST, _MOST, _A_SECOND = 4001, 40001, 200.0
"""Times at which the motion is computed: fewest, most, and a second of the horizon (*ours*)."""
_ALIKE = 1e-6
"""Distance of two poses in [rad] or [m] that are one (*ours*)."""
_GOLDEN = 0.6180339887498949
"""By its multiples times fall between each other without a period that a sine could have."""


def instants(packed: Packed) -> Array:
    """Return the instants in [s] at which the loop is looked at: one where nothing moves.

    The first is t = 0; each further one is that whose pose is farthest from all before it.
    """
    experiment = packed.experiment
    return _chosen(packed.trajectory.tobytes(), experiment.robot, experiment.simulation.horizon)


@lru_cache(maxsize=16)
def _chosen(trajectory: bytes, robot: Robot, horizon: float) -> Array:
    """Keep the last ones: a hand on a slider of a gain asks for those of one motion."""
    model = build_arm(robot).model
    times, poses = _way(trajectory, model.nv, horizon)
    chosen = [0]
    distance = np.abs(poses - poses[0]).max(axis=1)
    while len(chosen) < POSES and distance.max() > _ALIKE:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.abs(poses - poses[chosen[-1]]).max(axis=1))
    if len(chosen) > 1:
        chosen.append(_lightest(model, poses))
    return _unchangeable(times[list(dict.fromkeys(chosen))])


def way_times(packed: Packed) -> Array:
    """Return instants in [s] that are evenly apart along the way of all joints, t = 0 first."""
    horizon = packed.experiment.simulation.horizon
    return _way(packed.trajectory.tobytes(), packed.joints, horizon)[0]


def _lightest(model: pin.Model, poses: Array) -> int:
    """Return where the least eigenvalue of M is least: there the same torque moves most."""
    data = model.createData()
    upper = np.array([pin.crba(model, data, pose) for pose in poses])
    return int(np.linalg.eigvalsh(upper, UPLO="U")[:, 0].argmin())


@lru_cache(maxsize=16)
def _way(trajectory: bytes, joints: int, horizon: float) -> tuple[Array, Array]:
    """Return times in [s], (m,), and poses, (m, n), evenly apart along the way; t = 0 first."""
    count = int(np.clip(horizon * _A_SECOND, _FEWEST, _MOST))
    inner = np.arange(1, count) * _GOLDEN % 1.0
    times = np.concatenate([[0.0], horizon * np.sort(inner), [horizon]])
    poses, _ = desired_motion(np.frombuffer(trajectory).copy(), times, joints)
    way = np.concatenate([[0.0], np.abs(np.diff(poses, axis=0)).max(axis=1).cumsum()])
    rows = np.unique(np.searchsorted(way, np.linspace(0.0, way[-1], _FINE)))
    return _unchangeable(times[rows]), _unchangeable(poses[rows])


def _unchangeable(array: Array) -> Array:
    array.flags.writeable = False
    return array
