"""One lane: where it starts, what it keeps, why it stops."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.arm.dynamics import dynamics
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.cutting import HALVINGS
from slidetune.robot.kernels.workspace import (
    AD,
    CHANGE_Q,
    CURVE,
    CURVE_ROWS,
    DRIFT,
    FULL,
    MEASURED_Q,
    MEASURED_V,
    PERIOD,
    PUSH,
    QD,
    R_Q,
    R_QD,
    R_S,
    R_TAU,
    R_V,
    RECORD,
    STATE_ROWS,
    TAU,
    VD,
    Q,
    V,
    W,
)
from slidetune.robot.laws import LAWS
from slidetune.robot.loop import steps
from slidetune.robot.loop.lane import Lane

Array = np.ndarray
# The published gains at 1 kHz on the vendor's arm: a margin of 2675.
DIVERGENT = {"simulation": {"mode": "sampled"}}
MODES: dict[str, dict[str, Any]] = {
    "extrapolated": {"mode": "continuous", "scheme": "extrapolated"},
    "plain": {"mode": "continuous", "scheme": "plain"},
    "sampled": {"mode": "sampled", "input_delay": 0.0014},
}
IDLE = {"law": "rbfnn_smc", "k1": 0.0, "k2": 0.0, "learning_rate": 0.0}
# Nobody holds the wrist of a gram against 50 N m.
PUSHED = {"lanes": {"A": IDLE}, "disturbance": {"constant": [0, 0, 0, 0, 0, -50]}}


def packed_of(document: dict[str, Any], law: str = "rbfnn_nftsm") -> Packed:
    return pack(Experiment.from_document({"lanes": {"A": {"law": law}}, **document}))


def lane_of(packed: Packed, rows: int = 400) -> Lane:
    return Lane("A", packed, np.zeros((rows, len(RECORD), JOINTS)))


def stepped(lane: Lane, packed: Packed, steps: int, first: int = 0) -> int:
    """Step until the lane stops; return how many steps it made."""
    period = packed.experiment.simulation.row_period
    for number in range(first, first + steps):
        joint = lane.step(number * period, number, number)
        if joint:
            lane.stop(packed, number * period, joint, number)
            return number
    return first + steps


@pytest.mark.parametrize("law", ["rbfnn_nftsm", "nftsm", "computed_torque"])
def test_a_lane_starts_with_the_error_and_velocity_that_are_asked(law: str) -> None:
    error = [0.1, -0.2, 0.0, 0.3, 0.0, -0.1]
    lane = lane_of(packed_of({"simulation": {"initial_error": error}}, law))
    np.testing.assert_allclose(-lane.work[Q], error)
    np.testing.assert_array_equal(lane.work[V], 1.0)
    rest = lane_of(packed_of({"simulation": {"initial_velocity": "rest"}}, law))
    assert not rest.work[V].any()
    assert not lane.work[W : W + 10].any()


def test_restart_repeats_to_the_last_bit() -> None:
    document = {
        "disturbance": {"noise": {"amplitude": 2.0}, "sensor_noise": {"velocity": 0.01}},
        "simulation": {"mode": "sampled", "input_delay": 0.0023, "initial_error": 0.1},
        "lanes": {"A": {"law": "rbfnn_smc", "k1": 5, "k2": 1}},
        "robot": {"armature": 0.5},
    }
    packed = packed_of(document)
    lane = lane_of(packed)
    assert stepped(lane, packed, 300) == 300
    first = lane.record.copy()
    lane.work[PUSH] = 100.0
    stepped(lane, packed, 50, first=300)
    lane.record[:] = 0.0
    lane.restart(packed)
    assert stepped(lane, packed, 300) == 300
    np.testing.assert_array_equal(lane.record[:300], first[:300])


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("law", [*LAWS, "shaped"])
def test_a_step_depends_on_nothing_but_the_state(law: str, mode: str) -> None:
    chosen = {"law": "nftsm", "inertia_shaped": True} if law == "shaped" else {"law": law}
    gains = {} if law == "computed_torque" else {"k1": 5.0, "k2": 1.0}
    document = {
        "lanes": {"A": {**chosen, **gains}},
        "robot": {"armature": 0.5, "viscous_friction": 1.0, "torque_limit": 20.0},
        "disturbance": {"nominal_mismatch": 0.9},
        "simulation": {**MODES[mode], "initial_error": 0.1},
    }
    packed = packed_of(document)
    left_alone, scribbled = lane_of(packed), lane_of(packed)
    random = np.random.default_rng(1)
    for number in range(20):
        # But for what is written where the lane is bound, and from outside.
        push, drift = scribbled.work[[PUSH, DRIFT]]
        curve = scribbled.work[CURVE : CURVE + CURVE_ROWS].copy()
        period = scribbled.work[PERIOD, 0]
        scribbled.work[FULL:CHANGE_Q] = random.normal(size=(CHANGE_Q - FULL, JOINTS))
        scribbled.work[CURVE : CURVE + CURVE_ROWS] = curve
        scribbled.work[[PUSH, DRIFT]] = push, drift
        scribbled.work[PERIOD, 0] = period
        for lane in (left_alone, scribbled):
            assert lane.step(number * 1e-3, number, number) == 0
    np.testing.assert_array_equal(scribbled.record, left_alone.record)
    np.testing.assert_array_equal(scribbled.work[:STATE_ROWS], left_alone.work[:STATE_ROWS])


@pytest.mark.parametrize("failing", [1, 2])
def test_a_stage_that_fails_ends_its_step(failing: int, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def stage(which: int, t: float, row: int, table: Array) -> int:
        asked.append(t)
        return 3 if len(asked) >= failing else 0

    monkeypatch.setattr(steps, "make_stage", stage)
    lane = lane_of(packed_of({"simulation": {"step": 0.002}}, "smc"))
    assert lane.step(0.5, 0, 0) == 3
    assert asked[:failing] == [0.5, 0.501][:failing]
    # Shorter steps are tried, as far as a live session goes, before it is given up.
    assert asked[failing:] == [0.5] * HALVINGS


def test_a_sample_that_fails_leaves_the_arm_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steps, "sample", lambda *given: 3)
    lane = lane_of(packed_of({"simulation": {"mode": "sampled"}}, "smc"))
    state = lane.work[:STATE_ROWS].copy()
    assert lane.step(0.5, 0, 0) == 3
    np.testing.assert_array_equal(lane.work[:STATE_ROWS], state)


@pytest.mark.parametrize("mismatch", [1.0, 0.8])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_sampled_law_believes_in_its_own_arm_at_what_it_measures(
    mismatch: float, noise: float
) -> None:
    disturbance = {
        "nominal_mismatch": mismatch,
        "sensor_noise": {"position": noise, "velocity": noise},
    }
    packed = packed_of(
        {"disturbance": disturbance, "simulation": {"mode": "sampled", "initial_error": 0.1}},
        "computed_torque",
    )
    lane = lane_of(packed)
    for number in range(3):
        assert lane.step(number * 1e-3, number, number) == 0
    work = lane.work
    nominal = dynamics(packed.nominal or packed.model, work[MEASURED_Q], work[MEASURED_V])
    nominal.refill()
    e, de = work[QD] - work[MEASURED_Q], work[VD] - work[MEASURED_V]
    expected = nominal.inertia @ (work[AD] + 40.0 * de + 400.0 * e) + nominal.bias
    np.testing.assert_allclose(work[TAU], expected, rtol=1e-9, atol=1e-9)


def gained_velocity(patch: dict[str, Any]) -> Array:
    """Return what a patch adds to the velocity [rad/s] of an idle, heavy arm within 5 ms."""
    simulation = {"mode": "sampled", "initial_velocity": "rest", "initial_error": 0.1}
    idle = packed_of(
        {
            "lanes": {"A": IDLE},
            "trajectory": {"kind": "hold"},
            "robot": {"armature": 5.0},
            "simulation": simulation,
        }
    )
    velocities = []
    for packed in (idle, pack(idle.experiment.patched(patch))):
        lane = lane_of(packed)
        assert stepped(lane, packed, 5) == 5
        velocities.append(lane.work[V].copy())
    return velocities[1] - velocities[0]


@pytest.mark.parametrize("start", [0.00045, 0.00195, 0.00345])
def test_a_push_between_two_samples_acts_from_then_on(start: float) -> None:
    pulse = {"amplitude": 30.0, "duration": 1.0}
    whole = gained_velocity({"disturbance": {"pulse": {**pulse, "start": 0.0}}})
    late = gained_velocity({"disturbance": {"pulse": {**pulse, "start": start}}})
    assert np.abs(whole).min() > 1e-3
    # It gives its whole impulse, though it begins within a step of the arm.
    np.testing.assert_allclose(late / whole, 1.0 - start / 0.005, atol=2e-4)


def test_other_gains_leave_the_state() -> None:
    packed = packed_of({})
    lane = lane_of(packed)
    stepped(lane, packed, 50)
    state = lane.work[: W + 10].copy()
    lane.adopt(pack(packed.experiment.patched({"lanes": {"A": {"nu": 30}}})))
    np.testing.assert_array_equal(lane.work[: W + 10], state)


def test_gains_that_do_not_change_change_nothing() -> None:
    packed = packed_of({"simulation": {"mode": "sampled", "input_delay": 0.005}}, "smc")
    packed = pack(
        packed.experiment.patched(
            {"lanes": {"A": {"k1": 5.0, "k2": 1.0}}, "robot": {"armature": 0.5}}
        )
    )
    left_alone, edited = lane_of(packed), lane_of(packed)
    assert stepped(left_alone, packed, 200) == 200
    for first in range(0, 200, 3):
        edited.adopt(packed)
        stepped(edited, packed, 3, first=first)
    np.testing.assert_array_equal(edited.record[:200], left_alone.record[:200])


def test_edits_do_not_keep_a_delayed_torque_from_arriving() -> None:
    document = {
        "simulation": {"mode": "sampled", "input_delay": 0.02},
        "lanes": {"A": {"law": "smc", "k1": 2.0, "k2": 0.0}},
        "robot": {"armature": 1.0},
    }
    packed = packed_of(document)
    lane = lane_of(packed)
    for first in range(0, 100, 5):
        gain = {"lanes": {"A": {"k1": 2.0 + first / 1000}}}
        lane.adopt(pack(packed.experiment.patched(gain)))
        stepped(lane, packed, 5, first=first)
    untouched = lane_of(packed)
    stepped(untouched, packed, 100)
    # Without any torque the arm would have fallen by far more than what the gains change.
    assert np.abs(lane.work[Q] - untouched.work[Q]).max() < 1e-3


def test_torques_on_their_way_obey_a_new_limit() -> None:
    document = {
        "simulation": {"mode": "sampled", "input_delay": 0.05},
        "lanes": {"A": {"law": "smc", "k1": 2.0, "k2": 0.0}},
        "robot": {"armature": 1.0},
    }
    packed = packed_of(document)
    lane = lane_of(packed)
    stepped(lane, packed, 20)
    assert np.abs(lane.commands).max() > 5.0
    lane.adopt(pack(packed.experiment.patched({"robot": {"torque_limit": 5.0}})))
    assert np.abs(lane.commands).max() <= 5.0


def test_a_new_delay_begins_with_the_present_torque() -> None:
    document = {
        "lanes": {"A": {"law": "smc", "k1": 2.0, "k2": 0.0}},
        "robot": {"armature": 1.0},
        "simulation": {"mode": "sampled"},
    }
    packed = packed_of(document)
    lane = lane_of(packed)
    stepped(lane, packed, 20)
    lane.adopt(pack(packed.experiment.patched({"simulation": {"input_delay": 0.01}})))
    np.testing.assert_array_equal(lane.commands, np.tile(lane.work[TAU], (12, 1)))


def test_a_loop_that_becomes_sampled_begins_with_the_torque_it_had() -> None:
    packed = packed_of({"lanes": {"A": {"law": "smc", "k1": 2.0, "k2": 0.0}}})
    lane = lane_of(packed)
    stepped(lane, packed, 20)
    assert not lane.commands.size
    sampled = {"mode": "sampled", "input_delay": 0.003}
    lane.adopt(pack(packed.experiment.patched({"simulation": sampled})))
    assert lane.work[TAU].any()
    np.testing.assert_array_equal(lane.commands, np.tile(lane.work[TAU], (5, 1)))


def test_a_state_that_breaks_goes_back_to_the_last_row_where_it_broke() -> None:
    packed = packed_of({"lanes": {"A": {"law": "rbfnn_nftsm", "k1": 5.0, "k2": 1.0}}})
    lane = lane_of(packed)
    assert stepped(lane, packed, 30) == 30
    state = lane.work[:STATE_ROWS].copy()
    lane.work[Q, 2], lane.work[V, 4], lane.work[W + 3, 1] = np.nan, np.inf, np.nan
    assert stepped(lane, packed, 1, first=30) == 30
    last = lane.record[29]
    assert lane.freeze is not None
    state[Q, 2], state[V, 4], state[W + 3, 1] = last[R_Q, 2], last[R_V, 4], 0.0
    np.testing.assert_array_equal(lane.work[:STATE_ROWS], state)
    row = lane.record[30]
    assert np.isfinite(row).all()
    np.testing.assert_array_equal(row[: R_V + 1], state[[Q, V]])
    # Of what the law said of a broken state, the last that was known stands.
    assert row[R_TAU, 2] == last[R_TAU, 2] != 0.0


def test_a_first_step_that_breaks_shows_nothing_of_an_earlier_run() -> None:
    packed = packed_of({"lanes": {"A": {"law": "rbfnn_nftsm"}}})
    lane = lane_of(packed)
    lane.record[:] = 9.0
    packed.gains["A"][:, 3] = np.nan
    assert stepped(lane, packed, 1) == 0
    tau, sliding = lane.record[0, [R_TAU, R_S]]
    assert (tau[3], sliding[3]) == (0.0, 0.0)
    assert np.isfinite(lane.record[0]).all()


def test_a_sampled_lane_that_diverges_says_when_where_why_and_what_to_do() -> None:
    packed = packed_of(DIVERGENT)
    lane = lane_of(packed)
    number = stepped(lane, packed, 400)
    freeze = lane.freeze
    assert freeze is not None
    assert freeze.time == pytest.approx(number * 1e-3)
    assert 1 <= freeze.joint <= JOINTS
    assert freeze.gamma is not None
    assert freeze.gamma > 1000.0
    for part in (f"Joint {freeze.joint}", "1000 Hz", "ρ =", "γ =", "k₁", "rotor inertia"):
        assert part in freeze.cause
    assert np.isfinite(lane.work[: W + 10]).all()
    assert np.isfinite(lane.record[: number + 1]).all()


def test_a_delay_is_part_of_the_cause() -> None:
    packed = packed_of({"simulation": {"mode": "sampled", "input_delay": 0.001}})
    lane = lane_of(packed)
    stepped(lane, packed, 400)
    assert lane.freeze is not None
    assert "input delay" in lane.freeze.cause
    assert "ρ =" in lane.freeze.cause


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_a_lane_that_is_pushed_away_is_not_blamed_on_its_gains(mode: str) -> None:
    packed = packed_of({**PUSHED, "simulation": {"mode": mode}})
    lane = lane_of(packed)
    stepped(lane, packed, 400)
    freeze = lane.freeze
    assert freeze is not None
    assert freeze.joint == 6
    assert freeze.gamma is None
    assert "disturbance" in freeze.cause
    assert "γ" not in freeze.cause


def test_a_frozen_lane_repeats_its_last_row_beside_the_desired_motion() -> None:
    packed = packed_of(PUSHED)
    lane = lane_of(packed)
    last = stepped(lane, packed, 400)
    for number in (last + 1, last + 2):
        lane.hold(packed, number * 1e-3, number)
    np.testing.assert_array_equal(lane.record[last + 2, :R_QD], lane.record[last, :R_QD])
    desired = lane.record[last + 2, R_QD:]
    np.testing.assert_allclose(desired[0], np.sin((last + 2) * 1e-3))
    np.testing.assert_allclose(desired[1], np.cos((last + 2) * 1e-3))


def test_restart_thaws() -> None:
    packed = packed_of(PUSHED)
    lane = lane_of(packed)
    stepped(lane, packed, 400)
    lane.restart(packed)
    assert lane.freeze is None
    assert not lane.work[Q].any()
