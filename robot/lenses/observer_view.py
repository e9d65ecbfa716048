"""The network lens of a law that estimates what the arm loses: its estimate beside the true F."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.environment.external_torque import external_torque
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.fields.quantity import JOINTS
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
        f: estimate of F in [N m]. Shape (m,).
        lost: F: disturbance and friction in [N m]. Shape (m,).
        known: share of F (as root mean square over the second half of the run) that the estimate
            carries; 1 is all, 0 none, below 0 worse than none.
        lost_rms: that root mean square of F in [N m].
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
        torque_time: time of estimate and F in [s]. Shape (m,).
    """

    observer: str
    adds: bool
    joints: tuple[ObservedJoint, ...]
    torque_time: Array


def _lost(packed: Packed, run: LaneRun, chosen: Array) -> Array:
    """Return F at some rows of a run in [N m]; an error of the model is no part of it."""
    work, lost = np.zeros((WORK_ROWS, JOINTS)), np.empty((len(chosen), JOINTS))
    for index, row in enumerate(chosen):
        work[CURRENT + V] = run.v[row]
        external_torque(float(run.time[row]), 0.0, CURRENT, packed.environment, work)
        lost[index] = work[F]
    return lost


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
    for j in range(JOINTS):
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
