"""By how much time a log is shifted against a motion: cross-correlation, then least squares."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.motion.along import desired_motion
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError
from slidetune.robot.recordings.turns import TURN

Array = np.ndarray
Motion = Callable[[Array], tuple[Array, Array]]
"""Angles [rad] and velocities [rad/s] at times in [s]. Shapes (m, n)."""

_MOST_SAMPLES = 40_000
"""Samples of the coarse search (*ours*)."""
_MOST_ROWS = 20_000
"""Rows by which shifts are compared (*ours*); the best one is found from all."""
_SHARE = 0.25
"""Share of the shorter one's time in which both have to be there (*ours*)."""
_STILL = 1e-4
"""Least range of an angle in [rad] that is a motion (*ours*)."""
_AS_GOOD = 0.02
"""Share of the way from the best fit to the usual one up to which a shift fits as well (*ours*)."""
_NEARLY, _LOOKED_AT = 0.1, 8
"""The same for where the fine search begins, and at how many places of each kind (*ours*)."""
_NEWTON, _SETTLED = 30, 1e-10
"""Steps of the fine search, and the change in [s] at which it ends (*ours*)."""


@dataclass(frozen=True)
class Shift:
    """A shift in time.

    Attributes:
        seconds: what is added to the log's time to have the motion's.
        rms: effective difference of the angles there in [rad].
        others: shifts that fit as well, as of a motion that repeats itself, in [s].
        turns: by how many turns the log's angles are above the motion's there. Shape (n,).
    """

    seconds: float
    rms: float
    others: tuple[float, ...]
    turns: Array


def motion_of(packed: Packed) -> Motion:
    """Return an experiment's desired motion."""

    def at(time: Array) -> tuple[Array, Array]:
        return desired_motion(packed.trajectory, np.ascontiguousarray(time), packed.joints)

    return at


def motion_of_log(recording: Recording) -> Motion:
    """Return a log's own motion; before its first row and after its last it stands still."""
    time, q = recording.time, recording.q
    v = np.gradient(q, time, axis=0)

    def at(wanted: Array) -> tuple[Array, Array]:
        inside = (wanted >= time[0]) & (wanted <= time[-1])
        found = [
            [np.interp(wanted, time, block[:, j]) for j in range(q.shape[1])] for block in (q, v)
        ]
        angles, rates = (np.stack(columns, axis=1) for columns in found)
        return angles, rates * inside[:, None]

    return at


def find_shift(
    time: Array, q: Array, motion: Motion, duration: float, turning: Array | None = None
) -> Shift:
    r"""Return the shift at which a log follows a motion most closely, finer than its rows.

    .. math:: \min_{s, z} \sum_k |q(t_k) - 2\pi z - q_d(t_k + s)|^2

    The sum is searched at all multiples of a row's time, by cross-correlation; the least one by
    Gauss and Newton's method goes on from there. The whole turns z are the best ones of each shift;
    a log that fits as well without any has none. Of shifts that fit equally well the smallest
    counts.

    Args:
        time: the log's time in [s]. Shape (m,).
        q: its angles in [rad]. Shape (m, n).
        motion: what it is compared with, at any time.
        duration: how long that lasts from 0 on in [s].
        turning: which joints turn, so that their angles may be whole turns apart; none by default.
            Shape (n,).

    Raises:
        RecordingError: if one of them stands still, so that every shift is as good, or none of
            those fits at which they have a quarter of the shorter one's time in common.
    """
    length = float(time[-1] - time[0])
    dt = max(float(np.median(np.diff(time))), (3.0 * length + duration) / _MOST_SAMPLES)
    even = time[0] + dt * np.arange(int(length / dt) + 1)
    rows = np.stack([np.interp(even, time, column) for column in q.T], axis=1)
    overlap = _SHARE * min(length, duration)
    first = int(np.floor((overlap - even[-1]) / dt))
    count = max(int(np.ceil((duration - overlap - even[0]) / dt)) - first, 0) + 1
    shifts = dt * (first + np.arange(count))
    desired = motion(even[0] + dt * (first + np.arange(count + len(even) - 1)))[0]
    if np.ptp(rows, axis=0).max() < _STILL or np.ptp(desired, axis=0).max() < _STILL:
        raise RecordingError("nothing moves, so that no shift can be found: give it by hand")
    plain, mean = _differences(rows, desired)
    turns = np.zeros_like(mean)
    if turning is not None:
        turns = np.where(turning, np.round(mean / TURN), 0.0)
    # The sum of squares is a parabola of the turns, least at the mean.
    turned = plain + len(rows) * ((mean - TURN * turns) ** 2 - mean**2).sum(axis=1)
    kinds = [(plain, np.zeros_like(turns))] + ([(turned, turns)] if turns.any() else [])
    inside = [one for one in kinds if 0 < int(np.argmin(one[0])) < len(plain) - 1]
    if not inside:
        raise RecordingError(
            f"no shift fits at which both have {overlap:.3g} s in common: is it a log of this "
            "motion? Give the shift by hand"
        )
    few = slice(None, None, len(time) // _MOST_ROWS + 1)
    found = []
    for sums, z in inside:
        for at in _candidates(sums, shifts):
            seconds, rms = _refined(time[few], q[few] - TURN * z[at], motion, shifts[at], dt)
            found.append((seconds, rms, z[at]))
    best = min(rms for _, rms, _ in found)
    usual = float(np.sqrt(np.median(inside[-1][0]) / rows.size))
    good = [one for one in found if one[1] <= best + _AS_GOOD * max(usual - best, 0.0)]
    seconds, _, z = min(good, key=lambda one: (bool(one[2].any()), abs(one[0])))
    apart = {round(float(one[0]), 6) for one in good if abs(one[0] - seconds) > dt}
    others = sorted(apart, key=abs)
    seconds, rms = _refined(time, q - TURN * z, motion, seconds, dt)
    return Shift(float(seconds), float(rms), tuple(others), z)


def _differences(rows: Array, desired: Array) -> tuple[Array, Array]:
    """Return the sum of squared differences and their mean at every shift.

    Shapes (m, n), (m + k - 1, n) to (k,), (k, n).
    """
    from scipy.signal import fftconvolve  # here, because it takes long to import

    count = len(rows)
    centre = desired.mean(axis=0)
    rows, desired = rows - centre, desired - centre
    products = sum(
        fftconvolve(desired[:, j], rows[::-1, j], mode="valid") for j in range(rows.shape[1])
    )
    squares = np.concatenate([[0.0], np.cumsum((desired**2).sum(axis=1))])
    heights = np.vstack([np.zeros(rows.shape[1]), np.cumsum(desired, axis=0)])
    mean = rows.mean(axis=0) - (heights[count:] - heights[:-count]) / count
    sums = (rows**2).sum() - 2.0 * products + squares[count:] - squares[:-count]
    return np.asarray(sums), np.asarray(mean)


def _candidates(sums: Array, shifts: Array) -> list[int]:
    """Return where the sum is least, and where it is nearly so: the least sums and shifts."""
    least, usual = float(sums.min()), float(np.median(sums))
    padded = np.concatenate([[np.inf], sums, [np.inf]])
    valleys = np.flatnonzero((sums <= padded[:-2]) & (sums <= padded[2:]))
    close = valleys[sums[valleys] <= least + _NEARLY * (usual - least)]
    best, nearest = np.argsort(sums[close])[:_LOOKED_AT], np.argsort(np.abs(shifts[close]))
    return [int(close[at]) for at in dict.fromkeys([*best, *nearest[:_LOOKED_AT]])]


def _refined(time: Array, q: Array, motion: Motion, shift: float, dt: float) -> tuple[float, float]:
    """Return the nearest shift with the least sum of squares, and its effective difference."""
    found = shift
    for _ in range(_NEWTON):
        desired, rates = motion(time + found)
        step = float((rates * (q - desired)).sum() / max(float((rates**2).sum()), 1e-300))
        found += float(np.clip(step, -dt, dt))
        if abs(found - shift) > 3.0 * dt:  # away from the valley: where it was is good enough
            found = shift
            break
        if abs(step) < _SETTLED:
            break
    rms = float(np.sqrt(np.mean((q - motion(time + found)[0]) ** 2)))
    return found, rms
