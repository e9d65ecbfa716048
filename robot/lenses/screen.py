"""What a screen needs of a long run: few rows that keep its shape, and few digits."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

Array = np.ndarray

DIGITS = 6
"""Significant digits that leave for the screen (*ours*)."""


def evenly_along(x: Array, y: Array, count: int) -> Array:
    """Choose rows of a path in a plane that lie evenly along it as it is drawn.

    A fast beginning keeps its points though it takes no time, which rows evenly in time would lose.

    Args:
        x: one coordinate. Shape (n,).
        y: the other. Shape (n,).
        count: how many rows to choose at most.

    Returns:
        Rows in order, the first and the last among them. Shape (m,), m <= count.
    """
    if len(x) <= count:
        return np.arange(len(x))
    scale = [max(float(np.ptp(column)), 1e-12) for column in (x, y)]
    steps = np.hypot(np.diff(x) / scale[0], np.diff(y) / scale[1])
    # A hundredth of the length is shared out in time, so that a path that stands still is kept.
    length = np.concatenate([[0.0], np.cumsum(steps + 0.01 * (steps.sum() + 1e-12) / len(steps))])
    return np.unique(np.searchsorted(length, np.linspace(0.0, length[-1], count)))


def every_few(rows: int, count: int) -> Array:
    """Return the numbers of ``count`` rows at most, evenly spaced, both ends included."""
    return np.unique(np.round(np.linspace(0, rows - 1, min(rows, count))).astype(int))


def rounded(values: Array, digits: int = DIGITS) -> Array:
    """Return values with a few significant digits; what is not finite stays as it is."""
    values = np.asarray(values, dtype=float)
    with np.errstate(all="ignore"):
        size = np.floor(np.log10(np.abs(values)))
    size = np.where(np.isfinite(size), size, 0.0)
    scale = 10.0 ** np.clip(digits - 1 - size, -300, 300)
    return np.asarray(np.round(values * scale) / scale)


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _list(values: Array) -> list[Any]:
    if values.ndim > 1:
        return [_list(row) for row in values]
    return [_number(value) for value in values.tolist()]


def document(view: Any) -> Any:
    """Return a lens's dataclasses as plain JSON values; what is not a number becomes ``None``."""
    if is_dataclass(view):
        return {each.name: document(getattr(view, each.name)) for each in fields(view)}
    if isinstance(view, np.ndarray):
        return _list(rounded(view))
    if isinstance(view, dict):
        return {key: document(value) for key, value in view.items()}
    if isinstance(view, tuple | list):
        return [document(value) for value in view]
    if isinstance(view, float | np.floating):
        return _number(float(view))
    return view
