"""A run, here or on a dashboard, as a notebook shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.loop.simulate import Run
from slidetune.server.client.whole_response import WholeResponse
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.notebook.view import Panel, Table, View, curve
from slidetune.server.report.run_report import figure_text

Array = np.ndarray

SHOWN = ("mae", "max_error", "chattering", "flange_rms", "peak_torque")
"""Figures in the table of a run (*ours*); ``lane.metrics`` has all of them."""
_TURNING = "Units are those of joints that turn; of one that slides read m for rad and N for N·m."
_ESTIMATE, _ENDED = FIGURES["error_estimate"], FIGURES["diverged_at"]


@dataclass(frozen=True)
class _Lane:
    """What is shown of a lane.

    Attributes:
        time: time in [s]. Shape (n,).
        e: errors in [rad]. Shape (n, joints).
        tau: torques in [N m]. Shape (n, joints).
        figures: by name, as ``Metrics`` has them.
        estimate: estimated error of the angles in [rad].
        at_least: whether it may be many times that.
        remark: what is inaccurate, in words.
        ended: when it left its bounds in [s], or ``None``.
        cause: why.
    """

    time: Array
    e: Array
    tau: Array
    figures: Mapping[str, Any]
    estimate: float | None
    at_least: bool
    remark: str
    ended: float | None
    cause: str


def run_view(run: Run) -> View:
    """Return figures of every lane with their units, and error and torque of every joint."""
    slides = arm_named(run.experiment.robot.model).slides
    simulation = run.experiment.simulation
    title = run.experiment.title or "Untitled experiment"
    lanes = {
        name: _Lane(
            lane.time,
            lane.e,
            lane.tau,
            {shown: getattr(metrics, shown) for shown in SHOWN},
            lane.accuracy.error_estimate,
            lane.accuracy.at_least,
            lane.accuracy.remark,
            None if lane.freeze is None else lane.freeze.time,
            "" if lane.freeze is None else lane.freeze.cause,
        )
        for name, lane in run.lanes.items()
        for metrics in [lane.metrics]
    }
    return _view(f"{title}: {simulation.horizon:g} s, {simulation.mode}", lanes, slides)


def response_view(response: WholeResponse) -> View:
    """Return the same of a response that a dashboard computed.

    It does not tell which joints slide: its numbers have the units of joints that turn, as the
    table says.
    """
    lanes = {
        name: _Lane(
            lane.time,
            lane.columns["e"],
            lane.columns["tau"],
            lane.metrics,
            lane.accuracy.get("error_estimate"),
            bool(lane.accuracy.get("at_least")),
            lane.accuracy.get("remark") or "",
            None if lane.frozen is None else lane.frozen["time"],
            "" if lane.frozen is None else lane.frozen["cause"],
        )
        for name, lane in response.lanes.items()
    }
    return _view(f"Whole response: {response.horizon:g} s", lanes, (), _TURNING)


def _view(
    title: str, lanes: Mapping[str, _Lane], slides: Sequence[bool], caption: str = ""
) -> View:
    causes = [f"{name} diverged: {lane.cause}" for name, lane in lanes.items() if lane.cause]
    doubts = [f"inaccurate, {name}: {lane.remark}" for name, lane in lanes.items() if lane.remark]
    return View(
        title,
        (*causes, *doubts),
        (_table(lanes, slides, caption),),
        (
            ("error", _panels(lanes, "e", "rad", slides)),
            ("torque", _panels(lanes, "tau", "N·m", slides)),
        ),
    )


def _table(lanes: Mapping[str, _Lane], slides: Sequence[bool], caption: str) -> Table:
    unit = unit_of_joints(_ESTIMATE.shown_unit, slides)
    heads = [f"{FIGURES[name].heading} [{_unit(name, slides)}]" for name in SHOWN]
    rows = []
    for name, lane in lanes.items():
        values = (_overall(figure, lane.figures.get(figure)) for figure in SHOWN)
        cells = [figure_text(FIGURES[f], value) for f, value in zip(SHOWN, values, strict=True)]
        told = figure_text(_ESTIMATE, lane.estimate)
        estimate = f"≥ {told}" if lane.at_least and lane.estimate is not None else told
        state = "ran to its end" if lane.ended is None else f"{_ENDED.title} {lane.ended:.4g} s"
        rows.append((name, *cells, estimate, state))
    headings = ("lane", *heads, f"estimated error of the angles [{unit}]", "")
    return Table(headings, tuple(rows), caption)


def _unit(name: str, slides: Sequence[bool]) -> str:
    return unit_of_joints(FIGURES[name].shown_unit, slides)


def _overall(name: str, value: Any) -> float | None:
    if value is None:
        return None
    overall = FIGURES[name].overall(value)
    return None if overall is None or not np.isfinite(overall) else overall


def _panels(
    lanes: Mapping[str, _Lane], column: str, unit: str, slides: Sequence[bool]
) -> tuple[Panel, ...]:
    colors = LaneColors()
    colors.assign(list(lanes))
    count = next(iter(lanes.values())).e.shape[1]
    symbol = {"e": "e", "tau": "τ"}[column]
    return tuple(
        Panel(
            f"Joint {joint + 1}",
            "time [s]",
            f"{symbol} [{unit_of_joints(unit, slides[joint : joint + 1])}]",
            tuple(
                curve(name, colors.of(name), lane.time, getattr(lane, column)[:, joint])
                for name, lane in lanes.items()
            ),
        )
        for joint in range(count)
    )
