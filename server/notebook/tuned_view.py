"""What a search found, as a notebook shows it: before and after, and how it went."""

from __future__ import annotations

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.loop.figures import FIGURES, STUDIED
from slidetune.robot.loop.verdict import said
from slidetune.robot.study.judgement import MEANS
from slidetune.robot.study.tune import best_of
from slidetune.server.live.lane_colors import PALETTE
from slidetune.server.notebook.tuned import Tuned
from slidetune.server.notebook.view import Line, Panel, Table, View
from slidetune.server.report.run_report import figure_text, heading
from slidetune.server.report.study_report import ratio_text


def tuned_view(tuned: Tuned) -> View:
    """Return goals, figures and gains before and after, and the score of every trial."""
    experiment, settings = tuned.experiment, tuned.settings
    slides = arm_named(experiment.robot.model).slides
    before, after = tuned.before, tuned.after
    both = (before, after)
    judged = (
        f"judged by the {settings.judged_by} of {settings.draws} draws"
        if settings.draws
        else "judged by the experiment as it is"
    )
    quiet = ", no more chattering than now" if settings.quiet else ""
    notes = []
    if tuned.interrupted:
        notes.append(f"Interrupted after {len(tuned.trials)} of {settings.trials} trials.")
    if not after.kept:
        notes.append("No set of gains keeps every hard goal.")
    goals = [
        (
            f"{name}: {said(goal, slides)} ({goal.priority})",
            *(ratio_text(one.ratios[name]) for one in both),
        )
        for name, goal in experiment.goals.items()
    ]
    figures = [
        (
            heading(FIGURES[name], slides),
            *(figure_text(FIGURES[name], one.figures[name]) for one in both),
        )
        for name in STUDIED
    ]
    gains = [
        (name, f"{before.gains[name]:.4g}", f"{value:.4g}") for name, value in after.gains.items()
    ]
    tables = [
        Table(("goal: ratio to its bound, 1 is just met", "before", "after"), tuple(goals)),
        Table(("figure", "before", "after"), tuple(figures)),
        Table(("gain", "before", "after"), tuple(gains)),
    ]
    if settings.draws:
        means = [
            (
                f"{heading(FIGURES[name], slides)}, mean",
                *(figure_text(FIGURES[name], one.draws["means"][name]) for one in both),
            )
            for name in MEANS
        ]
        kept = ("keep the hard goals", *(f"{one.draws['kept']:.0%}" for one in both))
        tables.append(Table(("over all draws", "before", "after"), (*means, kept)))
    title = f"{settings.lane}: {len(tuned.trials)} trials, {judged}{quiet}"
    return View(title, tuple(notes), tuple(tables), (("score", (_course(tuned),)),))


def _course(tuned: Tuned) -> Panel:
    numbers = np.array([one.number for one in tuned.trials], float)
    scores = _numbers([one.outcome.score for one in tuned.trials])
    given_up = np.array([one.beaten for one in tuned.trials])
    bests, best = [], None
    for trial in tuned.trials:
        best = best_of([trial] if best is None else [best, trial])
        bests.append(None if best is None else best.outcome.score)
    lines = [
        Line("tried", PALETTE[0], numbers, np.where(given_up, np.nan, scores), points=True),
        Line("best so far", PALETTE[1], numbers, _numbers(bests)),
    ]
    if given_up.any():
        worse = np.where(given_up, scores, np.nan)
        lines.insert(1, Line("given up: no better than this", PALETTE[5], numbers, worse, True))
    return Panel("Search", "trial", "score: ratio that decides", tuple(lines), logarithmic=True)


def _numbers(values: list[float | None]) -> np.ndarray:
    return np.array([np.nan if one is None else one for one in values], float)
