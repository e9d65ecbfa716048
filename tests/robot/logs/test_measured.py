"""A log of a simulated run is that run again: the same error, torque and figures."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from slidetune.robot.arm.arm import flange_positions
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.logs.measured import measured_lane
from slidetune.robot.loop.simulate import LaneRun, Run, simulate
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError


@pytest.fixture(scope="module")
def run() -> Run:
    document = {
        "trajectory": {"kind": "quintic", "duration": 3.0},
        "lanes": {"A": {"law": "smc", "k1": 20.0}},
        "robot": {"inertials": "datasheet"},
        "simulation": {"horizon": 4.0, "initial_error": 0.05, "initial_velocity": "rest"},
    }
    return simulate(Experiment.from_document(document))


def log_of(run: Run, **changes: Any) -> Recording:
    lane = run.lanes["A"]
    whole = Recording("log.csv", run.time, lane.q, True, v=lane.v, tau=lane.tau)
    return replace(whole, **changes)


def alike(lane: LaneRun, found: Any, **tolerance: float) -> None:
    figures, others = lane.metrics, found.metrics
    for one in fields(figures):
        if one.name in ("reaching_time", "diverged_at"):
            continue
        np.testing.assert_allclose(
            getattr(others, one.name), getattr(figures, one.name), err_msg=one.name, **tolerance
        )


def test_a_log_has_the_figures_of_the_run_that_it_was(run: Run) -> None:
    found = measured_lane(log_of(run), pack(run.experiment), shift=0.0)
    lane = run.lanes["A"]
    for name in ("e", "de", "q", "v", "tau", "flange"):
        np.testing.assert_allclose(getattr(found, name), getattr(lane, name), atol=1e-12)
    alike(lane, found, rtol=1e-9)
    assert found.against == "experiment"
    assert not found.remarks


def test_its_own_desired_motion_counts_and_finds_the_shift(run: Run) -> None:
    later = run.time + 0.0
    log = log_of(run, time=later, q_d=run.q_d, v_d=run.v_d)
    found = measured_lane(log, pack(run.experiment))
    assert found.against == "log"
    assert found.shift.seconds == pytest.approx(0.0, abs=1e-7)
    alike(run.lanes["A"], found, rtol=1e-6)
    other = measured_lane(log, pack(run.experiment), against="experiment")
    assert other.against == "experiment"
    np.testing.assert_allclose(other.e, found.e, atol=1e-6)


def test_a_log_that_begins_later_is_shifted_back(run: Run) -> None:
    first = 700
    lane = run.lanes["A"]
    log = Recording(
        "log.csv",
        run.time[first:] - run.time[first],
        lane.q[first:],
        True,
        v=lane.v[first:],
        q_d=run.q_d[first:],
    )
    found = measured_lane(log, pack(run.experiment), against="experiment")
    assert found.shift.seconds == pytest.approx(run.time[first], abs=1e-6)
    np.testing.assert_allclose(found.e, lane.e[first:], atol=1e-6)
    found = measured_lane(replace(log, q_d=None), pack(run.experiment))
    assert any("follows late" in remark for remark in found.remarks)


def test_what_a_log_does_not_have_has_no_figure(run: Run) -> None:
    found = measured_lane(log_of(run, tau=None, v=None), pack(run.experiment), shift=0.0)
    figures = found.metrics.document()
    assert figures["chattering"] is None
    assert figures["peak_torque"] == [None] * 6
    assert figures["switches"] == [None] * 6
    assert figures["high_frequency_torque"] is None
    assert figures["flange_rms"] == pytest.approx(run.lanes["A"].metrics.flange_rms)
    np.testing.assert_allclose(found.v[1:-1], run.lanes["A"].v[1:-1], atol=0.05)
    assert any("differences of the angles" in remark for remark in found.remarks)


def test_figures_of_a_span_are_those_of_its_rows(run: Run) -> None:
    found = measured_lane(log_of(run), pack(run.experiment), shift=0.0)
    expected = run.lanes["A"].metrics_since(2.0)
    np.testing.assert_allclose(found.metrics_between(2.0).mae, expected.mae, rtol=1e-9)
    np.testing.assert_allclose(found.metrics_between(2.0).itae, expected.itae, rtol=1e-6)
    assert np.isnan(found.metrics_between(5.0).mae).all()


def test_jitter_of_stamps_makes_no_error(run: Run) -> None:
    random = np.random.default_rng(5)
    time = np.sort(run.time + random.uniform(-1e-4, 1e-4, len(run.time)))
    time[0] = 0.0
    packed = pack(run.experiment)
    from slidetune.robot.motion.along import desired_motion

    q_d, _ = desired_motion(packed.trajectory, time, 6)
    found = measured_lane(Recording("log.csv", time, q_d, True), packed, shift=0.0)
    assert np.abs(found.e).max() < 1e-12


def test_uneven_rows_are_made_even_and_told(run: Run) -> None:
    random = np.random.default_rng(6)
    rows = np.sort(random.choice(len(run.time), 2000, replace=False))
    rows[0], rows[-1] = 0, len(run.time) - 1
    log = log_of(run)
    thinned = replace(log, time=log.time[rows], q=log.q[rows], v=log.v[rows], tau=log.tau[rows])
    found = measured_lane(thinned, pack(run.experiment), shift=0.0)
    assert np.ptp(np.diff(found.time)) < 1e-9
    assert any("uneven rows" in remark for remark in found.remarks)
    np.testing.assert_allclose(found.metrics.mae, run.lanes["A"].metrics.mae, rtol=0.02)


def test_a_gap_is_no_part_of_the_figures(run: Run) -> None:
    lane = run.lanes["A"]
    kept = np.ones(len(run.time), dtype=bool)
    kept[500:2500] = False  # half of the run
    log = log_of(run, tau=lane.tau + 5.0 * np.sin(300.0 * run.time)[:, None])
    blocks = {name: getattr(log, name)[kept] for name in ("time", "q", "v", "tau")}
    found = measured_lane(replace(log, **blocks), pack(run.experiment), shift=0.0)
    assert any("figures leave them out, 50% of the time" in one for one in found.remarks)
    figures, rows = found.metrics, lane.e[kept]
    np.testing.assert_allclose(figures.mae, np.abs(rows).mean(axis=0), rtol=1e-9)
    np.testing.assert_allclose(figures.max_error, np.abs(rows).max(axis=0), rtol=1e-9)
    tau = blocks["tau"]
    np.testing.assert_allclose(figures.peak_torque, np.abs(tau).max(axis=0), rtol=1e-9)
    np.testing.assert_allclose(figures.rms_torque, np.sqrt((tau**2).mean(axis=0)), rtol=1e-9)
    flange_desired = flange_positions(run.q_d, pack(run.experiment).places)
    away = np.linalg.norm(lane.flange - flange_desired, axis=1)[kept]
    assert figures.flange_rms == pytest.approx(np.sqrt((away**2).mean()), rel=1e-9)
    assert figures.flange_max == pytest.approx(away.max(), rel=1e-9)
    way = sum(np.abs(np.diff(part, axis=0)).sum() for part in (tau[:500], tau[500:]))
    period = run.time[1]
    assert figures.chattering == pytest.approx(way / ((kept.sum() - 2) * period), rel=1e-9)
    timed = run.time[:, None] * np.abs(lane.e)
    parts = [
        np.trapezoid(timed[part], dx=period, axis=0) for part in (slice(500), slice(2500, None))
    ]
    np.testing.assert_allclose(figures.itae, sum(parts), rtol=1e-6)
    assert figures.high_frequency_torque is not None
    within = found.metrics_between(0.0, 0.4)
    np.testing.assert_allclose(within.mae, np.abs(lane.e[:401]).mean(axis=0), rtol=1e-9)
    assert np.isnan(found.metrics_between(1.0, 2.0).mae).all()


def test_whole_turns_between_log_and_motion_are_taken_out(run: Run) -> None:
    lane, turn = run.lanes["A"], 2.0 * np.pi
    apart = turn * np.array([1.0, 0.0, -2.0, 0.0, 0.0, 1.0])
    packed = pack(run.experiment)
    for log in (
        log_of(run, q=lane.q + apart),
        log_of(run, q=lane.q + apart, q_d=run.q_d + apart, v_d=run.v_d),
    ):
        for shift in (0.0, None):
            found = measured_lane(log, packed, shift=shift)
            assert found.shift.seconds == pytest.approx(0.0, abs=0.05)
            np.testing.assert_array_equal(found.shift.turns, [1.0, 0.0, -2.0, 0.0, 0.0, 1.0])
            if shift is not None or log.q_d is not None:
                np.testing.assert_allclose(found.e, lane.e, atol=1e-6)
                np.testing.assert_allclose(found.q, lane.q, atol=1e-12)
            said = [one for one in found.remarks if "same turn" in one]
            assert len(said) == 3
            assert "the angle of joint_3 is 2 turns below the experiment's" in said[1]


def test_a_log_without_measured_angles_is_no_lane(run: Run) -> None:
    with pytest.raises(RecordingError, match="no measured angles"):
        measured_lane(log_of(run, measured=False), pack(run.experiment))
    with pytest.raises(RecordingError, match="no desired angles of its own"):
        measured_lane(log_of(run), pack(run.experiment), against="log")
