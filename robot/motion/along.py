"""A desired motion at many times at once."""

from __future__ import annotations

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import QD, VD, WORK_ROWS
from slidetune.robot.motion.trajectory import reference

Array = np.ndarray


@kernel
def _desired_motion(time, numbers, work, q_d, v_d):  # type: ignore[no-untyped-def]
    for row in range(len(time)):
        reference(time[row], numbers, work)
        for j in range(JOINTS):
            q_d[row, j], v_d[row, j] = work[QD, j], work[VD, j]


def desired_motion(trajectory: Array, time: Array, joints: int) -> tuple[Array, Array]:
    """Return q_d [rad] and v_d [rad/s] of a packed trajectory at times in [s]. Shapes (m, n)."""
    q_d, v_d = np.empty((len(time), joints)), np.empty((len(time), joints))
    work = np.zeros((WORK_ROWS, joints))
    for_joints(_desired_motion, joints)(time, trajectory, work, q_d, v_d)
    return q_d, v_d
