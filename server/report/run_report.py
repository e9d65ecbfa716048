"""What a headless run tells: the figures of every lane, in a table and as JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, Literal

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.loop.figures import FIGURES, Figure, figures_of
from slidetune.robot.loop.simulate import LaneRun, Run
from slidetune.robot.margins.margin import loop_margin
from slidetune.robot.version import __version__

Document = dict[str, Any]

UNITS = {figure.name: figure.unit for figure in figures_of("run", "accuracy")}
"""Units of ``robot.loop.metrics.Metrics`` and ``robot.loop.accuracy.Accuracy``."""

_APART = "diverged_at"
"""It is told of a lane without figures as well."""
_PER_JOINT = [figure for figure in figures_of("run") if figure.per_joint]
_OVERALL = [
    figure for figure in figures_of("run") if not figure.per_joint and figure.name != _APART
]
_ESTIMATE = FIGURES["error_estimate"]
_MORE_DIGITS = 1
"""A report has room for so many digits more than the screen (*ours*)."""
NONE = "—"


def report(run: Run, since: float = 0.0) -> Document:
    """Return experiment, figures, remarks and freezes of a run as plain JSON values.

    Args:
        run: the run.
        since: beginning of the span that the figures cover in [s].
    """
    packed, slides = pack(run.experiment), arm_named(run.experiment.robot.model).slides
    lanes = {
        name: {
            "metrics": _metrics(lane, since),
            "accuracy": lane.accuracy.document(),
            "frozen": None if lane.freeze is None else asdict(lane.freeze),
            **_margin(packed, name),
            "notes": [asdict(one) for one in advice_on(packed, name)],
        }
        for name, lane in run.lanes.items()
    }
    return {
        "slidetune": __version__,
        "since": since,
        "units": {name: unit_of_joints(unit, slides) for name, unit in UNITS.items()},
        "lanes": lanes,
        "experiment": run.experiment.document(),
    }


def _margin(packed: Packed, name: str) -> Document:
    """Return how a lane's sampled loop stands; continuous mode has no control period."""
    if packed.experiment.simulation.mode != "sampled":
        return {"gamma": None, "margin": None}
    margin = loop_margin(packed, name)
    return {"gamma": margin.gamma, "margin": margin.document()}


def _metrics(lane: LaneRun, since: float) -> Document | None:
    """Return a lane's figures, ``None`` where it stood still for the whole span."""
    if lane.freeze is not None and lane.freeze.time < since:
        return None
    return lane.metrics_since(since).document()


def json_text(document: Document) -> str:
    """Return strict JSON.

    Raises:
        ValueError: for a number that isn't finite: a mistake of ours.
    """
    return json.dumps(document, allow_nan=False, ensure_ascii=False, indent=1)


def figure_text(figure: Figure, value: float | None) -> str:
    """Return a figure as a person reads it: thousands apart, no exponents above them."""
    if value is None:
        return NONE
    shown = value * figure.factor
    return f"{shown:,.0f}" if abs(shown) >= 1000.0 else f"{shown:.{figure.digits + _MORE_DIGITS}g}"


def heading(figure: Figure, slides: Sequence[bool] = ()) -> str:
    """Return what stands over a figure as people read it, with the unit of an arm's joints."""
    return f"{figure.heading} [{unit_of_joints(figure.shown_unit, slides)}]"


def _table(*headings: str, first: int) -> Table:
    """Return an empty table whose columns from ``first`` on hold numbers."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, heading in enumerate(headings):
        justify: Literal["left", "right"] = "right" if index >= first else "left"
        table.add_column(Text(heading), justify=justify, overflow="fold")
    return table


def _add(table: Table, cells: Sequence[str]) -> None:
    table.add_row(*(Text(cell) for cell in cells))  # a lane's name is text, not markup


Rows = list[list[str]]


def per_joint_rows(lanes: Document, slides: Sequence[bool]) -> tuple[list[str], Rows]:
    """Return headings and rows of the figures that each joint has: one row a figure and lane.

    Args:
        lanes: ``lanes`` of what ``report`` returned.
        slides: which joints of the arm slide.
    """
    joints, rows = len(slides), []
    for figure in _PER_JOINT:
        for name, lane in lanes.items():
            values = (lane["metrics"] or {}).get(figure.name, [None] * joints)
            texts = (figure_text(figure, value) for value in values)
            rows.append([heading(figure, slides), name, *texts])
    return ["", "lane", *(f"J{j + 1}" for j in range(joints))], rows


def overall_rows(lanes: Document, slides: Sequence[bool]) -> tuple[list[str], Rows]:
    """Return headings and rows of the figures of the whole arm, with their error: a row a lane.

    Args:
        lanes: ``lanes`` of what ``report`` returned.
        slides: which joints of the arm slide.
    """
    last = (_ESTIMATE, FIGURES[_APART])
    units = [unit_of_joints(figure.shown_unit, slides) for figure in last]
    titles = (f"{figure.title} [{unit}]" for figure, unit in zip(last, units, strict=True))
    rows = []
    for name, lane in lanes.items():
        metrics, frozen = lane["metrics"] or {}, lane["frozen"] or {}
        values = [metrics.get(figure.name) for figure in _OVERALL]
        values += [lane["accuracy"][_ESTIMATE.name], frozen.get("time")]
        rows.append([name, *map(figure_text, (*_OVERALL, *last), values)])
    return ["lane", *(heading(figure, slides) for figure in _OVERALL), *titles], rows


def _per_joint(lanes: Document, slides: Sequence[bool]) -> Table:
    headings, rows = per_joint_rows(lanes, slides)
    table, before = _table(*headings, first=2), ""
    for title, *cells in rows:
        if before and title != before:
            table.add_section()
        _add(table, ["" if title == before else title, *cells])
        before = title
    table.add_section()
    return table


def _overall(lanes: Document, slides: Sequence[bool]) -> Table:
    headings, rows = overall_rows(lanes, slides)
    table = _table(*headings, first=1)
    for cells in rows:
        _add(table, cells)
    return table


def span_text(document: Document, slides: Sequence[bool]) -> str:
    """Return over which span the figures are, and what the joints are called.

    Args:
        document: what ``report`` returned.
        slides: which joints of the arm slide.
    """
    simulation = document["experiment"]["simulation"]
    joints = len(slides)
    span = f"{document['since']:g} to {simulation['horizon']:g} s, {simulation['mode']}"
    each = f"J1 to J{joints} are the joints" if joints > 1 else "J1 is its joint"
    text = f"Figures over {span}; {each}."
    if len(set(slides)) > 1:
        sliding = [f"J{joint}" for joint, slide in enumerate(slides, 1) if slide]
        verb = "slides" if len(sliding) == 1 else "slide"
        which = " and ".join(part for part in (", ".join(sliding[:-1]), sliding[-1]) if part)
        text += f"\nThe second unit is that of {which}, which {verb}; a total mixes both."
    return text


def print_report(document: Document, console: Console) -> None:
    """Print what ``report`` returned."""
    experiment, lanes = document["experiment"], document["lanes"]
    slides = arm_named(experiment["robot"]["model"]).slides
    console.print(Text(experiment["title"] or "Untitled experiment", style="bold"))
    console.print(Text(span_text(document, slides)))
    console.print(_per_joint(lanes, slides))
    console.print(_overall(lanes, slides))
    for name, lane in lanes.items():
        if lane["frozen"]:
            head = Text(f"{name} diverged: ", style="red")
            console.print(head, Text(lane["frozen"]["cause"]), sep="")
    for name, lane in lanes.items():
        if lane["accuracy"]["remark"]:
            head = Text(f"inaccurate, {name}: ", style="yellow")
            console.print(head, Text(lane["accuracy"]["remark"]), sep="")
    for name, lane in lanes.items():
        for note in lane["notes"]:
            style = "yellow" if note["level"] == "warning" else "cyan"
            head = Text(f"{note['level']}, {name}: ", style=style)
            console.print(head, Text(f"{note['path']}: {note['message']}"), sep="")
