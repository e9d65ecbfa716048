"""How a run keeps to its experiment's goals: each as a ratio to its bound, and the score."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.goals.section import CHANNELS, LATEST, FigureGoal, Goal, ResponseGoal
from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.loop.metrics import Metrics
from slidetune.robot.loop.simulate import LaneRun

Array = np.ndarray


@dataclass(frozen=True)
class Verdict:
    """How a lane keeps to its goals.

    Attributes:
        ratios: value over bound of every goal, by name: 1 is just met. ``None`` where a run can't
            tell: it left its bounds, or the figure is not known.
        hard: largest ratio of the hard goals, 0 without one; ``None`` where one of them can't be
            told.
        soft: the same of the soft ones.
        score: the largest hard ratio where one is above 1 or there are no soft goals, else the
            largest soft one; ``None`` where it can't be told.
        worst: name of the goal that decides the score, or an empty text.
    """

    ratios: dict[str, float | None]
    hard: float | None
    soft: float | None
    score: float | None
    worst: str

    @property
    def met(self) -> bool:
        """Whether every goal holds."""
        return None not in (self.hard, self.soft) and max(self.hard or 0.0, self.soft or 0.0) <= 1.0

    @property
    def kept(self) -> bool:
        """Whether every hard goal holds."""
        return self.hard is not None and self.hard <= 1.0

    def document(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return {
            "ratios": self.ratios,
            "hard": self.hard,
            "soft": self.soft,
            "score": self.score,
            "kept": self.kept,
            "met": self.met,
            "worst": self.worst,
        }


def judge_goals(goals: Mapping[str, Goal], run: LaneRun, metrics: Metrics) -> Verdict:
    r"""Return how a run keeps to goals.

    .. math:: \text{response: } \max_{t \in [t_0, t_1]} |x(t)| / b, \qquad
        \text{figure: } x / b

    Args:
        goals: by name.
        run: what a lane did.
        metrics: its figures, which take as long as all goals together.
    """
    ratios = {name: _ratio(goal, run, metrics) for name, goal in goals.items()}
    of = {
        priority: {name: ratios[name] for name, goal in goals.items() if goal.priority == priority}
        for priority in ("hard", "soft")
    }
    hard, soft = (_largest(of[priority]) for priority in ("hard", "soft"))
    first = hard is None or hard > 1.0 or not of["soft"]
    deciding = of["hard" if first else "soft"]
    worst = max(deciding, key=lambda name: _infinite(deciding[name]), default="")
    return Verdict(ratios, hard, soft, hard if first else soft, worst)


def _infinite(ratio: float | None) -> float:
    return float(np.inf) if ratio is None else ratio


def _largest(ratios: Mapping[str, float | None]) -> float | None:
    known = [ratio for ratio in ratios.values() if ratio is not None]
    return None if len(known) < len(ratios) else max(known, default=0.0)


def _ratio(goal: Goal, run: LaneRun, metrics: Metrics) -> float | None:
    if isinstance(goal, ResponseGoal):
        value = _greatest(goal, run)
    elif isinstance(goal, FigureGoal) and run.freeze is None:
        value = _figure(goal, metrics)
    else:
        value = None
    return None if value is None else value / goal.bound


def _greatest(goal: ResponseGoal, run: LaneRun) -> float | None:
    """Return the greatest absolute value within the goal's span, ``None`` of an unfinished run."""
    # Half a row to each side: 0.3 s is a row, whatever 300 times 0.001 is in binary.
    half = 0.5 * float(run.time[1] - run.time[0]) if len(run.time) > 1 else 0.0
    first, last = np.searchsorted(run.time, [goal.start - half, goal.end + half])
    if first >= last:
        return 0.0  # nothing to keep to: it begins after the horizon
    values = _channel(goal, run, slice(int(first), int(last)))
    greatest = float(np.max(np.abs(values)))
    return greatest if np.isfinite(greatest) else None


def _channel(goal: ResponseGoal, run: LaneRun, rows: slice) -> Array:
    if goal.channel == "flange_error":
        way = run.flange[rows] - run.flange_desired[rows]
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", way, way)))
    columns: Array = getattr(run, goal.channel)[rows]
    return columns[:, goal.joint - 1] if goal.joint else columns


def _figure(goal: FigureGoal, metrics: Metrics) -> float | None:
    value = getattr(metrics, goal.figure)
    if goal.joint:
        one = value[goal.joint - 1]
        return None if one is None or np.isnan(one) else float(one)
    return FIGURES[goal.figure].overall(value)


def unit_of(goal: Goal) -> str:
    """Return the unit of a goal's bound, empty for none."""
    if isinstance(goal, ResponseGoal):
        return CHANNELS[goal.channel][1]
    return FIGURES[goal.figure].unit if isinstance(goal, FigureGoal) else ""


def said(goal: Goal, slides: Sequence[bool] = ()) -> str:
    """Return a goal in words, such as ``|e₂| ≤ 0.005 rad from 1 s on``.

    Args:
        goal: the goal.
        slides: which joints of the arm slide; without it none.
    """
    joint = f" of joint {goal.joint}" if goal.joint else ""
    concerned = slides[goal.joint - 1 : goal.joint] if goal.joint else slides
    bound = f"{goal.bound:g} {unit_of_joints(unit_of(goal), concerned)}".strip()
    if isinstance(goal, FigureGoal):
        return f"{FIGURES[goal.figure].title}{joint} ≤ {bound}"
    assert isinstance(goal, ResponseGoal)
    words = f"{CHANNELS[goal.channel][0]}{joint} ≤ {bound}"
    if goal.end < LATEST:
        return f"{words}, {goal.start:g} to {goal.end:g} s"
    return f"{words} from {goal.start:g} s on" if goal.start else words
