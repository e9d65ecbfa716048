"""RBFNN-NFTSM in plain NumPy, as its author would write it for one arm.

It shares no code with ``robot``: where both agree, the loop is the same. e = q_d - q and
de = v_d - v.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tests.peers.problem import Array, Problem


class Answer(NamedTuple):
    """The controller at one instant: its torque, and how that depends on the state.

    Attributes:
        torque: in [N m]. Shape (6,).
        S: sliding variable in [rad/s]. Shape (6,).
        s_v: its slope in de. Shape (6,); the one in e is nu.
        gain: slope of the torque in S, without the network, in [N m s/rad]. Shape (6,).
        hidden: outputs of the Gaussians. Shape (10, 6).
        acceleration: desired, in [rad/s^2]. Shape (6,).
        de: velocity error in [rad/s]. Shape (6,).
    """

    torque: Array
    S: Array
    s_v: Array
    gain: Array
    hidden: Array
    acceleration: Array
    de: Array


class Controller:
    """RBFNN-NFTSM (Liu et al. 2025, Eq. 5, 19-22), vectorised over joints and nodes."""

    def __init__(self, problem: Problem) -> None:
        """Take the gains of a problem, and work out what no state changes."""
        self.problem = problem
        self.centers = problem.centers[:, None]
        self.sharpness = -0.5 / problem.width**2
        self.peak = problem.amplitude * problem.omega
        self.power = problem.ratio - 1.0
        self.slope = problem.k2 / problem.epsilon

    def __call__(self, t: float, q: Array, v: Array, W: Array) -> Answer:
        """Evaluate torque and slopes at time ``t`` [s]; ``W`` are weights of shape (10, 6)."""
        p = self.problem
        swing = p.amplitude * np.sin(p.omega * t)
        e = swing - q
        de = self.peak * np.cos(p.omega * t) - v
        root = p.mu * np.abs(de) ** self.power
        S = p.nu * e + (p.c + root) * de
        bounded = np.tanh(S / p.epsilon)
        hidden = np.exp(self.sharpness * (e - self.centers) ** 2)
        return Answer(
            torque=np.einsum("nj,nj->j", W, hidden) + p.k1 * S + p.k2 * bounded,
            S=S,
            s_v=p.c + p.ratio * root,
            gain=p.k1 + self.slope * (1.0 - bounded * bounded),
            hidden=hidden,
            acceleration=-p.omega * p.omega * swing,
            de=de,
        )

    def linearized(self, h: float, answer: Answer) -> tuple[Array, Array]:
        r"""Return the damping [N m s/rad] and the torque [N m] of a linearly implicit step.

        .. math:: (M + h\,\mathrm{diag}(damping))\,a = torque - C v - G
        """
        p = self.problem
        squares = np.einsum("nj,nj->j", answer.hidden, answer.hidden)
        # The network answers S as an integrator does: its share of the slope grows with h.
        slope = answer.gain + h * p.learning_rate * squares
        ahead = answer.s_v * answer.acceleration + p.nu * answer.de
        damping = slope * (answer.s_v + h * p.nu)
        torque = answer.torque - p.external + h * slope * ahead
        return damping, torque + (slope - answer.gain) * answer.S

    def learned(self, h: float, answer: Answer, a: Array, W: Array) -> Array:
        """Return the weights after a step with the acceleration ``a`` [rad/s^2]."""
        ahead = answer.s_v * (answer.acceleration - a) + self.problem.nu * (answer.de - h * a)
        return W + answer.hidden * (h * self.problem.learning_rate * (answer.S + h * ahead))
