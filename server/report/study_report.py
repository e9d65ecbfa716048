"""What studies tell: tables for people, documents for programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.figures import FIGURES, STUDIED
from slidetune.robot.loop.verdict import said
from slidetune.robot.study.judgement import MEANS
from slidetune.robot.study.results import robustness_result, tuning_result, worst_result
from slidetune.robot.study.robustness import QUANTILES, Draw
from slidetune.robot.study.sweep import Axis, Point
from slidetune.robot.study.tune import Trial
from slidetune.robot.study.tuning import Tuning
from slidetune.robot.version import __version__
from slidetune.server.report.run_report import NONE, figure_text, heading

Document = dict[str, Any]

_ENDED = FIGURES["diverged_at"]
_MOST_DIGITS = 7
"""Of a ratio; beyond these it is said in words (*ours*)."""


def tuning_document(experiment: Experiment, tuning: Tuning, trials: Sequence[Trial]) -> Document:
    """Return a search and what came of it as plain JSON values."""
    return {
        "slidetune": __version__,
        "tuning": tuning.model_dump(mode="json"),
        **tuning_result(experiment, tuning, trials),
        "trials": [trial.document() for trial in trials],
        "experiment": experiment.document(),
    }


def robustness_document(
    experiment: Experiment, lane: str, draws: Sequence[Draw], tried: Sequence[Draw]
) -> Document:
    """Return draws, their quantiles and the worst found as plain JSON values."""
    return {
        "slidetune": __version__,
        "lane": lane,
        "draws": [draw.document() for draw in draws],
        **robustness_result(draws),
        **worst_result(tried),
        "experiment": experiment.document(),
    }


def sweep_document(
    experiment: Experiment, lane: str, axes: Sequence[Axis], points: Sequence[Point]
) -> Document:
    """Return a sweep as plain JSON values."""
    return {
        "slidetune": __version__,
        "lane": lane,
        "axes": [{"field": one.field, "values": list(one.values)} for one in axes],
        "points": [point.document() for point in points],
        "experiment": experiment.document(),
    }


def _slides(experiment: Experiment) -> tuple[bool, ...]:
    return arm_named(experiment.robot.model).slides


def _number(value: float | None) -> str:
    return NONE if value is None else f"{value:.4g}"


def ratio_text(ratio: float | None, digits: int = 4) -> str:
    """Return a ratio to a bound, or a score; a missed bound never reads as one that is just met."""
    if ratio is None:
        return NONE
    texts = (f"{ratio:.{count}g}" for count in range(digits, _MOST_DIGITS + 1))
    return next((text for text in texts if ratio <= 1.0 or text != "1"), "> 1")


def _table(*headings: str) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, text in enumerate(headings):
        table.add_column(Text(text), justify="right" if index else "left", overflow="fold")
    return table


def _row(table: Table, *cells: str) -> None:
    table.add_row(*(Text(cell) for cell in cells))


def print_tuning(experiment: Experiment, document: Document, console: Console) -> None:
    """Print what ``tuning_document`` returned: goals and gains, before and after."""
    present, best, slides = document["present"], document["best"], _slides(experiment)
    if best is None:
        console.print(Text("No trial came to its end.", style="red"))
        return
    tuning = document["tuning"]
    judged = (
        f"judged by the {tuning['judged_by']} of {tuning['draws']} draws"
        if tuning["draws"]
        else "judged by the experiment as it is"
    )
    quiet = ", no more chattering than now" if tuning["quiet"] else ""
    console.print(Text(f"{tuning['lane']}: {len(document['trials'])} trials, {judged}{quiet}"))
    goals = _table("goal", "", "before", "after")
    for name, goal in experiment.goals.items():
        ratios = (one["outcome"]["ratios"][name] for one in (present, best))
        _row(goals, f"{name}: {said(goal, slides)}", goal.priority, *map(ratio_text, ratios))
    console.print(goals)
    counts = " Ratios and figures are those of the draw that counts." if tuning["draws"] else ""
    console.print(Text(f"1 is just met; before is the lane as it is.{counts}"))
    figures = _table("figure", "before", "after")
    for name in STUDIED:
        values = (one["outcome"]["figures"][name] for one in (present, best))
        shown = (figure_text(FIGURES[name], value) for value in values)
        _row(figures, heading(FIGURES[name], slides), *shown)
    console.print(figures)
    gains = _table("gain", "before", "after")
    for name, value in best["values"].items():
        _row(gains, name, _number(present["values"][name]), _number(value))
    console.print(gains)
    if tuning["draws"]:
        _print_draws(present["draws"], best["draws"], slides, console)
    if not best["outcome"]["kept"]:
        text = "No set of gains keeps every hard goal."
        if tuning["draws"]:
            text += (
                " That takes a bound with room for the draws, a goal that is soft, or gains over "
                "wider ranges."
            )
        console.print(Text(text, style="yellow"))


def _print_draws(
    present: Document, best: Document, slides: tuple[bool, ...], console: Console
) -> None:
    table = _table("over all draws", "before", "after")
    for name in MEANS:
        shown = (figure_text(FIGURES[name], one["means"][name]) for one in (present, best))
        _row(table, f"{heading(FIGURES[name], slides)}, mean", *shown)
    _row(table, "keep the hard goals", *(f"{one['kept']:.0%}" for one in (present, best)))
    console.print(table)


def print_robustness(experiment: Experiment, document: Document, console: Console) -> None:
    """Print what ``robustness_document`` returned."""
    count, slides = len(document["draws"]), _slides(experiment)
    shares = f"{document['diverged']:.1%} diverged, {document['kept']:.1%} kept every hard goal"
    console.print(Text(f"{document['lane']}: {count} draws, {shares}"))
    table = _table("", *QUANTILES)
    found = document["quantiles"]
    for name in STUDIED:
        cells = (figure_text(FIGURES[name], found["figures"][name][label]) for label in QUANTILES)
        _row(table, heading(FIGURES[name], slides), *cells)
    for name, goal in experiment.goals.items():
        cells = (ratio_text(found["ratios"][name][label]) for label in QUANTILES)
        _row(table, f"ratio of {name}: {said(goal, slides)}", *cells)
    console.print(table)
    worst = document["worst_found"]
    if worst is not None:
        values = ", ".join(f"{name} {value:.4g}" for name, value in worst["values"].items())
        score = ratio_text(worst["outcome"]["score"])
        console.print(Text(f"Worst found (no proof that there is none worse): {score} at {values}"))


def print_sweep(
    experiment: Experiment, axes: Sequence[Axis], points: Sequence[Point], console: Console
) -> None:
    """Print a sweep as a table."""
    goals, slides = [f"ratio of {name}" for name in experiment.goals], _slides(experiment)
    headings = (heading(FIGURES[name], slides) for name in STUDIED)
    table = _table(*(one.field for one in axes), *headings, *goals, "")
    for point in points:
        one = point.outcome
        figures = (figure_text(FIGURES[name], one.figures[name]) for name in STUDIED)
        ratios = map(ratio_text, one.ratios.values())
        state = "" if one.diverged_at is None else f"{_ENDED.title} {one.diverged_at:.3g} s"
        state = one.refused or state
        _row(table, *map(_number, point.values), *figures, *ratios, state)
    console.print(table)
