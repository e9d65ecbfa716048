"""Runs against solutions of high accuracy that share no code with them: shipped and drawn ones."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.accuracy import GOOD
from slidetune.robot.loop.simulate import LaneRun, Run, simulate
from tests.reference.data import TIME, Case, read

DETERMINED = 1e-5
"""Difference in [rad] of two solutions of the reference up to which it tells the truth."""
UNTOLD = 1e-4
"""Error in [rad] that need not be told."""

SOLUTIONS = Path(__file__).parents[2] / "data"
LANES = {"RBFNN-NFTSM": "rbfnn-nftsm", "RBFNN-SMC": "rbfnn-smc", "NFTSM": "nftsm"}


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


def reference(lane: str) -> dict[str, np.ndarray]:
    table = np.loadtxt(SOLUTIONS / f"{LANES[lane]}.csv", delimiter=",", skiprows=1)
    groups = np.split(table[:, 1:], 4, axis=1)
    return {"time": table[:, 0], **dict(zip(("q", "v", "tau", "S"), groups, strict=True))}


def difference(run: Run, lane: str, column: str, skip: int = 0) -> float:
    truth = reference(lane)
    rows = np.searchsorted(run.time, truth["time"] - 1e-9)
    rows = rows[rows < len(run.time)]
    np.testing.assert_allclose(run.time[rows], truth["time"][: len(rows)], atol=1e-9)
    found = getattr(run.lanes[lane], column)[rows]
    return float(np.abs(found - truth[column][: len(rows)])[skip:].max())


@pytest.mark.parametrize("lane", LANES)
def test_angles_agree_with_the_reference_at_one_millisecond(undisturbed: Run, lane: str) -> None:
    assert len(reference(lane)["time"]) == 501
    assert difference(undisturbed, lane, "q") <= 5e-5


@pytest.mark.parametrize("lane", LANES)
def test_velocities_agree_with_the_reference(undisturbed: Run, lane: str) -> None:
    assert difference(undisturbed, lane, "v") <= 5e-4


@pytest.mark.parametrize("lane", LANES)
def test_torque_and_sliding_variable_agree_once_the_start_is_over(
    undisturbed: Run, lane: str
) -> None:
    # At rest against 1 rad/s, the torque of the wrists falls by 1700 N m within a microsecond.
    assert difference(undisturbed, lane, "tau", skip=10) <= 0.05
    assert difference(undisturbed, lane, "S", skip=10) <= 5e-4


@pytest.mark.parametrize("lane", LANES)
def test_first_row_is_evaluated_before_any_step(undisturbed: Run, lane: str) -> None:
    truth, found = reference(lane), undisturbed.lanes[lane]
    np.testing.assert_allclose(found.tau[0], truth["tau"][0], atol=1e-5)
    np.testing.assert_allclose(found.S[0], truth["S"][0], atol=1e-9)


def test_extrapolation_is_worth_its_price() -> None:
    document = {
        "lanes": {"RBFNN-NFTSM": {"law": "rbfnn_nftsm"}},
        "simulation": {"initial_velocity": "rest", "horizon": 2.0},
    }
    fine = Experiment.from_document(document)
    plain = simulate(fine.patched({"simulation": {"scheme": "plain"}}))
    extrapolated = simulate(fine)
    ratio = difference(plain, "RBFNN-NFTSM", "q") / difference(extrapolated, "RBFNN-NFTSM", "q")
    assert ratio > 30.0
