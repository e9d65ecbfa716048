"""What a law makes of S besides what is linear, and what of a swing of S it passes on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

_ANGLES = (np.arange(256) + 0.5) * 2.0 * np.pi / 256
"""Angles of one period at which a wave is evaluated (*ours*)."""
_SMALLEST, _LARGEST, _HALVINGS = 1e-12, 1e6, 60
"""Amplitudes in [rad/s] between which a balance is looked for, and in how many steps (*ours*)."""
_ROOT = 1.1128
"""The describing function of |S|^½ sign(S) is this over the root of the amplitude (Boiko 2009)."""


@dataclass(frozen=True)
class SwitchingTerm:
    r"""The switching terms of several joints, per unit of the gain behind which they stand.

    A switching function sw(S), or that of super-twisting, whose second part is integrated:

    .. math:: k_1 |S|^{1/2} \operatorname{sign} S + z, \qquad \dot z = k_2 \operatorname{sign} S

    Attributes:
        switching: tanh, saturation, sign or twisting.
        layer: boundary layers in [rad/s]; the last two have none. Shape (n,).
        root: k_1 of super-twisting; of no meaning elsewhere. Shape (n,).
        rate: its k_2 in [rad/s^3]. Shape (n,).
    """

    switching: str
    layer: Array
    root: Array
    rate: Array

    @classmethod
    def within(cls, switching: str, layer: Array) -> SwitchingTerm:
        """Return a switching function with its layers in [rad/s], shape (n,)."""
        return cls(switching, layer, np.zeros_like(layer), np.zeros_like(layer))

    @property
    def twisting(self) -> bool:
        """Whether it is that of super-twisting."""
        return self.switching == "twisting"

    @property
    def has_layer(self) -> bool:
        """Whether it is linear near S = 0."""
        return self.switching in ("tanh", "saturation")

    def acts(self, joint: int) -> bool:
        """Whether the term of a joint, from 0, is one: gains of 0 leave none of super-twisting."""
        return not self.twisting or bool(self.root[joint] or self.rate[joint])

    def of(self, joints: list[int]) -> SwitchingTerm:
        """Return the terms of some of its joints, from 0."""
        return SwitchingTerm(
            self.switching, self.layer[joints], self.root[joints], self.rate[joints]
        )

    def switched(self, S: Array) -> Array:
        """Return what passes at once: sw(S), or k1 times the root.

        Args:
            S: sliding variables in [rad/s]. Shape (n, m).
        """
        if self.twisting:
            return np.asarray(self.root[:, None] * np.sqrt(np.abs(S)) * np.sign(S))
        if self.switching == "sign":
            return np.asarray(np.sign(S))
        x = S / self.layer[:, None]
        return np.asarray(np.tanh(x) if self.switching == "tanh" else np.clip(x, -1.0, 1.0))

    def describing_function(self, amplitude: Array, omega: float | Array, hold: float) -> Array:
        r"""Return how a swing comes out of it, over that swing.

        .. math:: N(A) = \frac{1}{\pi A} \int_0^{2\pi} \mathrm{sw}(A\sin\vartheta)
            \sin\vartheta\,d\vartheta, \qquad \mathrm{sign}: \frac{4}{\pi A}, \qquad
            A \to 0: \frac{1}{\epsilon}

        Super-twisting turns a swing the more the slower it is (Boiko, *Discontinuous Control
        Systems*, 2009):

        .. math:: N(A, \omega) = \frac{1.11\,k_1}{\sqrt A}
            + \frac{4 k_2}{\pi A}\,\frac{1}{j\omega}

        Args:
            amplitude: amplitudes of S in [rad/s]. Shape (n,).
            omega: their frequency in [rad/s].
            hold: for so long a sample is held in [s], 0 in continuous mode.

        Returns:
            In [s/rad], of super-twisting in [1/s]. Shape (n,), complex.
        """
        if self.twisting:
            turned = 4.0 / np.pi * self.rate / amplitude * integrator(omega, hold)
            return np.asarray(_ROOT * self.root / np.sqrt(amplitude) + turned)
        if self.switching == "sign":
            return np.asarray(4.0 / (np.pi * amplitude), complex)
        wave = self.switched(amplitude[:, None] * np.sin(_ANGLES))
        passed = 2.0 * (wave @ np.sin(_ANGLES)) / (len(_ANGLES) * amplitude)
        return np.asarray(passed, complex)

    def balanced_amplitude(self, joint: int, size: Array, omega: Array, hold: float) -> Array:
        """Return the amplitude in [rad/s] at which super-twisting passes a swing on by 1/size.

        Args:
            joint: which joint, from 0.
            size: :math:`|H|`. Shape (m,).
            omega: frequencies in [rad/s]. Shape (m,).
            hold: for so long a sample is held in [s].
        """
        one = self.of([joint])
        low, high = np.full_like(size, _SMALLEST), np.full_like(size, _LARGEST)
        for _ in range(_HALVINGS):
            middle = np.sqrt(low * high)
            more = np.abs(one.describing_function(middle, omega, hold)) * size > 1.0
            low, high = np.where(more, middle, low), np.where(more, high, middle)
        return np.asarray(low)


def integrator(omega: float | Array, hold: float) -> Array:
    r"""Return what an integral does to a swing in [s]: sampled, a sum of the samples before.

    .. math:: \frac{1}{j\omega}, \qquad \frac{T}{e^{j\omega T} - 1}

    Args:
        omega: frequencies in [rad/s].
        hold: T in [s], 0 in continuous mode.
    """
    if hold == 0.0:
        return np.asarray(1.0 / (1j * np.asarray(omega)))
    return np.asarray(hold / (np.exp(1j * np.asarray(omega) * hold) - 1.0))
