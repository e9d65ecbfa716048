"""Goals against the columns of a run, computed here from these alone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.goals.section import FigureGoal, Goal, ResponseGoal
from slidetune.robot.loop.lane import Freeze
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.loop.verdict import judge_goals, said, unit_of

LANE = "NFTSM"


@pytest.fixture(scope="module")
def run() -> LaneRun:
    short = {"simulation": {"horizon": 2.0}}
    return simulate(load_preset("paper").patched(short), estimate=False).lanes[LANE]


def ratio(run: LaneRun, goal: Goal) -> float | None:
    return judge_goals({"g": goal}, run, run.metrics).ratios["g"]


@pytest.mark.parametrize("channel", ["e", "de", "tau", "S"])
@pytest.mark.parametrize("joint", [0, 1, 6])
def test_a_response_is_held_against_its_greatest_value_in_the_span(
    run: LaneRun, channel: Any, joint: int
) -> None:
    values = np.abs(getattr(run, channel))
    if joint:
        values = values[:, [joint - 1]]
    inside = (run.time > 0.2995) & (run.time < 1.1005)
    goal = ResponseGoal(channel=channel, joint=joint, bound=0.02, start=0.3, end=1.1)
    assert ratio(run, goal) == pytest.approx(values[inside].max() / 0.02, rel=1e-12)
    whole = ResponseGoal(channel=channel, joint=joint, bound=0.02)
    assert ratio(run, whole) == pytest.approx(values.max() / 0.02, rel=1e-12)


def test_the_flange_is_held_by_its_distance(run: LaneRun) -> None:
    distance = np.linalg.norm(run.flange - run.flange_desired, axis=1)
    goal = ResponseGoal(channel="flange_error", bound=0.001, start=1.0)
    assert ratio(run, goal) == pytest.approx(distance[1000:].max() / 0.001, rel=1e-12)


def test_a_goal_after_the_horizon_asks_for_nothing(run: LaneRun) -> None:
    assert ratio(run, ResponseGoal(bound=1e-9, start=3.0)) == 0.0


def test_a_figure_is_held_as_the_table_shows_it_or_of_one_joint(run: LaneRun) -> None:
    metrics = run.metrics
    assert ratio(run, FigureGoal(figure="mae", bound=0.5)) == pytest.approx(
        metrics.mae.mean() / 0.5
    )
    third = FigureGoal(figure="peak_torque", joint=3, bound=50.0)
    assert ratio(run, third) == pytest.approx(metrics.peak_torque[2] / 50.0)
    assert ratio(run, FigureGoal(figure="chattering", bound=10.0)) == pytest.approx(
        metrics.chattering / 10.0
    )


def goals(hard: float, soft: float) -> dict[str, Goal]:
    return {
        "hard": FigureGoal(figure="mae", bound=1.0 / hard, priority="hard"),
        "soft": FigureGoal(figure="mae", bound=1.0 / soft),
    }


def test_the_score_is_the_hard_ratio_until_that_holds(run: LaneRun) -> None:
    mae = float(run.metrics.mae.mean())
    missed = judge_goals(goals(3.0 / mae, 0.5 / mae), run, run.metrics)
    assert (missed.score, missed.worst) == (pytest.approx(3.0), "hard")
    assert not missed.kept
    kept = judge_goals(goals(0.9 / mae, 1.5 / mae), run, run.metrics)
    assert (kept.score, kept.worst) == (pytest.approx(1.5), "soft")
    assert kept.kept
    assert not kept.met
    assert judge_goals(goals(0.9 / mae, 0.5 / mae), run, run.metrics).met
    alone = judge_goals({"hard": goals(0.7 / mae, 1.0)["hard"]}, run, run.metrics)
    assert (alone.score, alone.worst) == (pytest.approx(0.7), "hard")
    assert judge_goals({}, run, run.metrics).met


def test_a_run_that_left_its_bounds_meets_no_figure_and_no_span_beyond(run: LaneRun) -> None:
    q, e = run.q.copy(), run.e.copy()
    q[1500:] = e[1500:] = np.nan
    ended = replace(run, q=q, e=e, freeze=Freeze(time=1.5, joint=1, cause="for a test"))
    figure, late = FigureGoal(figure="mae", bound=1.0), ResponseGoal(bound=1.0, priority="hard")
    early = ResponseGoal(bound=1.0, end=1.0)
    verdict = judge_goals({"figure": figure, "late": late, "early": early}, ended, ended.metrics)
    assert verdict.ratios["figure"] is None
    assert verdict.ratios["late"] is None
    assert verdict.ratios["early"] is not None
    assert verdict.score is None
    assert not verdict.kept
    assert not verdict.met
    assert verdict.worst == "late"


def test_an_unknown_figure_is_no_goal_met() -> None:
    short = Experiment.from_document(
        {"lanes": {"A": {"law": "smc"}}, "simulation": {"horizon": 0.1}}
    )
    lane = simulate(short, estimate=False).lanes["A"]
    verdict = judge_goals(
        {"g": FigureGoal(figure="high_frequency_torque", bound=1.0)}, lane, lane.metrics
    )
    assert verdict.ratios == {"g": None}
    assert not verdict.met


def test_a_goal_says_what_it_asks_for_with_its_unit() -> None:
    whole = ResponseGoal(channel="tau", joint=1, bound=120.0)
    assert said(whole) == "|τ| of joint 1 ≤ 120 N·m"
    late = whole.model_copy(update={"start": 1.5})
    assert said(late) == "|τ| of joint 1 ≤ 120 N·m from 1.5 s on"
    assert said(late.model_copy(update={"end": 4.0})) == "|τ| of joint 1 ≤ 120 N·m, 1.5 to 4 s"
    assert said(FigureGoal(figure="flange_rms", bound=0.002)) == "flange RMS ≤ 0.002 m"
    assert unit_of(ResponseGoal(channel="de")) == "rad/s"
