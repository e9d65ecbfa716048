"""The loop that a switching function is closed over, as a frequency response.

Everything but the switching term is linear here: the arm behind its drives, the hold, the delay,
the proportional reaching gain, the slope of the surface, friction and the network.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.experiment.simulation import Simulation
from slidetune.robot.kernels.workspace import AD, S_E, S_V, TAU
from slidetune.robot.margins.margin import with_lane
from slidetune.robot.margins.observer_path import ObserverPath, observer_path
from slidetune.robot.margins.period_map import Around, calm
from slidetune.robot.margins.unsampled import as_if_unsampled

Array = np.ndarray

_FREE = 1e-9
"""Torque in [N m] below which there is no switching term (*ours*)."""


def with_layer(packed: Packed, name: str, layer: float | Array) -> Packed:
    """Return the experiment with a lane that switches by tanh within another layer in [rad/s]."""
    epsilon = layer if isinstance(layer, float) else np.asarray(layer, dtype=float).tolist()
    return with_lane(packed, name, switching="tanh", epsilon=epsilon)


@dataclass(frozen=True)
class SwitchingLoop:
    r"""The way from the switching functions of six joints back to their sliding variables.

    .. math:: \dot x = A x + B\,u(t - D), \quad u = (C + P)\,x + K_2\,\mathrm{sw}, \quad
        S = s\,x

    Attributes:
        own: A [1/s]: the arm, its drives, the network. Shape (m, m).
        torque: B: what a commanded torque does. Shape (m, 6).
        rest: C: slopes of what the law asks for but its reaching law. Shape (6, m).
        proportional: P: slopes of the reaching law without its switching term. Shape (6, m).
        gain: K_2 in [N m]: torque of the switching term per unit of sw, behind the inertia where
            the law shapes it. Shape (6, 6).
        surface: s: slopes of S over the state. Shape (6, m).
        delay: D in [s]: input delay and half of the hold.
        hold: for so long a torque is held in [s], 0 in continuous mode.
        fastest: frequency in [rad/s] above which the run shows nothing.
        kappa: how fast its own switching term moves the S of each joint in [rad/s^2], the diagonal
            of Gamma M^-1 K_2; where the law shapes the inertia it is k2. Shape (6,).
        load: mean of sw with which each joint is held on its surface [-]. Shape (6,).
        observer: what it makes of u, ``None`` where there is none.
    """

    own: Array
    torque: Array
    rest: Array
    proportional: Array
    gain: Array
    surface: Array
    delay: float
    hold: float
    fastest: float
    kappa: Array
    load: Array
    observer: ObserverPath | None = None

    def folded(self, omega: Array) -> Array:
        r"""Return how much farther the samples of S swing than a wave of that frequency does.

        They see all frequencies of a held torque's steps, folded onto one. Of an integral:

        .. math:: \frac{\omega T / 2}{\sin(\omega T / 2)}

        which is 1.57 where S changes its sign from sample to sample.

        Args:
            omega: frequencies in [rad/s]. Shape (n,).
        """
        return np.asarray(1.0 / np.sinc(omega * self.hold / (2.0 * np.pi)))

    def response(self, omega: Array, late: float = 0.0, k1: float = 1.0) -> Array:
        r"""Return what a swing of each sw does to -S in [rad/s]: harmonic balance is H N(A) = -1.

        .. math:: H(j\omega) = -s\,(j\omega I - A - e^{-j\omega D} B\,(C + P))^{-1}
            B K_2\,e^{-j\omega D}

        For one joint without k1, surface slope and friction it is the textbook's

        .. math:: \frac{\kappa}{j\omega}\,\frac{e^{-j\omega(T/2 + T_{delay})}}
            {(1 + j\omega\tau_{lag})^n}

        Args:
            omega: frequencies in [rad/s]. Shape (n,).
            late: further delay in [s].
            k1: share of the proportional reaching gain. Without it the curve has no resonance, and
                for one joint it is real at the same frequencies.

        Returns:
            Shape (n, 6, 6).
        """
        turn = np.exp(-1j * omega * (self.delay + late))[:, None, None]
        size = len(self.own)
        matrix = 1j * omega[:, None, None] * np.eye(size) - self.own
        asked, gain = self.rest + k1 * self.proportional, self.gain
        if self.observer is not None:
            factor, motion = self.observer.passed(omega)
            asked, gain = factor[:, :, None] * asked, factor[:, :, None] * gain
            asked[:, :, : motion.shape[2]] += motion
        moved = np.linalg.solve(matrix - turn * (self.torque @ asked), turn * (self.torque @ gain))
        return np.asarray(-self.surface @ moved)


def switching_loop(packed: Packed, name: str, time: float) -> SwitchingLoop:
    """Return the loop around a lane's switching functions, linear about the desired motion.

    Args:
        packed: the experiment as numbers.
        name: the lane, one that ``as_plain`` returned.
        time: when along the desired motion, in [s].
    """
    simulation = packed.experiment.simulation
    # A layer of 1 rad/s: the slope of its tanh at S = 0 is k2 itself.
    unit = calm(as_if_unsampled(with_layer(packed, name, 1.0), name))
    observed = getattr(packed.experiment.lanes[name], "observer", "none") != "none"
    if observed:
        unit = with_lane(unit, name, observer="none")
    outside = with_layer(unit, name, np.inf).gains[name]
    around = Around(unit, name, time)
    # On the surface, before its differences are taken.
    S_v, S_e, asked, a_d = (around.work[row].copy() for row in (S_V, S_E, TAU, AD))
    missing = around.load - asked
    missing[around.learning] = 0.0
    if observed:
        missing[:] = 0.0  # it carries what the law lacks
    linear = around.map(outside)
    period = linear.timing.period
    velocities = slice(packed.joints, 2 * packed.joints)
    surface = np.zeros((packed.joints, len(linear.own)))
    surface[:, : packed.joints], surface[:, velocities] = np.diag(-S_e), np.diag(-S_v)
    gain = linear.switching[:, velocities] / -S_v
    M = pin.crba(packed.model, packed.model.createData(), around.q)
    return SwitchingLoop(
        own=(linear.own - np.eye(len(linear.own))) / period,
        torque=(linear.early + linear.late) / period,
        rest=linear.rest,
        proportional=linear.proportional,
        gain=gain,
        surface=surface,
        delay=_delay(simulation),
        hold=simulation.hold,
        fastest=np.pi / simulation.row_period,
        kappa=S_v * np.diagonal(np.linalg.solve(M, gain)),
        load=_load(missing, gain),
        observer=observer_path(packed, name, (around.q, around.v, a_d)),
    )


def _delay(simulation: Simulation) -> float:
    """Return the mean delay of a sampled torque in [s]; continuous mode knows none."""
    return simulation.input_delay + 0.5 * simulation.hold if simulation.hold else 0.0


def _load(missing: Array, gain: Array) -> Array:
    """Return the mean of sw that makes up for the torque that a law lacks. Shape (6,)."""
    acts = np.abs(gain).sum(axis=0) > _FREE
    load = np.zeros(len(acts))
    load[acts] = np.linalg.lstsq(gain[:, acts], missing, rcond=None)[0]
    return load
