"""The network lens of a law that estimates what the arm loses: beside what its model lacks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from slidetune.robot.environment.external_torque import external_torque
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import CURRENT, WORK_ROWS, F, V
from slidetune.robot.lenses.screen import every_few
from slidetune.robot.loop.simulate import LaneRun

Array = np.ndarray

TORQUE_ROWS = 500
"""Rows at which F is evaluated (*ours*)."""


@dataclass(frozen=True)
class ObservedJoint:
    """One joint's estimate.

    Attributes:
        f: estimate of what is lost in [N m]. Shape (m,).
        lost: what the law's model does not account for in [N m]: disturbance and friction F, and
            where the model is not the arm, the difference between the two. Shape (m,).
        known: share of it (as root mean square over the second half of the run) that the estimate
            carries; 1 is all, 0 none, below 0 worse than none.
        lost_rms: that root mean square of what is lost in [N m].
        missing_rms: the same of what the estimate leaves to the reaching law in [N m].
    """

    f: Array
    lost: Array
    known: float | None
    lost_rms: float
    missing_rms: float


@dataclass(frozen=True)
class ObserverView:
    """What the network lens shows of an observer.

    Attributes:
        observer: which: ``momentum`` or ``time_delay``, or ``twisting``: M z of super-twisting.
        adds: whether M z of super-twisting stands beside an observer's estimate in the sum.
        joints: the six joints.
        torque_time: time of estimate and loss in [s]. Shape (m,).
    """

    observer: str
    adds: bool
    joints: tuple[ObservedJoint, ...]
    torque_time: Array


def _lost(packed: Packed, run: LaneRun, chosen: Array) -> Array:
    r"""Return what the model does not account for at some rows of a run in [N m]. Shape (m, 6).

    .. math:: F + (M - \bar M)\,\ddot q + (C - \bar C)\,\dot q + G - \bar G
    """
    joints = packed.joints
    work, lost = np.zeros((WORK_ROWS, joints)), np.empty((len(chosen), joints))
    torque_at = for_joints(external_torque, joints)
    data = packed.model.createData()
    nominal = packed.nominal and packed.nominal.createData()
    for index, row in enumerate(chosen):
        work[CURRENT + V] = run.v[row]
        torque_at(float(run.time[row]), 0.0, CURRENT, packed.environment, work)
        lost[index] = work[F]
        if packed.nominal is not None:
            a = _acceleration(run, int(row))
            lost[index] += pin.rnea(packed.model, data, run.q[row], run.v[row], a)
            lost[index] -= pin.rnea(packed.nominal, nominal, run.q[row], run.v[row], a)
    return lost


def _acceleration(run: LaneRun, row: int) -> Array:
    """Return the acceleration from the rows beside one in [rad/s^2], 0 where there are none."""
    before, after = max(row - 1, 0), min(row + 1, len(run.time) - 1)
    if after == before or not np.all(np.isfinite(run.v[after])):
        after = row
    if after == before:
        return np.zeros_like(run.v[row])
    change = run.v[after] - run.v[before]
    return np.asarray(change / (run.time[after] - run.time[before]))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def look(packed: Packed, name: str, run: LaneRun) -> ObserverView | None:
    """Look at a lane's run: what its observer has seen.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        run: what it did.

    Returns:
        ``None`` where it has no observer, and no integral that acts like one.
    """
    lane = packed.experiment.lanes[name]
    kind, twists = getattr(lane, "observer", "none"), lane.law == "super_twisting"
    if kind == "none" and not twists:
        return None
    rows = max(1, int(np.isfinite(run.q[:, 0]).sum()))
    chosen = every_few(rows, TORQUE_ROWS)
    lost, f, late = _lost(packed, run, chosen), run.f[chosen], chosen >= rows // 2
    joints = []
    for j in range(packed.joints):
        asked, missing = _rms(lost[late, j]), _rms(lost[late, j] - f[late, j])
        joints.append(
            ObservedJoint(
                f=f[:, j],
                lost=lost[:, j],
                known=1.0 - missing / asked if asked > 1e-9 else None,
                lost_rms=asked,
                missing_rms=missing,
            )
        )
    observer = "twisting" if kind == "none" else kind
    return ObserverView(observer, twists and kind != "none", tuple(joints), run.time[chosen])
