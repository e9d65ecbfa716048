"""One control period of the arm behind its drives, put together from one step of the arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.integrator.drive import held_lag

Array = np.ndarray


@dataclass(frozen=True)
class Drives:
    """The lags between command and joint.

    Attributes:
        lag: their time constants in [s]. Shape (n,).
        count: how many of them are in series, 0 to 2.
    """

    lag: Array
    count: int

    def period(
        self, step: Array, width: float, steps: int, part: float
    ) -> tuple[Array, Array, Array]:
        """Return slopes of arm and drives after a period over themselves and the two commands.

        Every step is the one at the period's beginning: a pose that went on while time stands
        would let a loop without stiffness drift where the real one does not.

        Args:
            step: slopes of angle and velocity after a step over themselves and the torque at the
                joint. Shape (2n, 3n).
            width: length of a step in [s].
            steps: steps in a period.
            part: steps, or parts of one, after which the new command arrives.

        Returns:
            The slopes over the state, over the command before and over the one that arrives.
            Shapes (m, m), (m, n) and (m, n).
        """
        whole, late = int(part), part % 1.0
        after = steps - whole - (late > 0.0)
        power = np.linalg.matrix_power
        joints = len(self.lag)
        size = (2 + self.count) * joints
        found = power(self._step(step, width, 1.0), whole)
        if late > 0.0:
            found = self._step(step, width, late) @ found
        found = (power(self._step(step, width, 0.0), after) @ found)[:size]
        return found[:, :size], found[:, size : size + joints], found[:, size + joints :]

    def _step(self, step: Array, width: float, share: float) -> Array:
        """Return the map of one step over state and commands; the first holds for ``share`` of it.

        Without a lag, that one step is made under the mean of both.
        """
        joints = len(self.lag)
        arm, size = 2 * joints, (2 + self.count) * joints
        delivered, between = slice(arm, arm + joints), slice(size - joints, size)
        whole = np.eye(size + 2 * joints)
        torque = np.zeros((joints, len(whole)))
        for part, first in ((share, size), (1.0 - share, size + joints)):
            command = np.eye(len(whole))[first : first + joints]
            torque += part * command
            if self.count == 0 or part == 0.0:
                continue
            factors = np.array([held_lag(part * width, lag) for lag in self.lag])
            left, passed, mean, mean_between = factors.T[:, :, None]
            last = whole[delivered] - command
            ahead = whole[between] - command if self.count == 2 else np.zeros_like(last)
            torque += part * (mean * last + mean_between * ahead)
            whole[delivered] = command + left * last + passed * ahead
            if self.count == 2:
                whole[between] = command + left * ahead
        whole[:arm] = step[:, arm:] @ torque
        whole[:arm, :arm] += step[:, :arm]
        return whole
