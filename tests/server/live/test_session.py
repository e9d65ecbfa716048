"""The live session, on its real thread."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.workspace import PUSH, R_Q, R_TAU, Q
from slidetune.robot.loop.simulate import simulate
from slidetune.server.live.pacing import LONGEST, TICK, Pacer
from slidetune.server.live.session import Session
from slidetune.server.live.telemetry import HEADER

LANES = {"A": {"law": "rbfnn_nftsm"}, "B": {"law": "nftsm"}}
UNSTABLE = {"A": {"law": "rbfnn_nftsm"}, "B": {"law": "computed_torque"}}


def experiment(**changes: Any) -> Experiment:
    return Experiment.from_document({"lanes": LANES, **changes})


def until(condition: Callable[[], bool], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.005)


@pytest.fixture
def session() -> Iterator[Session]:
    session = Session(pack(experiment()))
    session.start()
    yield session
    session.stop()


def settle(session: Session) -> None:
    """Wait until everything asked so far has been done."""
    done = threading.Event()
    session.ask(done.set)
    assert done.wait(20.0)


def test_time_goes_on_by_itself(session: Session) -> None:
    until(lambda: session.state()["time"] > 0.3)


def test_pause_holds_time_and_play_goes_on(session: Session) -> None:
    session.pause()
    settle(session)
    held = session.state()["time"]
    time.sleep(0.1)
    assert session.state()["time"] == held
    session.play()
    until(lambda: session.state()["time"] > held)


def test_step_makes_exactly_as_many_steps(session: Session) -> None:
    session.pause()
    session.reset()
    session.step(7)
    settle(session)
    assert session.loop.number == 7
    assert session.state()["time"] == pytest.approx(0.007)


def test_live_rows_are_those_of_simulate(session: Session) -> None:
    session.pause()
    session.reset()
    session.step(200)
    settle(session)
    run = simulate(experiment(simulation={"horizon": 0.2}))
    for name, lane in session.loop.lanes.items():
        np.testing.assert_allclose(lane.record[:200, R_Q], run.lanes[name].q[:200], atol=1e-12)
        np.testing.assert_allclose(lane.record[:200, R_TAU], run.lanes[name].tau[:200], atol=1e-9)


def test_an_edit_keeps_time_and_state(session: Session) -> None:
    session.pause()
    session.step(50)
    settle(session)
    before, time_before = session.angles(), session.state()["time"]
    changed = experiment().patched({"lanes": {"B": {"nu": 30}}})
    session.adopt(pack(changed), 2)
    settle(session)
    assert session.revision == 2
    assert session.angles() == before
    assert session.state()["time"] == time_before


def test_rows_carry_the_revision_that_made_them(session: Session) -> None:
    session.pause()
    session.reset()
    session.step(10)
    session.adopt(pack(experiment().patched({"lanes": {"B": {"nu": 30}}})), 2)
    session.step(10)
    settle(session)
    first = session.telemetry.written - 20
    old = session.telemetry.frame(first)
    assert old is not None
    assert HEADER.unpack_from(old[0])[:2] == (1, 10)
    new = session.telemetry.frame(old[1])
    assert new is not None
    assert HEADER.unpack_from(new[0])[:2] == (2, 10)


def test_of_many_edits_in_a_hurry_the_last_counts(session: Session) -> None:
    for index in range(200):
        patch = {"lanes": {"B": {"nu": 1.0 + index / 100.0}}}
        session.adopt(pack(experiment().patched(patch)), index + 2)
    settle(session)
    assert session.revision == 201
    assert session.loop.packed.experiment.lanes["B"].nu == pytest.approx(2.99)


def test_a_diverging_lane_freezes_with_its_cause_and_the_other_goes_on() -> None:
    document = {
        "lanes": UNSTABLE,
        "robot": {"armature": 0.5},
        "simulation": {"mode": "sampled", "plant_substeps": 2},
    }
    start = Experiment.from_document(document)
    wild = start.patched({"lanes": {"A": {"k1": 1000, "c": 50}}})
    session = Session(pack(wild))
    changes: list[int] = []
    session.on_change = lambda: changes.append(1)
    session.start()
    try:
        until(lambda: session.state()["lanes"]["A"]["status"] == "frozen")
        status = session.state()["lanes"]["A"]
        assert "γ" in status["cause"]
        assert 1 <= status["joint"] <= 6
        assert status["gamma"] > 2.0
        held = session.angles()["A"]
        now = session.state()["time"]
        until(lambda: session.state()["time"] > now + 0.05)
        assert session.state()["lanes"]["B"]["status"] == "running"
        assert session.angles()["A"] == held
        assert np.isfinite(held).all()
        assert changes
        session.adopt(pack(start.patched({"lanes": {"A": {"law": "computed_torque"}}})), 2)
        session.reset()
        until(lambda: session.state()["lanes"]["A"]["status"] == "running")
    finally:
        session.stop()


def test_a_kick_pushes_all_lanes_and_passes(session: Session) -> None:
    session.pause()
    session.reset()
    session.step(1)
    session.kick((50.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.02)
    session.step(10)
    settle(session)
    calm = simulate(experiment(simulation={"horizon": 0.1}))
    for name, lane in session.loop.lanes.items():
        assert lane.work[Q, 0] > calm.lanes[name].q[11, 0]
    session.step(30)
    session.step(1)
    settle(session)
    assert not any(lane.work[PUSH].any() for lane in session.loop.lanes.values())


@pytest.mark.parametrize(("delay", "forked"), [(0.0, 0.1), (0.002, 0.2)])
def test_a_branch_repeats_the_past_and_knows_nothing_of_a_later_kick(
    session: Session, delay: float, forked: float
) -> None:
    calm = Experiment.from_document(
        {
            "lanes": LANES,
            "robot": {"armature": 5.0},
            "disturbance": {"sensor_noise": {"velocity": 1e-3}},
            "simulation": {"mode": "sampled", "input_delay": delay, "horizon": 3.0},
        }
    )
    session.pause()
    session.load(pack(calm), 2)
    session.step(300)
    session.kick((50.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.05)
    session.step(100)
    settle(session)
    gains = calm.lanes["A"].model_dump()
    session.fork(pack(calm.patched({"lanes": {"Copy": gains}})), 3, forked, {"Copy": "A"})
    session.pause()
    session.step(150)
    settle(session)
    rows, run = session.loop.number, simulate(calm, estimate=False)
    begin = round(forked * 1000)
    assert rows >= begin + 150
    for name, origin in (("A", "A"), ("B", "B"), ("Copy", "A")):
        record = session.loop.lanes[name].record[begin:rows]
        lane = run.lanes[origin]
        np.testing.assert_allclose(record[:, R_Q], lane.q[begin:rows], atol=1e-12)
        np.testing.assert_allclose(record[:, R_TAU], lane.tau[begin:rows], atol=1e-8)


def test_a_branch_from_within_a_kick_feels_the_rest_of_it(session: Session) -> None:
    session.pause()
    session.reset()
    session.step(190)
    session.kick((50.0, 0.0, 0.0, 0.0, 0.0, 0.0), 3.0)
    session.step(300)
    settle(session)
    gains = experiment().lanes["A"].model_dump()
    both = experiment().patched({"lanes": {"Copy": gains}})
    session.fork(pack(both), 2, 0.2, {"Copy": "A"})
    session.pause()
    session.step(1)
    settle(session)
    assert all(lane.work[PUSH, 0] == 50.0 for lane in session.loop.lanes.values())


def test_a_duplicated_lane_continues_from_its_origin(session: Session) -> None:
    session.pause()
    session.step(100)
    settle(session)
    gains = experiment().lanes["A"].model_dump()
    both = experiment().patched({"lanes": {"C": gains}})
    session.adopt(pack(both), 2, {"C": "A"})
    settle(session)
    assert session.angles()["C"] == session.angles()["A"]
    session.step(100)
    settle(session)
    assert session.angles()["C"] == session.angles()["A"]
    assert list(session.figures.lanes) == ["A", "B", "C"]


def test_a_suspended_session_says_so_and_makes_no_burst() -> None:
    skipped = 0.0
    session = Session(pack(experiment()), pacer=Pacer(lambda: time.perf_counter() + skipped))
    told: list[str] = []
    session.on_notice = told.append
    session.start()
    try:
        until(lambda: session.state()["time"] > 0.1)
        begin, before = time.perf_counter(), session.state()["time"]
        skipped = 30.0
        until(lambda: bool(told))
        until(lambda: session.state()["time"] > before + LONGEST)
        went = session.state()["time"] - before
        assert went < time.perf_counter() - begin + LONGEST + TICK
    finally:
        session.stop()
    assert len(told) == 1
    assert "30 s" in told[0]


def test_stop_leaves_no_thread() -> None:
    before = threading.active_count()
    session = Session(pack(experiment()))
    session.start()
    session.stop()
    assert threading.active_count() == before


def test_a_broken_request_pauses_and_does_not_end_the_session(session: Session) -> None:
    def stumble() -> None:
        raise RuntimeError("stumbled on purpose")

    session.ask(stumble)
    until(lambda: not session.playing)
    session.play()
    now = session.state()["time"]
    until(lambda: session.state()["time"] > now)


def test_metrics_are_those_of_simulate(session: Session) -> None:
    session.pause()
    session.reset()
    session.step(1001)
    settle(session)
    run = simulate(experiment(simulation={"horizon": 1.0}))
    for name, running in session.figures.lanes.items():
        total = running.document()["total"]
        wanted = run.lanes[name].metrics
        assert np.allclose(total["mae"], wanted.mae, rtol=1e-9)
        assert np.allclose(total["max_error"], wanted.max_error, rtol=1e-9)
        assert total["flange_rms"] == pytest.approx(wanted.flange_rms, rel=1e-9)
        assert np.allclose(total["peak_torque"], wanted.peak_torque)
        assert total["chattering"] == pytest.approx(wanted.chattering, rel=1e-9)


def test_what_stands_still_after_a_freeze_is_in_no_figure(session: Session) -> None:
    sampled = {"mode": "sampled", "horizon": 0.5}
    unstable = Experiment.from_document({"lanes": UNSTABLE, "simulation": sampled})
    session.pause()
    session.adopt(pack(unstable), 2)
    session.reset()
    settle(session)
    # In one go: the lane's last rows and those after them come together.
    session.step(501)
    settle(session)
    for name, lane in simulate(unstable).lanes.items():
        total = session.figures.lanes[name].document()["total"]
        assert total["mae"] == pytest.approx(lane.metrics.mae.tolist(), rel=1e-9)
        assert total["chattering"] == pytest.approx(lane.metrics.chattering, rel=1e-9)
    freeze = session.loop.lanes["A"].freeze
    assert freeze is not None
    assert freeze.time < 0.4
