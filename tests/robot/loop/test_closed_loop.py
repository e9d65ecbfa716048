"""The lanes in lockstep: edits, new lanes, freezes, and the same rows as a whole run."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.integrator.law_call import Control
from slidetune.robot.kernels.workspace import PUSH, R_Q, R_QD, R_V, R_VD, RECORD, STATE_ROWS, Q, V
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.simulate import simulate

Array = np.ndarray
THREE: dict[str, Any] = {
    "lanes": {
        "RBFNN-NFTSM": {"law": "rbfnn_nftsm"},
        "SMC": {"law": "smc"},
        "PD": {"law": "computed_torque"},
    },
    "simulation": {"horizon": 0.2},
}
HARD: dict[str, Any] = {
    "robot": {
        "inertials": "datasheet",
        "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15],
        "viscous_friction": 2.0,
        "coulomb_friction": 1.0,
        "torque_limit": 100.0,
        "payload": {"mass": 1.5},
    },
    "lanes": {
        "A": {"law": "rbfnn_nftsm", "nu": 10, "c": 1, "k1": 8, "k2": 5, "epsilon": 0.1},
        "B": {"law": "nftsm", "nu": 10, "c": 1, "k1": 8, "k2": 5, "switching": "sign"},
        "C": {"law": "computed_torque"},
    },
    "disturbance": {
        "constant": 1.0,
        "noise": {"amplitude": 1.0},
        "nominal_mismatch": 0.9,
        "sensor_noise": {"position": 1e-5, "velocity": 1e-3},
    },
    "simulation": {"mode": "sampled", "input_delay": 0.0014, "horizon": 0.2},
}
FALLING = {"law": "rbfnn_smc", "k1": 0, "k2": 0, "learning_rate": 0}


def experiment_of(document: dict[str, Any]) -> Experiment:
    return Experiment.from_document(document)


def loop_of(document: dict[str, Any], steps: int = 0, rows: int = 512) -> ClosedLoop:
    loop = ClosedLoop(pack(experiment_of(document)), rows)
    advance(loop, steps)
    return loop


def advance(loop: ClosedLoop, steps: int) -> None:
    for _ in range(steps):
        loop.step()


def state(loop: ClosedLoop, name: str) -> Array:
    return loop.lanes[name].work[:STATE_ROWS].copy()


@pytest.mark.parametrize("document", [THREE, HARD], ids=["continuous", "sampled"])
def test_the_live_loop_and_a_whole_run_give_the_same_rows(document: dict[str, Any]) -> None:
    run = simulate(experiment_of(document))
    loop = loop_of(document, len(run.time))
    for name, lane in run.lanes.items():
        record = loop.lanes[name].record[: len(run.time)]
        for index, column in enumerate(RECORD[:6]):
            found = record[:, index]
            expected, scale = getattr(lane, column), max(1.0, np.abs(getattr(lane, column)).max())
            # One takes M and h from Pinocchio, the other from the compiled recursion.
            np.testing.assert_allclose(found, expected, atol=1e-12 * scale, err_msg=column)
        np.testing.assert_array_equal(record[:, R_QD], run.q_d)
        np.testing.assert_array_equal(record[:, R_VD], run.v_d)


@pytest.mark.parametrize("document", [THREE, HARD], ids=["continuous", "sampled"])
def test_restart_repeats_to_the_last_bit(document: dict[str, Any]) -> None:
    loop = loop_of(document, 100)
    before = {name: lane.record.copy() for name, lane in loop.lanes.items()}
    loop.lanes["C" if "C" in loop.lanes else "PD"].work[PUSH] = 5.0
    advance(loop, 37)
    loop.restart()
    assert (loop.time, loop.number) == (0.0, 0)
    advance(loop, 100)
    for name, lane in loop.lanes.items():
        np.testing.assert_array_equal(lane.record[:100], before[name][:100])


def test_lanes_do_not_see_each_other() -> None:
    together = loop_of(HARD, 100)
    for name in HARD["lanes"]:
        alone = loop_of({**HARD, "lanes": {name: HARD["lanes"][name]}}, 100)
        np.testing.assert_array_equal(alone.lanes[name].record, together.lanes[name].record)


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_rows_go_round_a_short_record(mode: str) -> None:
    document = {
        "lanes": {law: {"law": law} for law in list(LAWS)[-6:]},
        "robot": {"armature": 5.0},
        "simulation": {"mode": mode, "control_rate": 10_000.0},
    }
    long, short = loop_of(document, 100), loop_of(document, 100, rows=16)
    rows = [number % 16 for number in range(84, 100)]
    for name, lane in short.lanes.items():
        np.testing.assert_array_equal(lane.record[rows], long.lanes[name].record[84:100])


def test_a_lane_freezes_alike_once_its_rows_have_gone_round() -> None:
    document = {"lanes": {"A": FALLING}, "disturbance": {"constant": [0, 0, 0, 0, 0, -2]}}
    long, short = (loop_of(document, 300, rows).lanes["A"] for rows in (512, 16))
    assert long.freeze is not None
    assert 0.016 < long.freeze.time < 0.284
    assert long.freeze == short.freeze
    rows = [number % 16 for number in range(284, 300)]
    np.testing.assert_array_equal(short.record[rows], long.record[284:300])


def test_an_edit_keeps_time_and_states() -> None:
    loop = loop_of(THREE, 40)
    states, time = {name: state(loop, name) for name in loop.lanes}, loop.time
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": {"RBFNN-NFTSM": {"nu": 30}}})))
    assert (loop.time, loop.number) == (time, 40)
    for name, before in states.items():
        np.testing.assert_array_equal(state(loop, name), before)
    advance(loop, 40)
    untouched = loop_of(THREE, 80)
    assert (state(loop, "RBFNN-NFTSM") != state(untouched, "RBFNN-NFTSM")).any()
    np.testing.assert_array_equal(state(loop, "SMC"), state(untouched, "SMC"))


def test_time_goes_on_at_another_rate_after_an_edit() -> None:
    loop = loop_of(THREE, 40)
    loop.adopt(pack(loop.packed.experiment.patched({"simulation": {"step": 0.002}})))
    advance(loop, 10)
    assert loop.time == pytest.approx(0.04 + 0.02, abs=1e-15)
    sampled = {"simulation": {"mode": "sampled", "control_rate": 250}}
    loop.adopt(pack(loop.packed.experiment.patched(sampled)))
    advance(loop, 10)
    assert loop.time == pytest.approx(0.06 + 0.04, abs=1e-15)


def test_time_does_not_drift_over_many_steps() -> None:
    loop = loop_of({"lanes": {"A": FALLING}, "robot": {"armature": 5.0}})
    for lane in loop.lanes.values():
        lane.step = lambda t, number, row: 0  # the clock alone
    advance(loop, 1_000_000)
    assert loop.time == pytest.approx(1000.0, abs=1e-9)


def test_a_new_lane_continues_from_its_origin() -> None:
    loop = loop_of(THREE, 40)
    loop.lanes["SMC"].work[PUSH] = 3.0
    lanes = {"copy": {"law": "smc"}, "other": {"law": "nftsm"}}
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": lanes})), {"copy": "SMC"})
    np.testing.assert_array_equal(state(loop, "copy"), state(loop, "SMC"))
    np.testing.assert_array_equal(loop.lanes["copy"].work[PUSH], 3.0)
    # Without an origin: the first lane's.
    np.testing.assert_array_equal(state(loop, "other"), state(loop, "RBFNN-NFTSM"))
    assert list(loop.lanes) == [*THREE["lanes"], "copy", "other"]
    advance(loop, 20)
    np.testing.assert_array_equal(state(loop, "copy"), state(loop, "SMC"))


def test_a_renamed_lane_goes_on() -> None:
    loop, untouched = loop_of(HARD, 40), loop_of(HARD, 90)
    lane = loop.packed.experiment.document()["lanes"]["B"]
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": {"B": None, "new": lane}})))
    assert list(loop.lanes) == ["A", "new", "C"]
    advance(loop, 50)
    # The delayed torques were carried over too, so that nothing shows of the change.
    np.testing.assert_array_equal(state(loop, "new"), state(untouched, "B"))


def test_a_removed_lane_is_gone_and_the_others_stay() -> None:
    loop = loop_of(THREE, 10)
    before = state(loop, "PD")
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": {"SMC": None}})))
    assert list(loop.lanes) == ["RBFNN-NFTSM", "PD"]
    np.testing.assert_array_equal(state(loop, "PD"), before)


def test_a_lane_may_change_its_law_in_flight() -> None:
    loop = loop_of(THREE, 40)
    before = state(loop, "RBFNN-NFTSM")
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": {"RBFNN-NFTSM": {"law": "smc"}}})))
    np.testing.assert_array_equal(state(loop, "RBFNN-NFTSM"), before)
    advance(loop, 100)
    assert np.isfinite(state(loop, "RBFNN-NFTSM")).all()
    assert loop.lanes["RBFNN-NFTSM"].freeze is None


def test_a_lane_that_leaves_its_bounds_freezes_and_the_others_go_on() -> None:
    document = {
        "lanes": {"falls": FALLING, "holds": {"law": "rbfnn_nftsm"}},
        "disturbance": {"constant": [0, 0, 0, 0, 0, -50]},
    }
    loop = loop_of(document, 300)
    freeze = loop.lanes["falls"].freeze
    assert freeze is not None
    assert (freeze.joint, freeze.gamma) == (6, None)
    assert 0.0 < freeze.time < 0.3
    row = round(freeze.time / loop.period)
    record = loop.lanes["falls"].record
    assert np.isfinite(record[:300]).all()
    own = record[row:300, :R_QD]
    np.testing.assert_array_equal(own, np.broadcast_to(own[0], own.shape))
    assert loop.lanes["holds"].freeze is None
    alone = loop_of({**document, "lanes": {"holds": {"law": "rbfnn_nftsm"}}}, 300)
    np.testing.assert_array_equal(alone.lanes["holds"].record, loop.lanes["holds"].record)


def test_a_frozen_lane_stays_frozen_under_other_gains_until_a_restart() -> None:
    document = {"lanes": {"A": FALLING}, "disturbance": {"constant": -50}}
    loop = loop_of(document, 300)
    assert loop.lanes["A"].freeze is not None
    loop.adopt(pack(loop.packed.experiment.patched({"disturbance": {"constant": 0}})))
    advance(loop, 5)
    assert loop.lanes["A"].freeze is not None
    loop.restart()
    advance(loop, 5)
    assert loop.lanes["A"].freeze is None


def test_a_new_lane_that_continues_a_frozen_one_stands_where_it_stood() -> None:
    document = {"lanes": {"A": FALLING}, "disturbance": {"constant": -50}}
    loop = loop_of(document, 300)
    lanes = {"copy": {"law": "smc"}}
    loop.adopt(pack(loop.packed.experiment.patched({"lanes": lanes})), {"copy": "A"})
    row = loop.step()
    one, other = (loop.lanes[name] for name in ("A", "copy"))
    assert other.freeze == one.freeze
    assert one.record[row, R_Q].any()
    np.testing.assert_array_equal(other.record[row], one.record[row])


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
@pytest.mark.parametrize("law", ["rbfnn_nftsm", "smc", "computed_torque"])
def test_a_push_moves_the_arm_where_it_pushes(mode: str, law: str) -> None:
    gains = {} if law == "computed_torque" else {"k1": 5.0, "k2": 1.0}
    document = {
        "lanes": {"A": {"law": law, **gains}},
        "trajectory": {"kind": "hold"},
        "robot": {"armature": 0.5},
        "simulation": {"mode": mode},
    }
    left, pushed = loop_of(document, 20), loop_of(document, 20)
    push = np.array([20.0, 0.0, 0.0, 0.0, -10.0, 0.0])
    pushed.lanes["A"].work[PUSH] = push
    for loop in (left, pushed):
        advance(loop, 5)
    moved = pushed.lanes["A"].work[V] - left.lanes["A"].work[V]
    assert moved[0] > 1e-3
    assert moved[4] < -1e-3
    pushed.lanes["A"].work[PUSH] = 0.0
    advance(pushed, 1500)
    assert np.abs(pushed.lanes["A"].work[V]).max() < 0.2
    assert np.abs(pushed.lanes["A"].work[Q] - pushed.packed.trajectory[2:8]).max() < 0.5


def raising_after(calls: int, control: Control) -> Control:
    """Return a law that does its work so many times and raises from then on."""
    left = iter(range(calls))

    def failing(*given: Any) -> None:
        control(*given)
        if next(left, None) is None:
            raise ArithmeticError("no torque for this pose")

    return failing


@pytest.mark.parametrize("calls", [0, 1, 100, 101])
@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_a_law_that_raises_freezes_its_lane_and_the_others_go_on(
    mode: str, calls: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    gains = {"k1": 1.0, "k2": 0.1}
    lanes = {"fails": {"law": "smc", **gains}, "holds": {"law": "computed_torque"}}
    document = {"lanes": lanes, "simulation": {"mode": mode}, "robot": {"armature": 1.0}}
    law = LAWS["smc"]
    monkeypatch.setitem(LAWS, "smc", replace(law, control=raising_after(calls, law.control)))
    loop = loop_of(document, 150)
    freeze = loop.lanes["fails"].freeze
    assert freeze is not None
    assert (freeze.joint, freeze.gamma) == (None, None)
    assert "no torque for this pose" in freeze.cause
    assert np.isfinite(loop.lanes["fails"].record[:150]).all()
    assert loop.lanes["holds"].freeze is None
    alone = loop_of({**document, "lanes": {"holds": lanes["holds"]}}, 150)
    np.testing.assert_array_equal(alone.lanes["holds"].record, loop.lanes["holds"].record)


def test_a_law_that_raises_ends_its_lane_of_a_whole_run_and_no_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    law = LAWS["smc"]
    monkeypatch.setitem(LAWS, "smc", replace(law, control=raising_after(20, law.control)))
    lanes = {"fails": {"law": "smc"}, "holds": {"law": "computed_torque"}}
    run = simulate(experiment_of({**THREE, "lanes": lanes}))
    failed, freeze = run.lanes["fails"], run.lanes["fails"].freeze
    assert freeze is not None
    assert "no torque for this pose" in freeze.cause
    ended = run.time > freeze.time
    assert np.isfinite(failed.tau[~ended]).all()
    assert np.isnan(failed.tau[ended]).all()
    assert np.isfinite(failed.metrics.mae).all()
    assert run.lanes["holds"].freeze is None


@pytest.mark.parametrize("steps", [0, 1, 100])
@pytest.mark.parametrize("mode", ["continuous", "sampled"])
@pytest.mark.parametrize("law", ["rbfnn_nftsm", "smc", "computed_torque"])
def test_a_law_that_gives_no_number_freezes_its_lane_and_records_numbers_only(
    law: str, mode: str, steps: int
) -> None:
    gains = {} if law == "computed_torque" else {"k1": 1.0, "k2": 0.1}
    lanes = {"fails": {"law": law, **gains}, "holds": {"law": "computed_torque"}}
    document = {"lanes": lanes, "simulation": {"mode": mode}, "robot": {"armature": 1.0}}
    loop = loop_of(document, steps)
    lane = loop.lanes["fails"]
    before = lane.work[: V + 1].copy()
    loop.packed.gains["fails"][:, 3] = np.nan
    advance(loop, 20)
    assert lane.freeze is not None
    assert lane.freeze.joint in (1, 4)  # a law with a model couples the joints
    assert "not a number" in lane.freeze.cause
    assert np.isfinite(lane.record).all()
    assert np.isfinite(lane.work[:STATE_ROWS]).all()
    np.testing.assert_array_equal(lane.record[steps + 19, : R_V + 1], before)
    assert loop.lanes["holds"].freeze is None


def test_an_edit_is_seen_whole_or_not_at_all() -> None:
    lanes = {name: {"law": "smc"} for name in "ABCDEF"}
    packed = pack(Experiment.from_document({"lanes": lanes}))
    loop = ClosedLoop(packed, rows=10)
    seen: set[int] = set()
    done = threading.Event()

    def look() -> None:
        while not done.is_set():
            seen.add(len(loop.lanes))

    watcher = threading.Thread(target=look)
    watcher.start()
    for _ in range(300):
        loop.adopt(packed)
    done.set()
    watcher.join()
    assert seen == {len(lanes)}


def test_an_edit_that_fails_loses_no_lane() -> None:
    lanes = {name: {"law": "smc"} for name in "ABC"}
    loop = ClosedLoop(pack(Experiment.from_document({"lanes": lanes})), rows=10)
    more = pack(Experiment.from_document({"lanes": {**lanes, "D": {"law": "nftsm"}}}))
    del more.gains["D"]
    with pytest.raises(KeyError):
        loop.adopt(more)
    assert list(loop.lanes) == list("ABC")
