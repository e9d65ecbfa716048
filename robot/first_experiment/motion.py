"""A motion for an arm of any description: sines around its home, within all its limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from slidetune.robot.arm.known_arm import KnownArm
from slidetune.robot.fields.quantity import bounds
from slidetune.robot.motion.trajectory import SineTrajectory

Array = np.ndarray

OMEGA = 1.0
"""Angular frequency of the sines in [rad/s]: the paper's (*published*)."""
_TURN, _SLIDE = 0.5, 0.1
"""Largest amplitudes in [rad] and in [m] (*ours*)."""
_ROOM = 0.8
"""Part of the way to the nearest limit that a sine may take (*ours*)."""
_SPEED = 0.5
"""Part of the speed limit that it may take (*ours*)."""
TORQUE = 0.7
"""Part of the effort limit that the motion may take (*ours*): the rest is for control."""
_HELD = 1.2
"""Multiple of what holds the home alone that it may take in any case (*ours*)."""
_SHRINKS = 4
"""How often the sines are halved for the sake of that (*ours*)."""
_INSTANTS = 40
"""Instants of one period at which an arm is looked at (*ours*)."""


@dataclass(frozen=True)
class Swing:
    """Sines of all joints, and the arm along them.

    Attributes:
        amplitude: in [rad] or [m]. Shape (n,).
        offset: the pose around which they swing. Shape (n,).
        inertias: mass matrices along them in [kg m^2]. Shape (m, n, n).
        torque: the greatest torque that they take of each joint in [N m] or [N]. Shape (n,).
        load: the torque at the instant at which they take most of all. Shape (n,).
    """

    amplitude: Array
    offset: Array
    inertias: Array
    torque: Array
    load: Array

    def trajectory(self) -> dict[str, object]:
        """Return the section of an experiment."""
        return {
            "kind": "sine",
            "amplitude": self.amplitude.tolist(),
            "angular_frequency": OMEGA,
            "offset": self.offset.tolist(),
        }


def first_motion(arm: KnownArm) -> Swing:
    r"""Return sines around an arm's home.

    .. math:: q_d = q_{home} + A \sin \omega t, \qquad
        A = \min(A_0,\; 0.8\,|q_{limit} - q_{home}|,\; 0.5\,v_{max}/\omega)

    Where they take more than 0.7 of an effort limit, and 1.2 times what holds the home, all
    amplitudes are halved, four times at most.

    Args:
        arm: the arm.
    """
    least, most = bounds(SineTrajectory, "offset")
    home = np.clip(np.array(arm.home), least, most)
    room = np.minimum(home - np.array(arm.lower), np.array(arm.upper) - home)
    widest = np.where(arm.slides, _SLIDE, _TURN)
    amplitude = np.minimum(widest, _ROOM * np.maximum(room, 0.0))
    amplitude = np.minimum(amplitude, _SPEED * np.array(arm.velocity) / OMEGA)
    swing = _along(arm, rounded_down(amplitude), home)
    gravity = np.abs(pin.computeGeneralizedGravity(arm.model, arm.model.createData(), home))
    allowed = np.maximum(TORQUE * np.array(arm.effort), _HELD * gravity)
    for _ in range(_SHRINKS):
        if np.all(swing.torque <= allowed):
            break
        swing = _along(arm, rounded_down(0.5 * swing.amplitude), home)
    return swing


def _along(arm: KnownArm, amplitude: Array, offset: Array) -> Swing:
    model, data = arm.model, arm.model.createData()
    inertias, torques = [], []
    for angle in np.linspace(0.0, 2.0 * np.pi, _INSTANTS, endpoint=False):
        q = offset + amplitude * np.sin(angle)
        v = OMEGA * amplitude * np.cos(angle)
        a = -(OMEGA**2) * amplitude * np.sin(angle)
        upper = np.triu(pin.crba(model, data, q))
        M = upper + np.triu(upper, 1).T
        inertias.append(M)
        torques.append(M @ a + pin.nonLinearEffects(model, data, q, v))
    taken = np.array(torques)
    most = np.abs(taken).max(axis=0)
    heaviest = int(np.argmax((np.abs(taken) / np.maximum(most, 1e-30)).sum(axis=1)))
    return Swing(amplitude, offset, np.array(inertias), most, taken[heaviest])


def rounded_down(values: Array) -> Array:
    """Return positive numbers with two digits, none of them larger than it was."""
    positive = np.maximum(values, 1e-30)
    unit = 10.0 ** (np.floor(np.log10(positive)) - 1.0)
    found = np.floor(positive / unit + 1e-9) * unit
    return np.array([float(f"{value:.2g}") if value > 1e-29 else 0.0 for value in found])
