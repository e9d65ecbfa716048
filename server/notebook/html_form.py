"""A view as HTML without a script: tables, and plots as SVG, for whoever draws no Plotly."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from math import ceil, floor, log10

import numpy as np

from slidetune.server.notebook.view import Line, Panel, Table, View

Array = np.ndarray

WIDTH, HEIGHT = 330.0, 190.0
LEFT, RIGHT, TOP, BOTTOM = 56.0, 8.0, 22.0, 34.0
"""Sizes of a plot in pixels, and its margins (*ours*)."""
MOST_TICKS = 5
FLAT = 1e-9
"""Share of the values below which they differ by rounding alone (*ours*)."""
NOTHING = 1e-30
"""What is less is 0, in any of our units (*ours*)."""
TABLE = "border-collapse:collapse;margin:6px 0;font-variant-numeric:tabular-nums"
CELL = "border:1px solid #8884;padding:2px 8px;text-align:"


def html_form(view: View) -> str:
    """Return a fragment of a page; every text is escaped, colours follow the page's own."""
    notes = "".join(f"<p style='margin:4px 0'>⚠ {escape(text)}</p>" for text in view.notes)
    tables = "".join(_table(table) for table in view.tables)
    plots = "".join(_plots(panels) for _, panels in view.plots)
    return (
        f"<div><p style='margin:4px 0'><b>{escape(view.title)}</b></p>{notes}{tables}{plots}</div>"
    )


def _table(table: Table) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        return "".join(
            f"<{tag} style='{CELL}{'left' if table.words or not place else 'right'}'>"
            f"{escape(text)}</{tag}>"
            for place, text in enumerate(cells)
        )

    body = "".join(f"<tr>{row(cells, 'td')}</tr>" for cells in table.rows)
    caption = (
        f"<caption style='text-align:left'>{escape(table.caption)}</caption>"
        if table.caption
        else ""
    )
    head = f"<thead><tr>{row(table.headings, 'th')}</tr></thead>"
    return f"<table style='{TABLE}'>{caption}{head}<tbody>{body}</tbody></table>"


def _plots(panels: Sequence[Panel]) -> str:
    legend = "".join(
        f"<span style='margin-right:14px;white-space:nowrap'><span style='color:{line.color}'>"
        f"{'●' if line.points else '━'}</span> {escape(line.name)}</span>"
        for line in panels[0].lines
    )
    return f"<div>{legend}</div><div>{''.join(_plot(panel) for panel in panels)}</div>"


def _plot(panel: Panel) -> str:
    lines = [(line, *_drawn(line, panel.logarithmic)) for line in panel.lines]
    across = [x for _, x, _ in lines if len(x)]
    up = [y for _, _, y in lines if len(y)]
    if not across:
        return ""
    low_x, high_x = _span(np.concatenate(across))
    low_y, high_y = _span(np.concatenate(up))
    width, height = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def place_x(x: Array) -> Array:
        return LEFT + width * (x - low_x) / (high_x - low_x)

    def place_y(y: Array) -> Array:
        return TOP + height * (high_y - y) / (high_y - low_y)

    parts = []
    for tick in _log_ticks(low_y, high_y) if panel.logarithmic else _ticks(low_y, high_y):
        at = float(place_y(np.array(tick)))
        label = f"{10.0**tick:.6g}" if panel.logarithmic else f"{tick:.6g}"
        parts.append(
            f"<path d='M{LEFT:g} {at:.1f}H{WIDTH - RIGHT:g}' stroke='#8886' stroke-width='.5'/>"
            + _text(LEFT - 4.0, at + 3.5, label, "end")
        )
    for tick in _ticks(low_x, high_x):
        at = float(place_x(np.array(tick)))
        parts.append(_text(at, HEIGHT - BOTTOM + 13.0, f"{tick:.6g}", "middle"))
    for line, x, y in lines:
        parts.append(_marks(line, place_x(x), place_y(y)))
    parts.append(_text(LEFT, 11.0, f"{panel.title}: {panel.up}", "start"))
    parts.append(_text(WIDTH - RIGHT, HEIGHT - 5.0, panel.across, "end"))
    label = escape(f"{panel.title}: {panel.up} over {panel.across}")
    return (
        f"<svg role='img' aria-label='{label}' width='{WIDTH:g}' height='{HEIGHT:g}' "
        f"viewBox='0 0 {WIDTH:g} {HEIGHT:g}' font-size='10' fill='currentColor'>"
        f"{''.join(parts)}</svg>"
    )


def _drawn(line: Line, logarithmic: bool) -> tuple[Array, Array]:
    """Return what can be drawn of a line, the logarithm to base 10 where it is asked for."""
    known = np.isfinite(line.x) & np.isfinite(line.y)
    if logarithmic:
        known &= np.where(np.isfinite(line.y), line.y, 0.0) > 0.0
    x, y = line.x[known].astype(float), line.y[known].astype(float)
    return x, np.log10(y) if logarithmic else y


def _marks(line: Line, x: Array, y: Array) -> str:
    pairs = list(zip(x.tolist(), y.tolist(), strict=True))
    if line.points:
        dots = "".join(f"<circle cx='{a:.1f}' cy='{b:.1f}' r='2'/>" for a, b in pairs)
        return f"<g fill='{line.color}'>{dots}</g>"
    path = " ".join(f"{a:.1f},{b:.1f}" for a, b in pairs)
    return f"<polyline points='{path}' fill='none' stroke='{line.color}'/>"


def _span(values: Array) -> tuple[float, float]:
    """Return the ends of an axis; what is one number but for rounding gets room around it."""
    low, high = float(values.min()), float(values.max())
    if high - low > max(FLAT * max(abs(low), abs(high)), NOTHING):
        return low, high
    room = abs(low) if abs(low) > NOTHING else 1.0
    return low - room, high + room


def _ticks(low: float, high: float) -> list[float]:
    """Return round numbers within an axis, 1, 2 or 5 times a power of ten apart."""
    rough = (high - low) / MOST_TICKS
    power = 10.0 ** floor(log10(rough))
    apart = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= rough)
    first, last = ceil(low / apart - 1e-9), floor(high / apart + 1e-9)
    return [number * apart for number in range(first, last + 1)]


def _log_ticks(low: float, high: float) -> list[float]:
    """Return the logarithms of round numbers within an axis: powers of ten, of a short one more."""
    if high - low > 1.0:
        return [float(power) for power in range(ceil(low - 1e-9), floor(high + 1e-9) + 1)]
    return [log10(tick) for tick in _ticks(10.0**low, 10.0**high)]


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f"<text x='{x:.1f}' y='{y:.1f}' text-anchor='{anchor}'>{escape(text)}</text>"
