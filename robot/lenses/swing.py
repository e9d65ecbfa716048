"""How fast and how far a sliding variable swings in a run, whatever slow motion it follows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray

SLOWEST = 1.0
"""Frequency in [Hz] below which a swing is the motion's own (*ours*)."""
_NEAR = 0.1
"""Share of its frequency within which a swing's power is gathered (*ours*)."""
_GATHERED = 0.25
"""Share of the power that a frequency has at least; what is spread wider has none (*ours*)."""
QUARTILE = 0.75
"""Share of the periods that swing less than the amplitude (*ours*): two samples a period beat, and
a median would count those that happen to fall on the middle of the swing."""
_PERIODS = 8
"""Periods that make a swing (*ours*): a few come from the motion, as where friction reverses."""
_FEWEST = 64
"""Rows that are about as few as will do (*ours*)."""


class Swing(NamedTuple):
    """A sustained oscillation.

    Attributes:
        frequency: in [Hz].
        amplitude: half of what it swings in a period in [rad/s]; a quarter of them swing farther.
    """

    frequency: float
    amplitude: float


def swing_of(sliding: Array, period: float, least: float) -> Swing | None:
    """Return the strongest oscillation of one sliding variable, ``None`` where it is silent.

    Its rate of change is looked at: that of the motion is small, however far it goes.

    Args:
        sliding: sliding variable in [rad/s]. Shape (n,).
        period: time between two rows in [s].
        least: amplitude in [rad/s] that is not yet a swing.
    """
    if len(sliding) < _FEWEST:
        return None
    change = np.diff(sliding)
    power = np.abs(np.fft.rfft((change - change.mean()) * np.hanning(len(change)))) ** 2
    frequency = np.fft.rfftfreq(len(change), period)
    slow = frequency < SLOWEST
    peak = int(np.argmax(np.where(slow, 0.0, power)))
    if power[peak] < power[max(peak - 1, 0)]:
        return None  # The flank of something slower.
    power[slow] = 0.0
    near = np.abs(frequency - frequency[peak]) <= max(_NEAR * frequency[peak], 2.0 * frequency[1])
    if power[peak] <= 0.0 or power[near].sum() < _GATHERED * power.sum():
        return None
    found = float(frequency[near] @ power[near] / power[near].sum())
    rows = max(2, round(1.0 / (found * period)))
    if _PERIODS * rows > len(sliding):
        return None
    mean = np.convolve(sliding, np.full(rows, 1.0 / rows), "valid")
    fast = sliding[rows // 2 : rows // 2 + len(mean)] - mean
    # A row more, so that both extremes are in it, whatever part of a row the period ends with.
    piece = min(rows + 1, len(fast))
    pieces = fast[: len(fast) // piece * piece].reshape(-1, piece)
    amplitude = 0.5 * float(np.quantile(np.ptp(pieces, axis=1), QUARTILE))
    return Swing(found, amplitude) if amplitude > least else None
