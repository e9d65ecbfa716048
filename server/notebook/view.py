"""What a notebook shows of a result, before it has a form: words, tables, plots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.server.report.figure_page import decimated

Array = np.ndarray

BUCKETS = 150
"""Spans of a curve in a notebook, which keeps what it shows (*ours*)."""


@dataclass(frozen=True)
class Table:
    """A table; its first column is text, the others are numbers unless it is of words.

    Attributes:
        headings: over the columns, with units.
        rows: the cells as people read them.
        caption: what it is about.
        words: whether all columns are text.
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    words: bool = False


@dataclass(frozen=True)
class Line:
    """One curve, or one set of points.

    Attributes:
        name: its name in the legend.
        color: ``#rrggbb``.
        x: where. Shape (n,).
        y: values; NaN leaves a gap. Shape (n,).
        points: whether it is points, not a curve.
    """

    name: str
    color: str
    x: Array
    y: Array
    points: bool = False


@dataclass(frozen=True)
class Panel:
    """One plot.

    Attributes:
        title: what stands above it.
        across: quantity and unit of the horizontal axis.
        up: those of the vertical one.
        lines: what is drawn.
        logarithmic: whether the vertical axis is.
    """

    title: str
    across: str
    up: str
    lines: tuple[Line, ...]
    logarithmic: bool = False


@dataclass(frozen=True)
class View:
    """A result as a notebook shows it.

    Attributes:
        title: one line.
        notes: what must be read beside the numbers: what left its bounds, what is inaccurate.
        tables: the numbers.
        plots: panels by what the choice between them calls them; one choice at least needs none.
    """

    title: str
    notes: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    plots: tuple[tuple[str, tuple[Panel, ...]], ...] = ()


def curve(name: str, color: str, time: Array, values: Array) -> Line:
    """Return a curve with the extremes that a plot shows; it ends before what isn't finite."""
    rows = decimated(values, BUCKETS)
    return Line(name, color, time[rows], values[rows])
