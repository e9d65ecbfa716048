"""The paper's figures, drawn from our runs: 4 to 15 and 17 to 19.

Source: Liu et al., Symmetry 2025, 17(8), 1319.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from slidetune.robot.loop.simulate import LaneRun, Run
from slidetune.server.report.figure_page import (
    Figure,
    Section,
    figure_page,
    html_paragraphs,
    html_table,
)
from slidetune.server.report.paper_table import (
    DISTURBED,
    FLANGE_HEADINGS,
    HEADINGS,
    LAWS,
    QUINTIC,
    comparison,
    flange_rows,
    legend,
    remarks,
)
from slidetune.server.report.run_figures import curves

Array = np.ndarray

TITLE = "Liu et al. 2025: the published comparison, run again"
LEAD = (
    f"{', '.join(LAWS[:-1])} and {LAWS[-1]} on the JAKA Zu 5, computed by Slidetune: the published "
    "values beside ours, then the curves of Figures 4 to 15 and 17 to 19."
)


def _caption(number: int, preset: str) -> str:
    return f"Corresponds to Figure {number} of the paper; preset {preset}."


def _joints(
    run: Run, first: int, title: str, axis: str, name: str, desired: Array | None = None
) -> Section:
    """Return one quantity of joints 1 to 3; ``first`` is the paper's figure of joint 1."""

    def figure(joint: int) -> Figure:
        wanted = None if desired is None else desired[:, joint]
        lines = curves(run, lambda lane: getattr(lane, name)[:, joint], wanted)
        heading = f"{title} of joint {joint + 1}"
        return Figure(heading, _caption(first + joint, DISTURBED), axis, lines)

    numbers = f"Figures {first} to {first + 2}"
    return Section(f"{title} ({numbers})", tuple(figure(joint) for joint in range(3)))


def _flange(run: Run) -> Section:
    desired = next(iter(run.lanes.values())).flange_desired

    def figure(axis: int) -> Figure:
        def column(lane: LaneRun) -> Array:
            return lane.flange[:, axis]

        name = "XYZ"[axis]
        lines = curves(run, column, desired[:, axis])
        caption = _caption(17 + axis, QUINTIC)
        return Figure(f"Flange along {name}", caption, f"{name} [m]", lines)

    return Section("Flange (Figures 17 to 19)", tuple(figure(axis) for axis in range(3)))


def paper_sections(runs: Mapping[str, Run]) -> list[Section]:
    """Return the paper's figures, in its order.

    Args:
        runs: the runs of ``paper`` and ``experiment-quintic``, by name.
    """
    run = runs[DISTURBED]
    return [
        _joints(run, 4, "Position tracking", "q [rad]", "q", run.q_d),
        _joints(run, 7, "Position error", "e [rad]", "e"),
        _joints(run, 10, "Velocity tracking", "v [rad/s]", "v", run.v_d),
        _joints(run, 13, "Velocity error", "de [rad/s]", "de"),
        _flange(runs[QUINTIC]),
    ]


def paper_page(runs: Mapping[str, Run]) -> str:
    """Return one HTML file with the tables, the remarks and all figures; it needs no network.

    Args:
        runs: the runs of all ``server.report.paper_table.PRESETS``, by name.
    """
    table = [
        (row.law, row.source, *(cell.text() for cell in row.cells)) for row in comparison(runs)
    ]
    body = html_paragraphs([LEAD])
    body += html_table(HEADINGS, table, legend())
    flange = "Flange error of the experiment; the paper shows curves and gives no values."
    body += html_table(FLANGE_HEADINGS, flange_rows(runs), flange)
    body += html_paragraphs(list(remarks(runs)))
    return figure_page(TITLE, body, paper_sections(runs))
