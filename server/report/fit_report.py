"""What a fit tells: published figures, before and after, and how many numbers were fitted."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.study.fit import Fitting, FitTrial, Target
from slidetune.robot.version import __version__
from slidetune.server.report.run_report import NONE

FEW = 3
"""So many data more than fitted numbers are few (*ours*)."""


def fit_document(
    experiment: Experiment, fitting: Fitting, trials: Sequence[FitTrial]
) -> dict[str, Any]:
    """Return a fit and what came of it as plain JSON values."""
    best = min(trials, key=lambda trial: trial.deviation, default=None)
    return {
        "slidetune": __version__,
        "fitting": fitting.model_dump(mode="json"),
        "present": trials[0].document() if trials else None,
        "best": None if best is None else best.document(),
        "warning": warning(fitting),
        "trials": [trial.document() for trial in trials],
        "experiment": experiment.document(),
    }


def warning(fitting: Fitting) -> str:
    """Return what is to be thought of a close fit, an empty text for nothing."""
    data, numbers = len(fitting.targets), len(fitting.fields)
    if fitting.spare <= 0:
        return (
            f"{numbers} numbers are fitted to {data} data: they can be met whether the rest is "
            "right or not, so that a close fit proves nothing."
        )
    if fitting.spare < FEW:
        return (
            f"{numbers} numbers are fitted to {data} data, hardly more than there are numbers: a "
            "close fit proves little."
        )
    return ""


def print_fit(fitting: Fitting, document: dict[str, Any], console: Console) -> None:
    """Print what ``fit_document`` returned."""
    present, best = document["present"], document["best"]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, text in enumerate(("figure", "published", "before", "after", "off by")):
        table.add_column(Text(text), justify="right" if place else "left")
    rows = zip(fitting.targets, present["figures"], best["figures"], strict=True)
    for one, before, after in rows:
        off = NONE if after is None else f"{after / one.value - 1.0:+.0%}"
        cells = (_number(one.value), _number(before), _number(after), off)
        table.add_row(Text(_said(one)), *map(Text, cells))
    console.print(table)
    fields = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, text in enumerate(("fitted", "before", "after")):
        fields.add_column(Text(text), justify="right" if place else "left")
    for name, value in best["values"].items():
        fields.add_row(Text(name), Text(_number(present["values"][name])), Text(_number(value)))
    console.print(fields)
    factors = (f"{exp(one['deviation']):.2f}" for one in (present, best))
    console.print(Text("Typical factor from the published figures: {}, now {}.".format(*factors)))
    text = f"{len(fitting.fields)} numbers fitted to {len(fitting.targets)} data."
    console.print(Text(document["warning"] or text, style="yellow" if document["warning"] else ""))


def _said(one: Target) -> str:
    figure = FIGURES[one.figure]
    joint = f" of joint {one.joint}" if one.joint else ""
    since = f" from {one.since:g} s on" if one.since else ""
    return f"{one.lane}: {figure.title}{joint}{since} [{figure.unit}]"


def _number(value: float | None) -> str:
    return NONE if value is None else f"{value:.4g}"
