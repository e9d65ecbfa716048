"""What came of a run, as HTML: goals, figures, advice, and what became of each lane."""

from __future__ import annotations

from html import escape

from slidetune.robot.arm.known import arm_named
from slidetune.robot.loop.figures import figures_of
from slidetune.robot.loop.simulate import Run
from slidetune.robot.loop.verdict import judge_goals, said
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.report.figure_page import html_paragraphs, html_table
from slidetune.server.report.run_report import (
    NONE,
    Document,
    figure_text,
    overall_rows,
    per_joint_rows,
)

_MARGINS = figures_of("margin")


def lane_items(run: Run) -> str:
    """Return a list of the lanes in their colours, with what became of each."""
    colors = LaneColors()
    colors.assign(list(run.lanes))
    items = []
    for name, lane in run.lanes.items():
        text = f"<strong>{escape(name)}</strong>"
        if lane.freeze is not None:
            text += f' <span class="bad">diverged: {escape(lane.freeze.cause)}</span>'
        if lane.accuracy.remark:
            text += f' <span class="doubt">inaccurate: {escape(lane.accuracy.remark)}</span>'
        items.append(f'<li style="--lane: {colors.of(name)}">{text}</li>\n')
    return f'<ul class="lanes">\n{"".join(items)}</ul>\n'


def goal_table(run: Run) -> str:
    """Return how each lane keeps to each goal: its value over the bound."""
    goals = run.experiment.goals
    if not goals:
        return html_paragraphs(["The experiment has no goals."])
    slides = arm_named(run.experiment.robot.model).slides
    verdicts = {name: judge_goals(goals, lane, lane.metrics) for name, lane in run.lanes.items()}
    rows = []
    for goal_name, goal in goals.items():
        ratios = (verdict.ratios[goal_name] for verdict in verdicts.values())
        rows.append([goal_name, said(goal, slides), goal.priority, *map(_kept, ratios)])
    together = (_together(verdict.met, verdict.score) for verdict in verdicts.values())
    rows.append(["all of them", "", "", *together])
    caption = (
        "Value over bound in each lane, over the whole run: up to 1 the goal is met. unknown where "
        "a lane left its bounds or the figure has no value."
    )
    return html_table(["goal", "bound", "priority", *run.lanes], rows, caption)


def _kept(ratio: float | None) -> str:
    if ratio is None:
        return "unknown"
    # Rounded towards what it is: 1.0004 must not read as 1.
    text = f"{ratio:.3g}" if not 0.995 < ratio < 1.005 else f"{ratio:.6g}"
    return f"{text} met" if ratio <= 1.0 else f"{text} missed"


def _together(met: bool, score: float | None) -> str:
    return "unknown" if score is None else "met" if met else "missed"


def figure_tables(run: Run, document: Document) -> str:
    """Return the figures of every lane, and the estimate of their error.

    Args:
        run: the run.
        document: what ``server.report.run_report.report`` returned of it.
    """
    slides = arm_named(run.experiment.robot.model).slides
    lanes = document["lanes"]
    overall = html_table(
        *overall_rows(lanes, slides),
        "Of the whole arm. error estimate: greatest error of any joint's angle over the run that "
        "the integration leaves, estimated by a second, coarser run.",
        texts=1,
    )
    each = html_table(*per_joint_rows(lanes, slides), "Of each joint.")
    return overall + each + _margins(document)


def _margins(document: Document) -> str:
    lanes = document["lanes"]
    if all(lane["margin"] is None for lane in lanes.values()):
        return ""
    rows = []
    for name, lane in lanes.items():
        margin = lane["margin"] or {}
        stable = {True: "yes", False: "no", None: NONE}[margin.get("stable")]
        values = (figure_text(figure, margin.get(figure.name)) for figure in _MARGINS)
        rows.append([name, *values, stable])
    headings = ["lane", *(f"{figure.title} {figure.symbol}" for figure in _MARGINS), "stable"]
    meanings = "; ".join(f"{figure.symbol}: {figure.meaning}" for figure in _MARGINS)
    return html_table(headings, rows, f"Of the sampled loop, linearised. {meanings}.", texts=1)


def advice_items(document: Document) -> str:
    """Return the advice on every lane as a list.

    Args:
        document: what ``server.report.run_report.report`` returned.
    """
    items = [
        f'<li class="{escape(note["level"])}"><strong>{escape(name)}</strong> '
        f"<code>{escape(note['path'])}</code> {escape(note['message'])}</li>\n"
        for name, lane in document["lanes"].items()
        for note in lane["notes"]
    ]
    if not items:
        return html_paragraphs(["There is nothing to say against these numbers."])
    return f'<ul class="advice">\n{"".join(items)}</ul>\n'
