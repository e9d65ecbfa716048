"""Wirings of arrays of our choice, for tests of single kernels."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.dynamics import Dynamics
from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import pack_environment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.kernel_arrays import kernel_table
from slidetune.robot.integrator.law_call import Control
from slidetune.robot.kernels.workspace import RECORD, WORK_ROWS
from slidetune.robot.motion.trajectory import HoldTrajectory, pack_trajectory

Array = np.ndarray


def arm_of(inertia: Array, bias: Array) -> Dynamics:
    """An arm that has been evaluated elsewhere."""
    model = pin.Model()
    return Dynamics(
        model,
        model.createData(),
        lambda: None,
        np.ascontiguousarray(inertia),
        np.ascontiguousarray(bias),
    )


def table_of(
    work: Array | None = None,
    *,
    arm: Dynamics | None = None,
    gains: Array | None = None,
    environment: Array | None = None,
    trajectory: Array | None = None,
    record: Array | None = None,
    step: float = 0.0,
    period: float = 0.0,
    control: Control | None = None,
) -> Array:
    """A table of what is given: the rest is an arm of unit inertia at rest, undisturbed."""
    arm = arm or arm_of(np.eye(JOINTS), np.zeros(JOINTS))
    return kernel_table(
        arm,
        arm,
        np.zeros((1, JOINTS)) if gains is None else gains,
        pack_environment(Disturbance(), 0.0, 0.0, None) if environment is None else environment,
        pack_trajectory(HoldTrajectory()) if trajectory is None else trajectory,
        np.zeros((WORK_ROWS, JOINTS)) if work is None else work,
        np.zeros((1, len(RECORD), JOINTS)) if record is None else record,
        control=control,
        step=step,
        period=period,
    )
