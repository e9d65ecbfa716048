"""One HTML file of interactive figures that needs no network: plotly stands in the file itself."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from slidetune.server.hosting.static_paths import PLOTLY

Array = np.ndarray

BUCKETS = 400
"""Spans of time of which a curve keeps the least and the greatest value (*ours*)."""
DESIRED = "desired"
"""Name of the curve that is drawn dashed and neutral."""

POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
)
"""What the page's browser lets it do: nothing that asks a network."""

_TEMPLATE = Path(__file__).with_name("figure_page.html")
_PLACE = re.compile(r"<!--place:(\w+)-->")


@dataclass(frozen=True)
class Curve:
    """One line of a figure.

    Attributes:
        name: its name in the legend.
        color: ``#rrggbb``, empty for the desired motion.
        time: time in [s]. Shape (n,).
        values: its values; it ends before the first that isn't finite. Shape (n,).
    """

    name: str
    color: str
    time: Array
    values: Array


@dataclass(frozen=True)
class Figure:
    """One figure.

    Attributes:
        heading: what stands above it.
        caption: what stands below it.
        axis: quantity and unit of the vertical axis.
        curves: its lines.
    """

    heading: str
    caption: str
    axis: str
    curves: tuple[Curve, ...]


@dataclass(frozen=True)
class Section:
    """Figures under one heading.

    Attributes:
        title: the heading.
        figures: the figures.
    """

    title: str
    figures: tuple[Figure, ...]


@dataclass(frozen=True)
class Additions:
    """What a page has besides its figures.

    Attributes:
        tail: HTML that stands below the figures.
        style: CSS.
        scripts: HTML of scripts, run when all else is there.
        policy: what the page's browser lets it do; no double quotes in it.
    """

    tail: str = ""
    style: str = ""
    scripts: str = ""
    policy: str = POLICY


def decimated(values: Array, buckets: int = BUCKETS) -> Array:
    """Return the rows to draw: of each bucket the least and the greatest, and both ends.

    Args:
        values: a curve. Shape (n,).
        buckets: how many spans.

    Returns:
        Rising row numbers, at most ``2 * buckets + 2``, all before the first value that isn't
        finite. Shape (m,).
    """
    finite = np.isfinite(values)
    count = len(values) if finite.all() else int(np.argmin(finite))
    if count <= 2 * buckets:
        return np.arange(count)
    edges = np.linspace(0, count, buckets + 1).astype(int)
    rows = [0, count - 1]
    for begin, end in pairwise(edges.tolist()):
        part = values[begin:end]
        rows += [begin + int(np.argmin(part)), begin + int(np.argmax(part))]
    return np.unique(rows)


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def _curve(curve: Curve) -> dict[str, Any]:
    rows = decimated(curve.values)
    return {
        "name": curve.name,
        "color": curve.color,
        "x": [_digits(time, 6) for time in curve.time[rows].tolist()],
        "y": [_digits(value, 5) for value in curve.values[rows].tolist()],
    }


def _figure(figure: Figure) -> dict[str, Any]:
    time = figure.curves[0].time
    return {
        "heading": figure.heading,
        "caption": figure.caption,
        "axis": figure.axis,
        "range": [float(time[0]), float(time[-1])],
        "curves": [_curve(curve) for curve in figure.curves],
    }


def _section(section: Section) -> str:
    # One figure at a time: the encoder lets no other thread of the server go on meanwhile.
    figures = ",".join(_json(_figure(item)) for item in section.figures)
    return f'{{"title":{_json(section.title)},"figures":[{figures}]}}'


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))


def in_script(text: str) -> str:
    """Return JSON as it may stand within a script element, which only a `<` could end early."""
    return text.replace("<", "\\u003c")


def html_table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], caption: str, texts: int = 2
) -> str:
    """Return a table as HTML; every text is escaped.

    Args:
        headings: one a column.
        rows: the cells.
        caption: what stands below it.
        texts: how many columns from the left hold texts, 1 or 2; the others hold numbers.
    """
    head = "".join(f'<th scope="col">{escape(text)}</th>' for text in headings)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>\n" for row in rows
    )
    numbers = ' class="numbers"' if texts == 1 else ""
    return (
        f"<table{numbers}><caption><span>{escape(caption)}</span></caption><thead><tr>{head}</tr></thead>"
        f"<tbody>\n{body}</tbody></table>\n"
    )


def html_paragraphs(texts: Sequence[str]) -> str:
    """Return paragraphs as HTML; every text is escaped."""
    return "".join(f"<p>{escape(text)}</p>\n" for text in texts)


def figure_page(
    title: str, body: str, sections: Sequence[Section], additions: Additions | None = None
) -> str:
    """Return the whole page.

    Args:
        title: plain text.
        body: HTML that stands above the figures; see ``html_table`` and ``html_paragraphs``.
        sections: the figures.
        additions: what it has besides.
    """
    more = additions or Additions()
    parts = {
        "title": escape(title),
        "body": body,
        "tail": more.tail,
        "style": more.style,
        "scripts": more.scripts,
        "policy": more.policy,
        "figures": in_script(f"[{','.join(_section(section) for section in sections)}]"),
        "plotly": PLOTLY.read_text(encoding="utf-8"),
    }
    template = _TEMPLATE.read_text(encoding="utf-8")
    return _PLACE.sub(lambda place: parts[place[1]], template)
