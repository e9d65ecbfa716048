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
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.simulate import LaneRun, Run
from slidetune.robot.margins.margin import loop_margin
from slidetune.robot.version import __version__

Document = dict[str, Any]

UNITS = {
    "mae": "rad",
    "max_error": "rad",
    "max_velocity_error": "rad/s",
    "chattering": "N·m/s",
    "high_frequency_torque": "N·m",
    "peak_torque": "N·m",
    "reaching_time": "s",
    "flange_rms": "m",
    "flange_max": "m",
    "diverged_at": "s",
    "error_estimate": "rad",
}
"""Units of ``robot.loop.metrics.Metrics`` and ``robot.loop.accuracy.Accuracy``."""

_PER_JOINT = (
    ("mae", "mean |e|", "mrad", 1e3),
    ("max_error", "max |e|", "mrad", 1e3),
    ("max_velocity_error", "max |de|", "mrad/s", 1e3),
    ("peak_torque", "peak |τ|", "N·m", 1.0),
    ("reaching_time", "reaching time", "s", 1.0),
)
_OVERALL = (
    ("chattering", "chattering", "N·m/s", 1.0),
    ("high_frequency_torque", "τ > 50 Hz", "N·m", 1.0),
    ("flange_rms", "flange RMS", "mm", 1e3),
    ("flange_max", "flange max", "mm", 1e3),
)
NONE = "—"


def report(run: Run, since: float = 0.0) -> Document:
    """Return experiment, figures, remarks and freezes of a run as plain JSON values.

    Args:
        run: the run.
        since: beginning of the span that the figures cover in [s].
    """
    packed = pack(run.experiment)
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
        "units": UNITS,
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


def figure(value: float | None, scale: float = 1.0) -> str:
    """Return a number as a person reads it: four digits, thousands apart, no exponents above."""
    if value is None:
        return NONE
    scaled = value * scale
    return f"{scaled:,.0f}" if abs(scaled) >= 1000.0 else f"{scaled:.4g}"


def _table(*headings: str, first: int) -> Table:
    """Return an empty table whose columns from ``first`` on hold numbers."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, heading in enumerate(headings):
        justify: Literal["left", "right"] = "right" if index >= first else "left"
        table.add_column(Text(heading), justify=justify, overflow="fold")
    return table


def _add(table: Table, cells: Sequence[str]) -> None:
    table.add_row(*(Text(cell) for cell in cells))  # a lane's name is text, not markup


def _per_joint(lanes: Document) -> Table:
    table = _table("", "lane", *(f"J{j + 1}" for j in range(JOINTS)), first=2)
    for key, title, unit, scale in _PER_JOINT:
        heading = f"{title} [{unit}]"
        for name, lane in lanes.items():
            values = (lane["metrics"] or {}).get(key, [None] * JOINTS)
            _add(table, [heading, name, *(figure(value, scale) for value in values)])
            heading = ""
        table.add_section()
    return table


def _overall(lanes: Document) -> Table:
    headings = (f"{title} [{unit}]" for _, title, unit, _ in _OVERALL)
    table = _table("lane", *headings, "error estimate [mrad]", "diverged at [s]", first=1)
    for name, lane in lanes.items():
        metrics, frozen = lane["metrics"] or {}, lane["frozen"]
        values = [figure(metrics.get(key), scale) for key, _, _, scale in _OVERALL]
        estimate = figure(lane["accuracy"]["error_estimate"], 1e3)
        _add(table, [name, *values, estimate, figure(frozen["time"] if frozen else None)])
    return table


def print_report(document: Document, console: Console) -> None:
    """Print what ``report`` returned."""
    experiment, lanes = document["experiment"], document["lanes"]
    simulation = experiment["simulation"]
    console.print(Text(experiment["title"] or "Untitled experiment", style="bold"))
    span = f"{document['since']:g} to {simulation['horizon']:g} s, {simulation['mode']}"
    console.print(Text(f"Figures over {span}; J1 to J6 are the joints."))
    console.print(_per_joint(lanes))
    console.print(_overall(lanes))
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
