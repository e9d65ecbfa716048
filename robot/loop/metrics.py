"""How good a lane is, in numbers."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel

Array = np.ndarray

HIGH_FREQUENCY = 50.0
"""Frequency [Hz] above which torque counts as chattering (*ours*)."""


@dataclass(frozen=True)
class Metrics:
    """Figures of one lane over a span of time; NaN where the span holds no row.

    Attributes:
        mae: mean absolute error in [rad]. Shape (6,).
        max_error: greatest absolute error in [rad]. Shape (6,).
        max_velocity_error: greatest absolute velocity error in [rad/s]. Shape (6,).
        chattering: total variation of the torque of all joints a second in [N m/s].
        high_frequency_torque: effective torque above 50 Hz, root sum of squares over the joints, in
            [N m]; ``None`` where the span is too short or too slow to tell.
        peak_torque: greatest absolute torque in [N m]. Shape (6,).
        reaching_time: when S first was reached in [s], ``None`` for never, per joint; see
            ``reaching_times``. Shape (6,).
        flange_rms: effective distance of the flange from the desired one in [m].
        flange_max: greatest distance in [m].
        diverged_at: when the lane left its bounds in [s], or ``None``.
    """

    mae: Array
    max_error: Array
    max_velocity_error: Array
    chattering: float
    high_frequency_torque: float | None
    peak_torque: Array
    reaching_time: tuple[float | None, ...]
    flange_rms: float
    flange_max: float
    diverged_at: float | None = None

    def document(self) -> dict[str, Any]:
        """Return the figures as plain JSON values, ``None`` for what is not known."""
        return {key: _plain(value) for key, value in asdict(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return [_plain(one) for one in value.tolist()]
    return None if isinstance(value, float) and np.isnan(value) else value


NO_FIGURES = Metrics(
    mae=np.full(JOINTS, np.nan),
    max_error=np.full(JOINTS, np.nan),
    max_velocity_error=np.full(JOINTS, np.nan),
    chattering=np.nan,
    high_frequency_torque=None,
    peak_torque=np.full(JOINTS, np.nan),
    reaching_time=(None,) * JOINTS,
    flange_rms=np.nan,
    flange_max=np.nan,
)
"""Figures of a span without a row."""


def total_variation(torque: Array, period: float) -> float:
    r"""Return the total variation of all joints' torque a second in [N m/s].

    .. math:: \frac{1}{T} \sum_i \sum_k |\tau_i[k+1] - \tau_i[k]|

    Args:
        torque: torque in [N m]. Shape (n, 6).
        period: time between two rows in [s].
    """
    if len(torque) < 2:
        return 0.0
    return float(np.abs(np.diff(torque, axis=0)).sum() / ((len(torque) - 1) * period))


def torque_spectrum(torque: Array, period: float) -> tuple[Array, Array] | None:
    """Return the power spectral density of each joint's torque, by Welch's method.

    Segments of a second, half of each in the next, without their linear trend: what
    ``scipy.signal.welch`` gives, in a quarter of its time.

    Args:
        torque: torque in [N m]. Shape (n, 6).
        period: time between two rows in [s].

    Returns:
        Frequency in [Hz] from 0, evenly spaced, shape (m,), and density in [(N m)^2/Hz], shape
        (m, 6); ``None`` where sampling is too slow for 50 Hz or the span shorter than 0.25 s.
    """
    rate = 1.0 / period
    if rate <= 2.0 * HIGH_FREQUENCY or len(torque) * period < 0.25:
        return None
    segment = min(len(torque), max(256, int(rate)))
    window = _window(segment)
    pieces = sliding_window_view(torque, segment, axis=0)[:: segment - segment // 2]
    centred = np.arange(segment) - 0.5 * (segment - 1)
    slope = pieces @ centred / (centred @ centred)
    straight = pieces.mean(axis=-1)[..., None] + slope[..., None] * centred
    spectra = np.fft.rfft((pieces - straight) * window)
    power = (spectra.real**2 + spectra.imag**2).mean(axis=0) / (rate * (window @ window))
    # One side stands for both, but for the constant and, where there is one, the highest frequency.
    power[:, 1 : (segment + 1) // 2] *= 2.0
    return np.fft.rfftfreq(segment, period), power.T


@lru_cache(maxsize=8)
def _window(size: int) -> Array:
    """Return a Blackman-Harris window, which lets nothing of a slow swing leak past 50 Hz."""
    from scipy import signal  # here, because it takes most of a second to import

    return np.asarray(signal.get_window("blackmanharris", size))


def high_frequency_torque(torque: Array, period: float) -> float | None:
    """Return the effective torque above 50 Hz in [N m], root sum of squares over the joints.

    Args:
        torque: torque in [N m]. Shape (n, 6).
        period: time between two rows in [s].

    Returns:
        The figure, or ``None`` where sampling is too slow or the span shorter than 0.25 s.
    """
    spectrum = torque_spectrum(torque, period)
    if spectrum is None:
        return None
    frequency, power = spectrum
    above = frequency >= HIGH_FREQUENCY
    return float(np.sqrt(power[above].sum() * (frequency[1] - frequency[0])))


def reaching_times(time: Array, sliding: Array, layer: Array) -> tuple[float | None, ...]:
    """Return when each joint's sliding variable was first within its layer, or beyond zero, in [s].

    A sampled loop can carry S across a thin layer between two rows: the row after that counts.

    Args:
        time: time in [s]. Shape (n,).
        sliding: sliding variable in [rad/s]. Shape (n, 6).
        layer: within which S counts as reached in [rad/s], 0 where nothing tries. Shape (6,).
    """
    inside = np.abs(sliding) <= layer
    inside |= sliding * sliding[:1] < 0.0
    inside &= layer > 0.0
    return tuple(float(time[np.argmax(column)]) if column.any() else None for column in inside.T)


@kernel
def _sums_and_peaks(error, velocity_error, torque, out):  # type: ignore[no-untyped-def]
    """Write each joint's sum of ``|e|`` in [rad] and the greatest ``|e|``, ``|de|``, torque."""
    for row in range(len(error)):
        for j in range(JOINTS):
            size = abs(error[row, j])
            out[0, j] += size
            out[1, j] = max(out[1, j], size)
            out[2, j] = max(out[2, j], abs(velocity_error[row, j]))
            out[3, j] = max(out[3, j], abs(torque[row, j]))


def measure_lane(
    time: Array, columns: dict[str, Array], layer: Array, diverged_at: float | None = None
) -> Metrics:
    """Return the figures of one lane.

    Args:
        time: time in [s], evenly spaced. Shape (n,).
        columns: ``e``, ``de``, ``tau``, ``S`` of shape (n, 6); ``flange`` and ``flange_desired`` of
            shape (n, 3).
        layer: within which S counts as reached in [rad/s]. Shape (6,).
        diverged_at: when the lane left its bounds in [s], or ``None``.
    """
    if not len(time):
        return replace(NO_FIGURES, diverged_at=diverged_at)
    period = float(time[1] - time[0]) if len(time) > 1 else 1.0
    torque, way = columns["tau"], columns["flange"] - columns["flange_desired"]
    distance = np.sqrt(np.einsum("ij,ij->i", way, way))
    figures = np.zeros((4, JOINTS))
    _sums_and_peaks(columns["e"], columns["de"], torque, figures)
    return Metrics(
        mae=figures[0] / len(time),
        max_error=figures[1],
        max_velocity_error=figures[2],
        chattering=total_variation(torque, period),
        high_frequency_torque=high_frequency_torque(torque, period),
        peak_torque=figures[3],
        reaching_time=reaching_times(time, columns["S"], layer),
        flange_rms=float(np.sqrt(np.mean(distance**2))),
        flange_max=float(distance.max()),
        diverged_at=diverged_at,
    )
