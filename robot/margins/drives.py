"""One control period of the arm behind its drives, put together from one step of the arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.drive import held_lag

Array = np.ndarray

ARM = 2 * JOINTS
"""Angles and velocities of a state."""


@dataclass(frozen=True)
class Drives:
    """The lags between command and joint.

    Attributes:
        lag: their time constants in [s]. Shape (6,).
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
                joint. Shape (12, 18).
            width: length of a step in [s].
            steps: steps in a period.
            part: steps, or parts of one, after which the new command arrives.

        Returns:
            The slopes over the state, over the command before and over the one that arrives.
            Shapes (m, m), (m, 6) and (m, 6).
        """
        whole, late = int(part), part % 1.0
        after = steps - whole - (late > 0.0)
        power = np.linalg.matrix_power
        size = ARM + self.count * JOINTS
        found = power(self._step(step, width, 1.0), whole)
        if late > 0.0:
            found = self._step(step, width, late) @ found
        found = (power(self._step(step, width, 0.0), after) @ found)[:size]
        return found[:, :size], found[:, size : size + JOINTS], found[:, size + JOINTS :]

    def _step(self, step: Array, width: float, share: float) -> Array:
        """Return the map of one step over state and commands; the first holds for ``share`` of it.

        Without a lag, that one step is made under the mean of both.
        """
        size = ARM + self.count * JOINTS
        delivered, between = slice(ARM, ARM + JOINTS), slice(size - JOINTS, size)
        whole = np.eye(size + 2 * JOINTS)
        torque = np.zeros((JOINTS, len(whole)))
        for part, first in ((share, size), (1.0 - share, size + JOINTS)):
            command = np.eye(len(whole))[first : first + JOINTS]
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
        whole[:ARM] = step[:, ARM:] @ torque
        whole[:ARM, :ARM] += step[:, :ARM]
        return whole
