"""Where a hand has taken the arm, and the force that it pulls with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

Array = np.ndarray


@dataclass(frozen=True)
class Grip:
    """A point of one link.

    Attributes:
        joint: the link moves with this joint, from 1.
        point: in the frame of that joint in [m]. Shape (3,).
    """

    joint: int
    point: Array

    def place(self, model: pin.Model, angles: Array) -> Array:
        """Return where the point is in the base frame in [m]. Shape (3,); of ``angles`` (n,)."""
        place: Array = _placement(model, angles, self.joint).act(self.point)
        return place

    def torque(self, model: pin.Model, data: pin.Data, angles: Array, force: Array) -> Array:
        r"""Return the joint torques of a force at the point: :math:`J^T f`.

        Args:
            model: the arm.
            data: of the model.
            angles: joint angles in [rad]. Shape (n,).
            force: in the base frame in [N]. Shape (3,).

        Returns:
            In [N m], or [N] where a joint slides. Shape (n,).
        """
        pin.computeJointJacobians(model, data, angles)
        axes = pin.LOCAL_WORLD_ALIGNED
        jacobian = pin.getJointJacobian(model, data, self.joint, axes)
        lever = data.oMi[self.joint].rotation @ self.point
        torque: Array = jacobian[:3].T @ force + jacobian[3:].T @ np.cross(lever, force)
        return torque


@dataclass(frozen=True)
class Pull:
    """A force at a point of the arm.

    Attributes:
        grip: where.
        force: in the base frame in [N]. Shape (3,).
    """

    grip: Grip
    force: Array


def grip_at(model: pin.Model, joint: int, place: Array, angles: Array) -> Grip:
    """Return the point of the link of ``joint`` that is at ``place`` [m] in the base frame."""
    return Grip(joint, _placement(model, angles, joint).actInv(place))


def flange_grip(model: pin.Model, tip: str) -> Grip:
    """Return the middle of the flange, a frame of the model."""
    frame = model.frames[model.getFrameId(tip)]
    return Grip(frame.parentJoint, np.array(frame.placement.translation))


def _placement(model: pin.Model, angles: Array, joint: int) -> pin.SE3:
    data = model.createData()
    pin.forwardKinematics(model, data, angles)
    return data.oMi[joint]
