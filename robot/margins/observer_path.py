"""What a disturbance observer makes of a torque and of a motion, as a frequency response."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from slidetune.robot.experiment.packed import Packed

Array = np.ndarray


@dataclass(frozen=True)
class ObserverPath:
    r"""The observer of a lane around the desired motion.

    With r subtracted from what the rest of the law asks for, u_0, and :math:`z = e^{j\omega T}`:

    .. math:: r = \frac{a\,[M (1 - z^{-1}) \dot q / T + z^{-1} (h - u)]}{1 - (1 - a) z^{-1}},
        \quad u = \frac{1 - (1 - a) z^{-1}}{1 - z^{-1}}\,u_0
        - a\,\frac{M}{T}\,\dot q - \frac{a\,z^{-1}}{1 - z^{-1}}\,h

    It is an integral of u_0 and a damping. Without a control period, T being 0:

    .. math:: u = \left(1 + \frac{K_o}{j\omega}\right) u_0 - K_o M \dot q
        - \frac{K_o}{j\omega}\,h

    Attributes:
        inertia: M of the nominal arm. Shape (6, 6).
        bias: slopes of its M a_d + C v + G over angle and velocity. Shape (6, 12).
        rate: K_o in [1/s], a/T where it is sampled. Shape (6,).
        period: T in [s].
    """

    inertia: Array
    bias: Array
    rate: Array
    period: float

    def passed(self, omega: Array) -> tuple[Array, Array]:
        """Return what it makes of the torque that the rest of a law asks for, and of the motion.

        Args:
            omega: frequencies in [rad/s]. Shape (n,).

        Returns:
            The factor of that torque, shape (n, 6); the torque that it adds over angle and
            velocity, shape (n, 6, 12). Above half the control rate it adds nothing.
        """
        turn = np.exp(-1j * omega * self.period)
        rises = 1j * omega if self.period == 0.0 else (1.0 - turn) / self.period
        seen = (omega * self.period <= np.pi) / np.where(rises == 0.0, 1.0, rises)
        summed = seen[:, None] * self.rate
        motion = -(summed * turn[:, None])[:, :, None] * self.bias
        velocity = (summed * rises[:, None])[:, :, None] * self.inertia
        motion[:, :, len(self.inertia) :] -= velocity
        return 1.0 + summed * turn[:, None], motion


def observer_path(
    packed: Packed, name: str, motion: tuple[Array, Array, Array]
) -> ObserverPath | None:
    """Return the observer of a lane, ``None`` where it has none.

    Time-delay estimation takes the step for its delay in continuous mode.

    Args:
        packed: the experiment as numbers.
        name: the lane.
        motion: desired angles, velocities and accelerations. Shapes (6,).
    """
    lane: Any = packed.experiment.lanes[name]
    kind = getattr(lane, "observer", "none")
    if kind == "none":
        return None
    simulation = packed.experiment.simulation
    period = simulation.hold
    rate = np.broadcast_to(np.asarray(lane.observer_rate, dtype=float), packed.joints)
    if kind == "time_delay":
        period = period or simulation.step
        rate = np.full(packed.joints, 1.0 / period)
    elif period > 0.0:
        rate = -np.expm1(-rate * period) / period
    model = packed.nominal or packed.model
    # What it returns are views of these data, which must outlive them.
    data = model.createData()
    over_q, over_v, M = pin.computeRNEADerivatives(model, data, *motion)
    inertia = np.triu(M) + np.triu(M, 1).T
    return ObserverPath(inertia, np.hstack([over_q, over_v]), rate, period)
