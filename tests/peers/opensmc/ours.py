"""Our laws on the two-link arm: the kernels of the sampled loop, around an arm of its own."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.dynamics import Dynamics
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import pack_environment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.kernel_arrays import kernel_table
from slidetune.robot.integrator.stages import sample
from slidetune.robot.kernels.workspace import PERIOD, RECORD, TAU, WORK_ROWS, Q, V
from slidetune.robot.laws import LAWS
from slidetune.robot.motion.trajectory import (
    HoldTrajectory,
    SineTrajectory,
    Trajectory,
    pack_trajectory,
)
from tests.peers.opensmc.pairs import Gains
from tests.peers.opensmc.tasks import STEP, TASKS, Array, push
from tests.peers.opensmc.two_link import bias, held_step, inertia

LINKS = 2
_ALONE = (0.0,) * (JOINTS - LINKS)
TRAJECTORIES: dict[str, Trajectory] = {
    "reach": HoldTrajectory(position=(np.pi / 4, np.pi / 4, *_ALONE)),
    "follow": SineTrajectory(amplitude=(1.0, 1.0, *_ALONE), phase=(0.0, np.pi / 2, *_ALONE)),
}
"""The motions of ``TASKS`` as ours."""


def run(gains: Gains, key: str, seconds: float) -> Array:
    """Return angles, velocities and torques of the two joints at every step.

    The law is asked once a step, as in sampled mode; its torque is held over the step.

    Args:
        gains: gains of a lane.
        key: of ``TASKS``.
        seconds: how long, in [s].

    Returns:
        Shape (n + 1, 6).

    Raises:
        RuntimeError: if a torque is no longer a number, or one of the other joints moves.
    """
    law, task = LAWS[gains["law"]], TASKS[key]
    lane = law.lane(**gains)
    work = np.zeros((WORK_ROWS, JOINTS))
    work[Q, :LINKS], work[V, :LINKS] = task.q0, task.v0
    work[PERIOD, 0] = STEP
    M, h = inertia(work[Q]), bias(work[Q], work[V])
    model = pin.Model()
    arm = Dynamics(model, model.createData(), lambda: None, M, h)
    table = kernel_table(
        arm,
        arm,
        lane.pack(),  # type: ignore[attr-defined]
        pack_environment(Disturbance(), 0.0, 0.0, None),
        pack_trajectory(TRAJECTORIES[key]),
        work,
        np.zeros((1, len(RECORD), JOINTS)),
        **law.used_by(lane).kernels,
        step=STEP,
        period=STEP,
    )
    steps = int(seconds / STEP)
    found = np.empty((steps + 1, 3 * LINKS))
    for number in range(steps + 1):
        t = number * STEP
        M[:], h[:] = inertia(work[Q]), bias(work[Q], work[V])
        if sample(t, number, 0, table):
            raise RuntimeError(f"{gains['law']} left its bounds at {t:g} s")
        found[number] = work[[Q, V, TAU], :LINKS].ravel()
        torque = work[TAU].copy()
        torque[:LINKS] += push(t)
        work[[Q, V]] = held_step(work[[Q, V]], torque, STEP)
    if work[[Q, V], LINKS:].any():
        raise RuntimeError(f"{gains['law']} moves joints that should stand still")
    return found
