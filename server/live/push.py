"""What a person does to the arm: a kick from the screen, a pull at one of its links."""

from __future__ import annotations

from math import ceil

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.kernels.workspace import PUSH, Q
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.pull import Pull

Array = np.ndarray

KICK = (60.0, 60.0, 40.0, 10.0, 5.0, 2.0)
"""Torque of a kick of the shipped arm where none is given in [N m] (*ours*)."""
KICKED = 3.0
"""Acceleration that a kick gives each joint of another arm in [rad/s^2] or [m/s^2] (*ours*)."""
ROUNDING = 1e-6
"""Part of a step by which the end of a kick may be off (*ours*)."""
KICK_DURATION = 0.1
"""How long a kick lasts where nothing is said in [s] (*ours*)."""


def torque_of_kick(torque: tuple[float, ...] | None, packed: Packed) -> Array:
    """Return the torque in [N m] of a kick, by default one that fits the arm. Shape (n,).

    Raises:
        InvalidExperimentError: if the arm has another number of joints.
    """
    joints = packed.joints
    if torque is not None and len(torque) != joints:
        text = f"must have a number for each of the arm's {joints} joints, got {len(torque)}"
        raise InvalidExperimentError([FieldError("torque", text, list(torque))])
    return _usual_kick(packed) if torque is None else np.array(torque)


def _usual_kick(packed: Packed) -> Array:
    arm = arm_named(packed.experiment.robot.model)
    if arm.name == SHIPPED:
        return np.array(KICK)
    model = packed.model
    torque: Array = KICKED * np.diag(pin.crba(model, model.createData(), np.array(arm.home)))
    return torque


class Push:
    """The torque that a person puts on the joints of every lane."""

    def __init__(self) -> None:
        """Start without any."""
        self.clear()

    def clear(self) -> None:
        """Let go."""
        self._torque = np.zeros(())
        self._begin = self._until = -1.0
        self._active = True

    def kick(self, torque: Array, begin: float, duration: float) -> None:
        """Push with ``torque`` [N m] from simulated time ``begin`` [s] on for ``duration`` [s]."""
        self._torque, self._active = torque, True
        self._begin, self._until = begin, begin + duration

    def go_back(self, time: float) -> None:
        """Forget a kick that comes after ``time`` [s]; one that was under way then goes on."""
        if time <= self._begin:
            self.clear()

    def apply(self, loop: ClosedLoop, pull: Pull | None, count: int) -> int:
        r"""Set the push of every lane for its next steps: the kick plus :math:`J^T f`.

        Args:
            loop: the closed loop.
            pull: the force on the same point of every lane's arm, or ``None``.
            count: how many steps are to be made.

        Returns:
            How many of them to make before it is set again: a kick ends between two of them.
        """
        rest = ceil((self._until - loop.time) / loop.period - ROUNDING)
        kicked = rest > 0
        steps = min(count, rest) if kicked else count
        if not (kicked or pull is not None or self._active):
            return steps
        self._active = kicked or pull is not None
        model = loop.packed.model
        data = model.createData() if pull is not None else None
        for lane in loop.lanes.values():
            torque = np.zeros(loop.packed.joints)
            if kicked:
                torque += self._torque
            if pull is not None:
                torque += pull.grip.torque(model, data, lane.work[Q], pull.force)
            lane.work[PUSH] = torque
        return steps
