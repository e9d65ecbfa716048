"""A lane's law asked at states of our choice, through its own kernel."""

from __future__ import annotations

import numpy as np

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.environment.external_torque import external_torque
from slidetune.robot.environment.layout import SENSOR_Q, SENSOR_V
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.integrator.kernel_arrays import kernel_table
from slidetune.robot.integrator.law_call import checked
from slidetune.robot.integrator.stages import sample
from slidetune.robot.kernels.for_joints import for_joints
from slidetune.robot.kernels.workspace import CURRENT, RECORD, S_E, S_V, TAU, WORK_ROWS, F, Q, S, V
from slidetune.robot.laws import law_of
from slidetune.robot.laws.terms.equivalent_control import equivalent_control
from slidetune.robot.motion.trajectory import QUINTIC

Array = np.ndarray


class Probe:
    """One lane's law, with a workspace of its own.

    Sensor noise is off: what is asked is what the law says, not what it measured.
    """

    def __init__(self, packed: Packed, name: str) -> None:
        """Bind the law of the lane ``name``."""
        law = law_of(packed.experiment.lanes[name])
        self._environment = packed.environment.copy()
        self._environment[[SENSOR_Q, SENSOR_V], 0] = 0.0
        joints = packed.joints
        self._sample, self._equivalent_control, self._external_torque = (
            for_joints(one, joints) for one in (sample, equivalent_control, external_torque)
        )
        self._work = np.zeros((WORK_ROWS, joints))
        self._arm = dynamics(packed.model, self._work[CURRENT + Q], self._work[CURRENT + V])
        hold = np.concatenate([[QUINTIC, 1.0], np.zeros(2 * joints)])
        gains, record = packed.gains[name], np.zeros((1, len(RECORD), joints))
        self._at_rest, self._on_the_way = (
            kernel_table(
                self._arm,
                self._arm,
                gains,
                self._environment,
                trajectory,
                self._work,
                record,
                **law.kernels,
            )
            for trajectory in (hold, packed.trajectory)
        )
        # A law that remembers begins on its surface; without a period nothing moves that on.
        self._ask(0.0, self._at_rest)

    def _ask(self, t: float, table: Array) -> Array:
        self._arm.refill()
        checked(self._sample(t, 0, 0, table))
        return self._work

    def surface(self, e: Array, de: Array) -> tuple[Array, Array, Array]:
        """Return S and its slopes at an error and a velocity error.

        Args:
            e: error in [rad]. Shape (6,).
            de: velocity error in [rad/s]. Shape (6,).

        Returns:
            S [rad/s], dS/de [1/s] (over the error) and dS/d(de). Shapes (6,).
        """
        self._work[CURRENT + Q], self._work[CURRENT + V] = np.negative(e), np.negative(de)
        work = self._ask(0.0, self._at_rest)
        return work[S].copy(), work[S_E].copy(), work[S_V].copy()

    def needed_torque(self, t: float, q: Array, v: Array) -> Array:
        r"""Return the torque under which S stands still on the true arm (Eq. 9, corrected, and F).

        .. math:: \tau_{eq} + F = M(\ddot q_d + \nu\,\Gamma^{-1}\dot e) + C\dot q + G + F

        It is what a controller would ask for that knew the arm and the disturbance exactly.

        Args:
            t: time in [s].
            q: joint angles in [rad]. Shape (6,).
            v: joint velocities in [rad/s]. Shape (6,).

        Returns:
            Torque in [N m]. Shape (6,).
        """
        self._work[CURRENT + Q], self._work[CURRENT + V] = q, v
        work = self._ask(t, self._on_the_way)
        self._equivalent_control(self._arm.inertia, self._arm.bias, work)
        self._external_torque(t, 0.0, CURRENT, self._environment, work)
        needed: Array = work[TAU] + work[F]
        return needed
