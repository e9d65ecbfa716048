"""Whether a lane of the live session keeps its hard goals in the seconds after an edit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from slidetune.robot.goals.section import CHANNELS, FigureGoal, Goal, ResponseGoal
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.figures import FIGURES
from slidetune.server.live.running_metrics import RunningMetrics
from slidetune.server.live.telemetry import Channel

Array = np.ndarray

SECONDS = 10.0
"""For how long new gains are watched, in [s] of simulated time (*ours*)."""
GREATEST = frozenset({"max_error", "max_velocity_error", "peak_torque", "flange_max"})
"""Figures that only grow: they are judged at every row, others at the end."""
MEAN = frozenset({"mae", "chattering", "flange_rms", "rms_torque"})
"""Figures that are judged at the end."""


def can_watch(goal: Goal) -> bool:
    """Tell whether the live session measures what a goal bounds."""
    return isinstance(goal, ResponseGoal) or (
        isinstance(goal, FigureGoal) and goal.figure in GREATEST | MEAN
    )


@dataclass
class GoalWatch:
    """Watches one lane; touched by the session's thread alone, once the session has it.

    A response that is beyond its bound at the beginning counts once it has been within it, or if it
    is never: new gains are not blamed for what the old ones left. A goal with an end before the
    horizon holds for these instants alone, one without for as long as the session lasts.

    Attributes:
        lane: its name.
        gains: what it has now; whoever changes them ends the watch.
        goals: the hard ones that can be watched, by name; who changes one takes it out.
        horizon: length of a whole run in [s].
        revision: the experiment's, from which on it counts.
        epoch: of the session; a reset ends the watch.
        fail: called with what happened, in words, where a goal was left.
        decided: whether there is nothing more to watch.
    """

    lane: str
    gains: Any
    goals: Mapping[str, Goal]
    horizon: float
    revision: int
    epoch: int
    fail: Callable[[str], None]
    decided: bool = False
    _began: float = 0.0
    _metrics: RunningMetrics | None = None
    _inside: dict[str, bool] = field(default_factory=dict)

    def look(
        self,
        rows: Array,
        columns: list[Channel],
        loop: ClosedLoop,
        present: tuple[int, int],
        time: float,
    ) -> None:
        """Take in what the loop has just written, until it is decided.

        Args:
            rows: telemetry. Shape (n, columns).
            columns: its columns.
            loop: the closed loop, after these rows.
            present: revision and epoch of the session.
            time: time of the first row in [s].
        """
        if self.decided or present[0] < self.revision:
            return
        experiment = loop.packed.experiment
        lane, gains = loop.lanes.get(self.lane), experiment.lanes.get(self.lane)
        if lane is None or present[1] != self.epoch or gains != self.gains:
            self.decided = True
            return
        if self._metrics is None:
            self._began, self._metrics = time, RunningMetrics(columns, self.lane, time, "change")
        self._metrics.find(columns, self.lane)
        self._metrics.add(rows, time, loop.period)
        self.decided = over = loop.time >= self._began + SECONDS
        if lane.freeze is not None:
            self._fails(lane.freeze.cause)
            return
        for goal_name, goal in self.goals.items():
            if experiment.goals.get(goal_name) != goal:
                continue
            if said := self._judged(goal_name, goal, rows, columns, loop, time, over):
                self._fails(said)
                return

    def _fails(self, said: str) -> None:
        self.decided = True
        self.fail(said)

    def _judged(
        self,
        name: str,
        goal: Goal,
        rows: Array,
        columns: list[Channel],
        loop: ClosedLoop,
        time: float,
        over: bool,
    ) -> str:
        """Return in words how a goal was left, or an empty text."""
        if isinstance(goal, ResponseGoal):
            times = time + loop.period * np.arange(len(rows))
            last = np.inf if goal.end >= self.horizon else goal.end
            within = rows[(times >= goal.start) & (times <= last)]
            return self._response(name, goal, within, columns, over) if len(within) else ""
        assert isinstance(goal, FigureGoal)
        assert self._metrics is not None
        if goal.figure in MEAN and not over:
            return ""
        figure = FIGURES[goal.figure]
        values = (self._metrics.total.document() or {})[goal.figure]
        value = values[goal.joint - 1] if goal.joint else figure.overall(values)
        if value is None or value <= goal.bound:
            return ""
        return _words(figure.title, goal, value, figure.unit)

    def _response(
        self, name: str, goal: ResponseGoal, rows: Array, columns: list[Channel], over: bool
    ) -> str:
        values = np.abs(_values(goal, rows, columns, self.lane))
        greatest = values.max(axis=1)
        symbol, unit = CHANNELS[goal.channel]
        if not self._inside.get(name):
            inside = greatest <= goal.bound
            if not inside.any():
                said = _words(symbol, goal, float(greatest[-1]), unit)
                return f"it never came within its bound, {said}" if over else ""
            self._inside[name] = True
            values, greatest = values[inside.argmax() :], greatest[inside.argmax() :]
        if (worst := float(greatest.max())) <= goal.bound:
            return ""
        joint = int(values[greatest.argmax()].argmax()) + 1 if values.shape[1] > 1 else 0
        return _words(symbol, goal, worst, unit, joint)


def _values(goal: ResponseGoal, rows: Array, columns: list[Channel], lane: str) -> Array:
    def of(group: str, owner: str) -> list[int]:
        return [i for i, one in enumerate(columns) if (one.group, one.lane) == (group, owner)]

    if goal.channel == "flange_error":
        gap = rows[:, of("flange", lane)] - rows[:, of("flange_d", "")]
        return np.asarray(np.linalg.norm(gap, axis=1))[:, None]
    values: Array = rows[:, of(goal.channel, lane)]
    return values[:, goal.joint - 1 : goal.joint] if goal.joint else values


def _words(what: str, goal: Goal, value: float, unit: str, joint: int = 0) -> str:
    number = goal.joint or joint
    of = f" of joint {number}" if number else ""
    return f"{what}{of} reached {value:.4g} {unit}, {goal.bound:g} {unit} is allowed"
