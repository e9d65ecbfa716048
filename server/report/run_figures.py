"""The curves of a whole run, joint by joint, as figures of a page."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.fields.units import in_units_of
from slidetune.robot.loop.simulate import LaneRun, Run
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.report.figure_page import DESIRED, Curve, Figure, Section

Array = np.ndarray
Column = Callable[[LaneRun], Array]


def curves(run: Run, column: Column, desired: Array | None = None) -> tuple[Curve, ...]:
    """Return one column of every lane, in the lanes' colours, and the desired one above them.

    Args:
        run: the run.
        column: takes the column from a lane. Shape (n,).
        desired: the desired values, if there are any. Shape (n,).
    """
    colors = LaneColors()
    colors.assign(list(run.lanes))
    lanes = [
        Curve(name, colors.of(name), run.time, column(lane)) for name, lane in run.lanes.items()
    ]
    above = [] if desired is None else [Curve(DESIRED, "", run.time, desired)]
    return (*lanes, *above)


def _joints(run: Run, title: str, axis: str, name: str, desired: Array | None = None) -> Section:
    slides = arm_named(run.experiment.robot.model).slides

    def figure(joint: int) -> Figure:
        wanted = None if desired is None else desired[:, joint]
        lines = curves(run, lambda lane: getattr(lane, name)[:, joint], wanted)
        return Figure(f"Joint {joint + 1}", "", in_units_of(axis, [slides[joint]]), lines)

    return Section(title, tuple(figure(joint) for joint in range(run.experiment.joints)))


def _distance(lane: LaneRun) -> Array:
    distance: Array = np.linalg.norm(lane.flange - lane.flange_desired, axis=1)
    return distance * 1e3


def run_sections(run: Run) -> list[Section]:
    """Return position, errors, sliding variable and torque of all joints, and the flange's error.

    Args:
        run: the run.
    """
    flange = Figure("Flange", "", "distance from the desired one [mm]", curves(run, _distance))
    return [
        _joints(run, "Position", "q [rad]", "q", run.q_d),
        _joints(run, "Position error", "e [rad]", "e"),
        _joints(run, "Velocity error", "de [rad/s]", "de"),
        _joints(run, "Sliding variable", "S [rad/s]", "S"),
        _joints(run, "Torque", "τ [N·m]", "tau"),
        Section("Flange error", (flange,)),
    ]
