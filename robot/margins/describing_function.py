"""What of a swing a switching function passes on at the same frequency."""

from __future__ import annotations

import numpy as np

Array = np.ndarray

_ANGLES = (np.arange(256) + 0.5) * 2.0 * np.pi / 256
"""Angles of one period at which a wave is evaluated (*ours*)."""


def switched(switching: str, S: Array, layer: Array) -> Array:
    """Return tanh(S/epsilon), saturation or sign(S).

    Args:
        switching: tanh, saturation or sign.
        S: sliding variables in [rad/s]. Shape (n, m).
        layer: boundary layers in [rad/s]; sign has none. Shape (n,).
    """
    if switching == "sign":
        return np.asarray(np.sign(S))
    x = S / layer[:, None]
    return np.asarray(np.tanh(x) if switching == "tanh" else np.clip(x, -1.0, 1.0))


def describing_function(switching: str, amplitude: Array, layer: Array) -> Array:
    r"""Return the describing function of a switching function in [s/rad].

    .. math:: N(A) = \frac{1}{\pi A} \int_0^{2\pi} \mathrm{sw}(A\sin\vartheta)
        \sin\vartheta\,d\vartheta, \qquad \mathrm{sign}: \frac{4}{\pi A}, \qquad
        A \to 0: \frac{1}{\epsilon}

    Args:
        switching: tanh, saturation or sign.
        amplitude: amplitudes of S in [rad/s]. Shape (n,).
        layer: boundary layers in [rad/s]; sign has none. Shape (n,).

    Returns:
        Shape (n,).
    """
    if switching == "sign":
        return np.asarray(4.0 / (np.pi * amplitude))
    wave = switched(switching, amplitude[:, None] * np.sin(_ANGLES), layer)
    return np.asarray(2.0 * (wave @ np.sin(_ANGLES)) / (len(_ANGLES) * amplitude))
