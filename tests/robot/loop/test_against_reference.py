"""Runs of 260 drawn experiments against a reference that shares no code with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.accuracy import GOOD
from slidetune.robot.loop.simulate import LaneRun, simulate
from tests.reference.data import TIME, Case, read

DETERMINED = 1e-5
"""Difference in [rad] of two solutions of the reference up to which it tells the truth."""
UNTOLD = 1e-4
"""Error in [rad] that need not be told."""


class Judged(NamedTuple):
    """A case, its run, and the true error of that in [rad]."""

    case: Case
    lane: LaneRun
    error: float

    def __str__(self) -> str:
        (gains,) = self.case.document["lanes"].values()
        names = {key: gains.get(key) for key in ("law", "switching", "reaching")}
        said = self.lane.accuracy
        return f"{self.case.origin} {self.case.seed} {names}: {self.error:.1e} rad, says {said}"


def judged(case: Case) -> Judged:
    """Run a case as a user does."""
    experiment = Experiment.from_document(case.document)
    (lane,) = simulate(experiment).lanes.values()
    stride = round((TIME[1] - TIME[0]) / experiment.simulation.step)
    # Up to where the truth itself leaves its bounds.
    until = case.end - TIME[1] if case.end < TIME[-1] else TIME[-1]
    rows = until + 1e-9 >= TIME
    apart = np.abs(lane.q[::stride][rows] - case.q[rows])
    error = float(np.where(np.isfinite(apart), apart, np.inf).max()) if rows.any() else 0.0
    return Judged(case, lane, error)


@pytest.fixture(scope="module")
def runs() -> list[Judged]:
    """Return all cases of which the reference is sure, run."""
    return [judged(case) for case in read() if case.agreement < DETERMINED]


def untold(run: Judged) -> bool:
    return run.error > max(UNTOLD, 3.0 * (run.lane.accuracy.error_estimate or 0.0))


def test_no_error_is_greater_than_three_times_what_is_said(runs: list[Judged]) -> None:
    assert not [str(run) for run in runs if untold(run)]


def test_at_the_default_step_nearly_all_errors_are_below_a_milliradian(runs: list[Judged]) -> None:
    errors = np.array([run.error for run in runs])
    assert (errors <= 1e-3).mean() >= 0.95


def test_of_what_a_hand_would_do_most_is_right_to_a_tenth_of_that(runs: list[Judged]) -> None:
    errors = np.array([run.error for run in runs if run.case.origin == "hand"])
    assert len(errors) > 90
    assert (errors <= 1e-4).mean() >= 0.9
    assert errors.max() <= 1e-3


def test_an_estimate_is_no_blank_cheque(runs: list[Judged]) -> None:
    estimates = np.array([run.lane.accuracy.error_estimate for run in runs])
    errors = np.array([run.error for run in runs])
    small = errors <= UNTOLD
    # What is good says so, and is not hidden behind a large number.
    assert (estimates[small] <= GOOD).mean() >= 0.97
    assert np.median(estimates / np.maximum(errors, 1e-7)) < 10.0


def test_whatever_is_not_good_says_so_in_words(runs: list[Judged]) -> None:
    for run in runs:
        accuracy = run.lane.accuracy
        if run.error > 3.0 * GOOD or accuracy.unconverged:
            assert accuracy.remark, str(run)


def test_a_lane_freezes_where_the_truth_leaves_its_bounds_and_nowhere_else(
    runs: list[Judged],
) -> None:
    for run in runs:
        if run.lane.accuracy.error_estimate > 0.1:
            continue
        ended = run.case.end < TIME[-1]
        assert (run.lane.freeze is not None) == ended, str(run)
        if run.lane.freeze is not None:
            assert run.lane.freeze.time == pytest.approx(run.case.end, abs=0.02)
