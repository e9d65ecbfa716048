"""A view as Plotly's JSON, which JupyterLab and VS Code draw: tables and plots in one figure."""

from __future__ import annotations

from html import escape
from math import ceil
from typing import Any

import numpy as np

from slidetune.server.notebook.view import Line, Panel, Table, View

Json = dict[str, Any]

COLUMNS = 3
"""Plots beside each other (*ours*)."""
ROW, TEXT, PLOT, GAP = 24.0, 17.0, 190.0, 56.0
"""Heights in pixels (*ours*): of a table's row, of a line of words, of a plot, below a plot."""
LETTERS = 110
"""Letters in a line of words as wide as a cell (*ours*)."""
BORDER, HEAD = "#d5d9e0", "#eef0f4"


def plotly_form(view: View) -> Json:
    """Return what ``application/vnd.plotly.v1+json`` stands for.

    A front end shows one form of a result, so that the tables are in it, too.
    """
    tables = [_words(view), *view.tables] if view.notes else list(view.tables)
    heights = [_height(one) for one in tables]
    most = max((len(panels) for _, panels in view.plots), default=0)
    rows = ceil(most / COLUMNS)
    choices = len(view.plots) > 1
    plots = rows * (PLOT + GAP) + (40.0 if choices else 0.0)
    whole = sum(heights) + plots
    top, data = whole, list[Json]()
    for table, height in zip(tables, heights, strict=True):
        data.append(_table(table, (top - height) / whole, top / whole))
        top -= height
    layout: Json = {
        "title": {"text": _plain(view.title), "x": 0.0, "xref": "container", "font": {"size": 15}},
        "height": round(whole + 60.0 + 30.0),
        "margin": {"l": 60, "r": 16, "t": 60, "b": 30},
        "paper_bgcolor": "#ffffff",
        "plot_bgcolor": "#ffffff",
        "font": {"size": 12, "color": "#191d23"},
        "legend": {"orientation": "h", "x": 0.0, "y": plots / whole, "yanchor": "top"},
        "hovermode": "x unified",
        "annotations": [],
    }
    buttons, first = [], len(data)
    for number, (_, panels) in enumerate(view.plots):
        for place, panel in enumerate(panels):
            if number == 0:
                _place(layout, place, panel, plots, whole, choices, len(panels))
            data += [_line(line, place, number == 0, place == 0) for line in panel.lines]
    for number, (name, panels) in enumerate(view.plots):
        shown = [True] * first + [
            number == which for which, (_, some) in enumerate(view.plots) for _ in _lines(some)
        ]
        up = {
            f"yaxis{_suffix(place)}.title.text": _plain(panel.up)
            for place, panel in enumerate(panels)
        }
        arguments = [{"visible": shown}, up]
        buttons.append({"label": name, "method": "update", "args": arguments})
    if choices:
        layout["updatemenus"] = [
            {
                "type": "buttons",
                "direction": "right",
                "buttons": buttons,
                "x": 1.0,
                "xanchor": "right",
                "y": plots / whole,
                "yanchor": "top",
                "showactive": True,
            }
        ]
    return {"data": data, "layout": layout, "config": {"displaylogo": False, "responsive": True}}


def _plain(text: str) -> str:
    """Return a text of which Plotly reads no markup."""
    return escape(text, quote=False)


def _lines(panels: tuple[Panel, ...]) -> list[Line]:
    return [line for panel in panels for line in panel.lines]


def _words(view: View) -> Table:
    return Table(("Remarks",), tuple((text,) for text in view.notes), words=True)


def _height(table: Table) -> float:
    """Return a height that holds a table, in [pixels]; what is longer than a cell is wrapped."""
    lines = sum(_lines_of(row) - 1 for row in (table.headings, *table.rows))
    return ROW * (len(table.rows) + 1) + TEXT * lines + 18.0


def _lines_of(row: tuple[str, ...]) -> int:
    """Return into how many lines the fullest cell of a row is wrapped, at the most."""
    across = LETTERS / len(row)
    return max(ceil(len(text) / across) for text in row) or 1


def _table(table: Table, low: float, high: float) -> Json:
    align = ["left"] * len(table.headings) if table.words else ["left", "right"]
    columns = [[_plain(row[place]) for row in table.rows] for place in range(len(table.headings))]
    heads = [f"<b>{_plain(text)}</b>" for text in table.headings]
    if table.caption:
        heads[0] = f"<b>{_plain(table.caption)}</b>" if not table.headings[0] else heads[0]
    line = {"color": BORDER, "width": 1}
    widths = [2.0] + [1.0] * (len(table.headings) - 1)
    return {
        "type": "table",
        "domain": {"x": [0.0, 1.0], "y": [max(low, 0.0), high]},
        "columnwidth": widths,
        "header": {
            "values": heads,
            "align": align,
            "height": ROW,
            "line": line,
            "fill": {"color": HEAD},
        },
        "cells": {
            "values": columns,
            "align": align,
            "height": ROW,
            "line": line,
            "fill": {"color": "#ffffff"},
        },
    }


def _suffix(place: int) -> str:
    return "" if place == 0 else str(place + 1)


def _place(
    layout: Json, place: int, panel: Panel, plots: float, whole: float, choices: bool, count: int
) -> None:
    """Put the axes of a panel, and its title, into a layout."""
    across = min(COLUMNS, count)
    row, column = divmod(place, COLUMNS)
    gap = 0.06
    width = (1.0 - gap * (across - 1)) / across
    left = column * (width + gap)
    high = plots - 36.0 - (14.0 if choices else 0.0) - row * (PLOT + GAP)
    bottom, top = max(high - PLOT + 20.0, 0.0) / whole, high / whole
    suffix = _suffix(place)
    axis = {"gridcolor": BORDER, "zerolinecolor": "#a8afba", "linecolor": BORDER}
    layout[f"xaxis{suffix}"] = {
        **axis,
        "domain": [left, left + width],
        "anchor": f"y{suffix}",
        "title": {"text": _plain(panel.across), "standoff": 4, "font": {"size": 11}},
        **({} if place == 0 else {"matches": "x"}),
    }
    layout[f"yaxis{suffix}"] = {
        **axis,
        "domain": [bottom, top],
        "anchor": f"x{suffix}",
        "title": {"text": _plain(panel.up), "standoff": 4, "font": {"size": 11}},
        "type": "log" if panel.logarithmic else "linear",
        "exponentformat": "power",
    }
    layout["annotations"].append(
        {
            "text": _plain(panel.title),
            "xref": "paper",
            "yref": "paper",
            "x": left,
            "y": top,
            "xanchor": "left",
            "yanchor": "bottom",
            "showarrow": False,
            "font": {"size": 12},
        }
    )


def _digits(values: np.ndarray, digits: int) -> list[float | None]:
    return [
        float(f"{value:.{digits}g}") if np.isfinite(value) else None for value in values.tolist()
    ]


def _line(line: Line, place: int, visible: bool, legend: bool) -> Json:
    style = (
        {"mode": "markers", "marker": {"color": line.color, "size": 6}}
        if line.points
        else {"mode": "lines", "line": {"color": line.color, "width": 1.5}}
    )
    return {
        "type": "scatter",
        "name": _plain(line.name),
        "legendgroup": _plain(line.name),
        "showlegend": legend,
        "visible": visible,
        "x": _digits(line.x, 6),
        "y": _digits(line.y, 5),
        "xaxis": f"x{_suffix(place)}",
        "yaxis": f"y{_suffix(place)}",
        "hovertemplate": "%{y:.4~g}",
        **style,
    }
