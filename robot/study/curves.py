"""Responses of many draws, thinned out alike, and the bands that they lie within."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from slidetune.robot.loop.simulate import LaneRun

Array = np.ndarray

PIECES = 120
"""Pieces into which the horizon is cut; each keeps its least and its greatest value (*ours*)."""


def curve_names(joints: int) -> tuple[str, ...]:
    """Return what is kept of a run: error [rad], torque [N m], distance of the flange [m]."""
    each = range(1, joints + 1)
    return (*(f"e{j}" for j in each), *(f"tau{j}" for j in each), "flange_error")


def curves_of(run: LaneRun) -> Array:
    """Return the least and the greatest value of each piece of a run's time.

    Returns:
        Of ``curve_names``, single precision; NaN once the lane left its bounds.
        Shape (2n + 1, 2, pieces).
    """
    distance = np.linalg.norm(run.flange - run.flange_desired, axis=1)[:, None]
    columns = np.concatenate([run.e, run.tau, distance], axis=1)
    starts = edges(len(columns))[:-1]
    # A piece with a NaN in it is NaN: the lane left its bounds there.
    extremes = [extreme.reduceat(columns, starts, axis=0) for extreme in (np.minimum, np.maximum)]
    return np.stack(extremes).transpose(2, 0, 1).astype(np.float32)


def edges(rows: int) -> Array:
    """Return the first row of each piece, and behind them the number of rows."""
    return np.linspace(0, rows, min(PIECES, rows) + 1).astype(int)


def bands(curves: Sequence[Array], horizon: float) -> dict[str, Any]:
    """Return within what the curves of many draws lie, piece by piece, as plain JSON values.

    Between ``low`` and ``high`` lies nine tenths of the draws: the 5th percentile of the least
    values, the 95th of the greatest ones. A draw that left its bounds counts as beyond all; where
    the percentile is such a draw, it is ``None``. The median is that of the draws still there, as
    long as they are more than half.

    Args:
        curves: of each draw; see ``curves_of``.
        horizon: length of a run in [s].
    """
    if not curves:
        return {"time": [], "curves": {}}
    whole = np.stack(curves).astype(float)
    low, high = whole[:, :, 0], whole[:, :, 1]
    gone = np.isnan(low)
    least, greatest = np.where(gone, -np.inf, low), np.where(gone, np.inf, high)
    few = 2 * gone.sum(axis=0) >= len(curves)
    middle = np.where(few, 0.0, 0.5 * (low + high))
    found = {
        "low": np.quantile(least, 0.05, axis=0, method="inverted_cdf"),
        "median": np.where(few, np.nan, np.nanmedian(middle, axis=0)),
        "high": np.quantile(greatest, 0.95, axis=0, method="inverted_cdf"),
        "least": least.min(axis=0),
        "greatest": greatest.max(axis=0),
    }
    pieces = whole.shape[-1]
    time = (np.arange(pieces) + 0.5) * horizon / pieces
    return {
        "time": time.tolist(),
        "curves": {
            name: {label: _plain(values[place]) for label, values in found.items()}
            for place, name in enumerate(curve_names(whole.shape[1] // 2))
        },
    }


def _plain(values: Array) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]
