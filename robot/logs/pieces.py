"""Figures of a log with gaps: of the rows that there are, not of what may have been between."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from slidetune.robot.loop.metrics import Metrics
from slidetune.robot.recordings.stamps import GAP

Array = np.ndarray

FEWEST = 2
"""Rows of a piece at least: one alone has no time."""


def in_gaps(wanted: Array, time: Array) -> Array:
    """Tell which times lie within the gaps of a log. Shape (m,).

    Args:
        wanted: times in [s]. Shape (m,).
        time: those of the log's rows in [s]. Shape (k,).
    """
    steps = np.diff(time)
    before = np.clip(np.searchsorted(time, wanted, side="right") - 1, 0, len(steps) - 1)
    slack = 1e-9
    inside = (wanted > time[before] + slack) & (wanted < time[before + 1] - slack)
    return np.asarray(inside & (steps[before] > GAP * np.median(steps)))


def pieces_of(known: Array) -> list[slice]:
    """Return where rows follow each other without a gap, two of them at least.

    Args:
        known: which rows are no gap. Shape (m,).
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]])))
    return [slice(a, b) for a, b in edges.reshape(-1, 2).tolist() if b - a >= FEWEST]


def pooled(parts: Sequence[Metrics], times: Sequence[Array], errors: Sequence[Array]) -> Metrics:
    """Return the figures of several pieces of a log as those of one.

    Means are weighted by rows, rates by time; the time of ITAE counts from the first piece on.

    Args:
        parts: figures of each piece; their torque may be NaN, in all of them alike.
        times: of its rows in [s], evenly spaced. Shapes (m,).
        errors: of the angles in [rad]. Shapes (m, n).
    """
    rows = np.array([len(time) for time in times], dtype=float)
    lengths = np.array([time[-1] - time[0] for time in times])

    def effective(values: Sequence[Any], weights: Array) -> Array:
        return np.asarray(np.sqrt(np.average(np.square(values), axis=0, weights=weights)))

    heard = [at for at, one in enumerate(parts) if one.high_frequency_torque is not None]
    loud = [parts[at].high_frequency_torque or 0.0 for at in heard]
    timed = [
        one.itae + (time[0] - times[0][0]) * np.trapezoid(np.abs(e), time, axis=0)
        for one, time, e in zip(parts, times, errors, strict=True)
    ]
    return Metrics(
        mae=np.average([one.mae for one in parts], axis=0, weights=rows),
        max_error=np.max([one.max_error for one in parts], axis=0),
        max_velocity_error=np.max([one.max_velocity_error for one in parts], axis=0),
        chattering=float(np.average([one.chattering for one in parts], weights=lengths)),
        switches=np.average([one.switches for one in parts], axis=0, weights=lengths),
        high_frequency_torque=float(effective(loud, rows[heard])) if heard else None,
        peak_torque=np.max([one.peak_torque for one in parts], axis=0),
        reaching_time=parts[0].reaching_time,
        flange_rms=float(effective([one.flange_rms for one in parts], rows)),
        flange_max=max(one.flange_max for one in parts),
        rms_torque=effective([one.rms_torque for one in parts], rows),
        itae=np.sum(timed, axis=0),
    )
