"""How good a lane is, in numbers."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from slidetune.robot.kernels.compiler import kernel

Array = np.ndarray

DEADBAND = 0.01
"""Way back of the torque in [N m] that makes a reversal (*ours*): far above the rounding of a
solved step, far below what a drive resolves."""
SHORTEST = 0.25
"""Shortest span in [s] whose torque has a spectrum (*ours*)."""
FEWEST_CYCLES = 12.5
"""Fewest cycles of the bounding frequency in that span (*ours*): the window's main lobe is four
frequencies wide to each side, so that the motion itself stays below the bound."""


@dataclass(frozen=True)
class Metrics:
    """Figures of one lane over a span of time; NaN where the span holds no row.

    Attributes:
        mae: mean absolute error in [rad]. Shape (6,).
        max_error: greatest absolute error in [rad]. Shape (6,).
        max_velocity_error: greatest absolute velocity error in [rad/s]. Shape (6,).
        chattering: total variation of the torque of all joints a second in [N m/s].
        switches: reversals of the torque a second, see ``follow_torque``, in [1/s]. Shape (6,).
        high_frequency_torque: effective torque above the experiment's ``high_frequency``, root sum
            of squares over the joints, in [N m]; ``None`` where the span is too short or its rows
            too slow to tell.
        peak_torque: greatest absolute torque in [N m]. Shape (6,).
        reaching_time: when S first was reached in [s], ``None`` for never, per joint; see
            ``reaching_times``. Shape (6,).
        flange_rms: effective distance of the flange from the desired one in [m].
        flange_max: greatest distance in [m].
        rms_torque: effective torque of the rows in [N m], each of which stands for one step, as in
            all means. The control effort, the integral of its square, is ``rms_torque**2`` times
            the rows times the step: exactly, where the torque is held over each step; of a
            continuous one half a step of the first and the last row more than by the trapezoidal
            rule. Shape (6,).
        itae: integral of time, from the begin of the span, times absolute error (ITAE; Graham and
            Lathrop 1953), by the trapezoidal rule, in [rad s^2]. Shape (6,).
        diverged_at: when the lane left its bounds in [s], or ``None``.
    """

    mae: Array
    max_error: Array
    max_velocity_error: Array
    chattering: float
    switches: Array
    high_frequency_torque: float | None
    peak_torque: Array
    reaching_time: tuple[float | None, ...]
    flange_rms: float
    flange_max: float
    rms_torque: Array
    itae: Array
    diverged_at: float | None = None

    def document(self) -> dict[str, Any]:
        """Return the figures as plain JSON values, ``None`` for what is not known."""
        return {key: _plain(value) for key, value in asdict(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return [_plain(one) for one in value.tolist()]
    return None if isinstance(value, float) and np.isnan(value) else value


def no_figures(joints: int) -> Metrics:
    """Return the figures of a span without a row."""
    none = np.full(joints, np.nan)
    return Metrics(
        mae=none,
        max_error=none,
        max_velocity_error=none,
        chattering=np.nan,
        switches=none,
        high_frequency_torque=None,
        peak_torque=none,
        reaching_time=(None,) * joints,
        flange_rms=np.nan,
        flange_max=np.nan,
        rms_torque=none,
        itae=none,
    )


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


def torque_spectrum(torque: Array, period: float, above: float) -> tuple[Array, Array] | None:
    """Return the power spectral density of each joint's torque, by Welch's method.

    Segments of a second, half of each in the next, without their linear trend: what
    ``scipy.signal.welch`` gives, in a quarter of its time.

    Args:
        torque: torque in [N m]. Shape (n, 6).
        period: time between two rows in [s].
        above: frequency in [Hz] above which it has to tell something.

    Returns:
        Frequency in [Hz] from 0, evenly spaced, shape (m,), and density in [(N m)^2/Hz], shape
        (m, 6); ``None`` where half the rate of the rows is not above ``above``, or the span is
        shorter than 0.25 s or 12.5 cycles of it.
    """
    rate = 1.0 / period
    if rate <= 2.0 * above or len(torque) * period < max(SHORTEST, FEWEST_CYCLES / above):
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
    """Return a Blackman-Harris window, whose side lobes let nothing of a slow swing through."""
    from scipy import signal  # here, because it takes most of a second to import

    return np.asarray(signal.get_window("blackmanharris", size))


def high_frequency_torque(torque: Array, period: float, above: float) -> float | None:
    r"""Return the effective torque above a frequency in [N m], root sum of squares over the joints.

    By Parseval's theorem the mean square of a signal is the integral of its power density.

    .. math:: \sqrt{\sum_i \int_{f_h}^{1/2T} P_i(f)\,df}

    Args:
        torque: torque in [N m]. Shape (n, 6).
        period: time between two rows in [s].
        above: that frequency in [Hz].

    Returns:
        The figure, or ``None`` where there is no spectrum of it; see ``torque_spectrum``.
    """
    spectrum = torque_spectrum(torque, period, above)
    if spectrum is None:
        return None
    frequency, power = spectrum
    return float(np.sqrt(power[frequency >= above].sum() * (frequency[1] - frequency[0])))


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


DIRECTION, HIGHEST, LOWEST = 0, 1, 2
"""Rows of what ``follow_torque`` remembers of a torque: its direction (1 up, -1 down, 0 not known
yet), and its highest and lowest value [N m] since it turned, of which it needs the last extreme."""


def unturned(joints: int) -> Array:
    """Return what ``follow_torque`` remembers before the first row. Shape (3, n)."""
    memory = np.zeros((3, joints))
    memory[HIGHEST], memory[LOWEST] = -np.inf, np.inf
    return memory


@kernel
def follow_torque(torque, memory, way, reversals):  # type: ignore[no-untyped-def]
    """Add up the way of each joint's torque and its reversals: by DEADBAND back from an extreme.

    The turning points of rainflow counting (ASTM E1049), with hysteresis. A square wave and a sine
    of frequency f turn 2 f times a second, however they are sampled; what stays within the deadband
    never turns. S is not asked: within a smooth layer its sign changes without a torque that does,
    and where a law holds it at zero with its last bit.

    Args:
        torque: torque in [N m]. Shape (n, 6).
        memory: what ``unturned`` returned, carried on from the rows before. Shape (3, 6).
        way: from the first of these rows to the last in [N m]. Shape (6,).
        reversals: counts. Shape (6,).
    """
    for j in range(torque.shape[1]):
        before = torque[0, j]
        direction, highest, lowest = memory[DIRECTION, j], memory[HIGHEST, j], memory[LOWEST, j]
        moved, count = 0.0, 0.0
        for row in range(len(torque)):
            value = torque[row, j]
            moved += abs(value - before)
            before = value
            if direction >= 0.0:
                if value > highest:
                    highest = value
                elif value < highest - DEADBAND:
                    count += direction
                    direction, lowest = -1.0, value
                    continue
            if direction <= 0.0:
                if value < lowest:
                    lowest = value
                elif value > lowest + DEADBAND:
                    count -= direction
                    direction, highest = 1.0, value
        memory[DIRECTION, j], memory[HIGHEST, j], memory[LOWEST, j] = direction, highest, lowest
        way[j] += moved
        reversals[j] += count


SUMS = 8
ERROR, MAX_ERROR, MAX_VELOCITY_ERROR, TIMED_ERROR = 0, 1, 2, 3
PEAK_TORQUE, SQUARED_TORQUE, WAY, REVERSALS = 4, 5, 6, 7
"""Rows of what ``_sums_and_peaks`` writes: the sum of ``|e|`` in [rad], the greatest ``|e|`` and
``|de|``, the sum of row number times ``|e|``; the greatest torque in [N m], the sum of its square,
its way in [N m] and its reversals."""


@kernel
def _sums_and_peaks(error, velocity_error, torque, memory, out):  # type: ignore[no-untyped-def]
    for row in range(len(error)):
        for j in range(torque.shape[1]):
            size, value = abs(error[row, j]), torque[row, j]
            out[ERROR, j] += size
            out[MAX_ERROR, j] = max(out[MAX_ERROR, j], size)
            out[MAX_VELOCITY_ERROR, j] = max(
                out[MAX_VELOCITY_ERROR, j], abs(velocity_error[row, j])
            )
            out[TIMED_ERROR, j] += row * size
            out[PEAK_TORQUE, j] = max(out[PEAK_TORQUE, j], abs(value))
            out[SQUARED_TORQUE, j] += value * value
    follow_torque(torque, memory, out[WAY], out[REVERSALS])


def measure_lane(
    time: Array,
    columns: dict[str, Array],
    layer: Array,
    above: float,
    diverged_at: float | None = None,
) -> Metrics:
    """Return the figures of one lane.

    Args:
        time: time in [s], evenly spaced. Shape (n,).
        columns: ``e``, ``de``, ``tau``, ``S`` of shape (n, 6); ``flange`` and ``flange_desired`` of
            shape (n, 3).
        layer: within which S counts as reached in [rad/s]. Shape (6,).
        above: frequency above which torque counts as chattering in [Hz].
        diverged_at: when the lane left its bounds in [s], or ``None``.
    """
    if not len(time):
        return replace(no_figures(columns["e"].shape[1]), diverged_at=diverged_at)
    period = float(time[1] - time[0]) if len(time) > 1 else 1.0
    torque, way = columns["tau"], columns["flange"] - columns["flange_desired"]
    distance = np.sqrt(np.einsum("ij,ij->i", way, way))
    figures, rows = np.zeros((SUMS, torque.shape[1])), len(time)
    _sums_and_peaks(columns["e"], columns["de"], torque, unturned(torque.shape[1]), figures)
    between = max(rows - 1, 1) * period
    # By the trapezoidal rule; at the first row time is 0.
    timed = figures[TIMED_ERROR] - 0.5 * (rows - 1) * np.abs(columns["e"][-1])
    return Metrics(
        mae=figures[ERROR] / rows,
        max_error=figures[MAX_ERROR],
        max_velocity_error=figures[MAX_VELOCITY_ERROR],
        chattering=float(figures[WAY].sum() / between),
        switches=figures[REVERSALS] / between,
        high_frequency_torque=high_frequency_torque(torque, period, above),
        peak_torque=figures[PEAK_TORQUE],
        reaching_time=reaching_times(time, columns["S"], layer),
        flange_rms=float(np.sqrt(np.mean(distance**2))),
        flange_max=float(distance.max()),
        rms_torque=np.sqrt(figures[SQUARED_TORQUE] / rows),
        itae=timed * period**2,
        diverged_at=diverged_at,
    )
