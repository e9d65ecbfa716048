"""A run says how good it is."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest

from slidetune.robot import load_preset
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.accuracy import GOOD, difference, judge, second_run
from slidetune.robot.loop.decisions import APART, Doubt, first_doubt, swings_apart
from slidetune.robot.loop.simulate import LaneRun, simulate
from tests.reference.sampled import solve_sampled

HARSH: dict[str, Any] = {"law": "computed_torque", "kp": 9000.0, "kd": 0.2}


def experiment_of(lane: dict[str, Any], **simulation: Any) -> Experiment:
    document = {
        "robot": {"armature": 0.3},
        "lanes": {"A": lane},
        "simulation": {"horizon": 0.5, "initial_error": 0.3, **simulation},
    }
    return Experiment.from_document(document)


def lane_of(experiment: Experiment) -> LaneRun:
    (lane,) = simulate(experiment).lanes.values()
    return lane


@pytest.mark.parametrize("scheme", ["plain", "extrapolated"])
@pytest.mark.parametrize("step", [0.0002, 0.001, 0.005])
def test_the_error_is_at_most_three_times_its_estimate(scheme: str, step: float) -> None:
    for lane in ({"law": "smc"}, {"law": "rbfnn_nftsm", "nu": 30.0}, {**HARSH, "kd": 5.0}):
        found = lane_of(experiment_of(lane, scheme=scheme, step=step))
        truth = lane_of(experiment_of(lane, step=0.00005))
        error = np.abs(found.q - truth.q[:: round(step / 0.00005)]).max()
        assert found.accuracy.error_estimate is not None
        assert error <= max(1e-7, 3.0 * found.accuracy.error_estimate)
        assert found.accuracy.error_estimate <= max(1e-6, 30.0 * error)


def test_a_sampled_run_is_judged_as_well() -> None:
    lane = {"law": "smc", "k1": 5.0, "k2": 1.0}
    sampled = {"mode": "sampled", "control_rate": 200.0}
    truth = lane_of(experiment_of(lane, **sampled, plant_substeps=200))
    for substeps in (1, 3, 4, 25):
        found = lane_of(experiment_of(lane, **sampled, plant_substeps=substeps))
        error = np.abs(found.q - truth.q).max()
        assert error > 1e-7
        assert error <= 3.0 * found.accuracy.error_estimate <= 30.0 * error


@pytest.mark.parametrize("delay", [0.0, 0.001, 0.0003, 0.00025, 0.0104, 0.00104])
@pytest.mark.parametrize("substeps", [1, 2, 5, 10])
def test_the_second_run_holds_the_same_delay(delay: float, substeps: int) -> None:
    simulation = {"mode": "sampled", "input_delay": delay, "plant_substeps": substeps}
    first = experiment_of({"law": "smc"}, **simulation)
    second, stride, _ = second_run(first)
    assert stride == 1
    assert second.simulation.plant_substeps != substeps
    for simulation in (first.simulation, second.simulation):
        whole, part = simulation.delay
        late = (whole + part / simulation.plant_substeps) / simulation.control_rate
        assert late == pytest.approx(delay, abs=1e-12)


def late_experiment(dice: random.Random) -> Experiment:
    """Draw a sampled loop of one lane: rate, steps of the arm, and a delay of any length."""

    def placed(low: float, high: float) -> float:
        return math.exp(dice.uniform(math.log(low), math.log(high)))

    rate = placed(50.0, 1000.0)
    lane = dice.choice(
        [
            {"law": "smc", "k1": placed(0.5, 50.0), "k2": placed(0.1, 10.0), "epsilon": 0.5},
            {"law": "computed_torque", "kp": placed(10.0, 200.0), "kd": placed(2.0, 20.0)},
            {"law": "nftsm", "nu": 5.0, "k1": placed(0.5, 20.0), "k2": 1.0, "epsilon": 0.5},
        ]
    )
    simulation = {
        "mode": "sampled",
        "control_rate": rate,
        "plant_substeps": dice.choice([1, 2, 3, 4, 5, 10, 20]),
        "input_delay": dice.choice([dice.uniform(0.0, 1.5 / rate), placed(1e-5, 0.02)]),
        "horizon": 0.3,
        "initial_error": dice.choice([0.0, 0.05]),
    }
    robot = {"armature": 0.5, "viscous_friction": 2.0, "coulomb_friction": 2.0}
    document = {"lanes": {"A": lane}, "robot": robot, "simulation": simulation}
    return Experiment.from_document(document)


@pytest.mark.parametrize("seed", range(24))
def test_the_estimate_holds_whatever_the_delay_is_in_steps_of_the_arm(seed: int) -> None:
    experiment = late_experiment(random.Random(seed))
    found, truth = lane_of(experiment), solve_sampled(experiment.document())
    error = difference(found.q, truth)
    assert 1e-8 < error <= 3.0 * found.accuracy.error_estimate <= 30.0 * error


@pytest.mark.parametrize(("rate", "substeps", "delay"), [(333.0, 2, 0.0013), (1000.0, 10, 0.00104)])
def test_a_delay_within_a_step_of_the_arm_is_no_error(
    rate: float, substeps: int, delay: float
) -> None:
    patch = {
        "simulation": {
            "control_rate": rate,
            "plant_substeps": substeps,
            "input_delay": delay,
            "horizon": 1.0,
        },
        "disturbance": {"sensor_noise": {"position": 0.0, "velocity": 0.0}},
    }
    experiment = load_preset("realistic").patched(patch)
    fine = experiment.patched({"simulation": {"plant_substeps": 20 * substeps}})
    truth = simulate(fine, estimate=False)
    for name, lane in simulate(experiment).lanes.items():
        error = difference(lane.q, truth.lanes[name].q)
        assert error <= 3.0 * lane.accuracy.error_estimate, name


def test_a_bad_run_says_so_and_offers_a_step_that_does() -> None:
    experiment = experiment_of(HARSH, step=0.005, scheme="plain")
    accuracy = lane_of(experiment).accuracy
    assert accuracy.error_estimate > GOOD
    assert "estimated error" in accuracy.remark
    if accuracy.patch is None:
        assert "No allowed step" in accuracy.remark
    better = experiment.patched({"simulation": {"scheme": "extrapolated", "step": 0.005}})
    accuracy = lane_of(better).accuracy
    assert accuracy.patch is not None
    for _ in range(4):
        better = better.patched(accuracy.patch)
        accuracy = lane_of(better).accuracy
        if accuracy.patch is None:
            break
    assert accuracy.error_estimate <= GOOD
    assert accuracy.remark == ""


def test_an_unsolved_step_is_never_passed_over() -> None:
    accuracy = judge(experiment_of(HARSH), 1e-9, unconverged=3, left=0.25, capped=0)
    assert "3 steps were not solved" in accuracy.remark
    assert "0.2 rad/s" in accuracy.remark
    assert judge(experiment_of(HARSH), 1e-9, 0, 0.0, 5).remark == ""


def test_rows_that_ran_out_of_parts_make_the_estimate_doubtful_in_words() -> None:
    accuracy = judge(experiment_of(HARSH), 1e-9, 0, 0.0, capped=100)
    assert "100 rows were not subdivided as far as their local error requires" in accuracy.remark
    assert "larger than estimated" in accuracy.remark
    assert accuracy.at_least
    assert judge(experiment_of(HARSH), 1e-9, 0, 0.0, 0, damped=20.0).at_least


def test_a_wild_motion_says_that_its_error_is_at_least_the_estimate() -> None:
    lane = {"law": "computed_torque", "kp": 2000.0, "kd": 100.0}
    late = {"mode": "sampled", "control_rate": 60.0, "plant_substeps": 9}
    found = lane_of(experiment_of(lane, **late)).accuracy
    assert found.at_least
    assert "many times the estimate" in found.remark
    assert not lane_of(experiment_of({**lane, "kp": 100.0, "kd": 10.0}, **late)).accuracy.at_least


def test_an_observer_that_acts_over_one_step_behind_a_lag_is_told() -> None:
    for observer, lag, told in (("time_delay", 0.004, True), ("momentum", 0.004, False)):
        experiment = experiment_of({"law": "smc", "k1": 5.0, "k2": 1.0, "observer": observer})
        found = lane_of(experiment.patched({"robot": {"lag": lag}})).accuracy
        assert found.at_least == told
        assert ("sampled mode" in found.remark) == told
    prompt = experiment_of({"law": "smc", "k1": 5.0, "k2": 1.0, "observer": "time_delay"})
    assert not lane_of(prompt).accuracy.at_least


def test_a_loop_that_chatters_where_it_should_be_is_not_wild() -> None:
    for name in ("chattering-sign", "realistic"):
        for lane in simulate(load_preset(name)).lanes.values():
            assert "rated" not in lane.accuracy.remark


def test_nobody_pays_for_an_estimate_that_nobody_asked_for() -> None:
    (lane,) = simulate(experiment_of({"law": "smc"}), estimate=False).lanes.values()
    assert lane.accuracy.error_estimate is None
    assert lane.accuracy.remark == ""


def test_the_estimate_changes_nothing_of_the_run() -> None:
    experiment = experiment_of({"law": "rbfnn_smc"})
    one, other = simulate(experiment), simulate(experiment, estimate=False)
    np.testing.assert_array_equal(one.lanes["A"].q, other.lanes["A"].q)
    np.testing.assert_array_equal(one.lanes["A"].tau, other.lanes["A"].tau)


def test_differences_end_where_one_of_both_does() -> None:
    q = np.zeros((5, 6))
    other = q.copy()
    other[2:] = 7.0
    q[3:] = np.nan
    assert difference(q, other) == 7.0
    q[2:] = np.nan
    assert difference(q, other) == 0.0


@pytest.mark.parametrize("name", ["paper", "paper-undisturbed", "experiment-quintic"])
def test_shipped_presets_are_good(name: str) -> None:
    for lane in simulate(load_preset(name)).lanes.values():
        assert lane.accuracy.error_estimate < 1e-4
        assert lane.accuracy.remark == ""


def test_its_document_is_plain() -> None:
    document = lane_of(experiment_of({"law": "smc"})).accuracy.document()
    keys = {"error_estimate", "unconverged", "capped", "at_least", "remark", "patch"}
    assert set(document) == keys
    assert type(document["error_estimate"]) is float
    assert type(document["capped"]) is int


FINE, FINER = 100, 200


def drawn(seed: int) -> Experiment:
    dice = np.random.default_rng(seed)
    laws = ("smc", "nftsm", "rbfnn_smc", "rbfnn_nftsm", "super_twisting", "adaptive_smc")
    law = laws[seed % len(laws)]
    lane: dict[str, Any] = {
        "law": law,
        "k1": float(10.0 ** dice.uniform(0.0, 1.3)),
        "k2": float(10.0 ** dice.uniform(-0.5, 1.2)),
    }
    if law != "super_twisting":
        switching = "tanh" if seed % 4 == 0 else "sign"
        lane |= {"switching": switching, "epsilon": float(10.0 ** dice.uniform(-2.0, 0.0))}
    return Experiment.from_document(
        {
            "robot": {"model": "two_links"},
            "lanes": {"lane": lane},
            "trajectory": {
                "kind": "sine",
                "amplitude": float(dice.uniform(0.2, 1.0)),
                "angular_frequency": float(dice.uniform(0.5, 3.0)),
            },
            "disturbance": {"constant": float(dice.uniform(-2.0, 2.0))},
            "simulation": {
                "mode": "sampled",
                "control_rate": float(dice.choice([500.0, 1000.0, 2000.0])),
                "plant_substeps": int(dice.choice([2, 4, 10, 20])),
                "initial_error": float(dice.uniform(-0.2, 0.2)),
                "horizon": 1.0,
            },
        }
    )


def apart(one: LaneRun, other: LaneRun) -> float:
    both = np.isfinite(one.q[:, 0]) & np.isfinite(other.q[:, 0])
    return float(np.abs(one.q[both] - other.q[both]).max())


@pytest.mark.parametrize("first", [0, 10, 20])
def test_the_true_error_is_not_above_the_estimate_or_said_to_be(first: int) -> None:
    known = 0
    for seed in range(first, first + 10):
        experiment = drawn(seed)
        lanes = []
        for substeps in (FINER, FINE, experiment.simulation.plant_substeps):
            patch = {"simulation": {"plant_substeps": substeps}}
            lanes += simulate(experiment.patched(patch)).lanes.values()
        finer, fine, lane = lanes
        true = apart(lane, finer)
        if lane.freeze or finer.freeze or apart(fine, finer) > 0.2 * true:
            continue  # what is right is not known well enough
        known += 1
        assert lane.accuracy.error_estimate is not None
        assert true <= lane.accuracy.error_estimate or lane.accuracy.at_least
        if experiment.document()["lanes"]["lane"].get("switching") == "tanh":
            assert "decides by a sign" not in lane.accuracy.remark
    assert known >= 3


def test_a_decision_is_in_doubt_where_two_runs_are_as_far_apart_as_it_is_from_turning() -> None:
    S = np.array([[0.0, 1.0], [0.5, -0.3], [0.011, np.nan]])
    other = S + np.array([[0.0, 0.1], [0.1, 0.1], [0.01, 0.0]])
    assert first_doubt(np.zeros(1), S[:2], other[:2], 1.0) is None
    assert first_doubt(np.zeros(1), S, other, 1.0) == Doubt(2, 1)
    assert first_doubt(np.zeros(1), S, other, 0.5) is None
    assert first_doubt(np.array([9.0, 0.9]), S, other, 1.0) == Doubt(0, 2)


@pytest.mark.parametrize("preset", ["chattering-sign", "chattering-tanh-250hz", "drive-lag"])
def test_a_loop_that_swings_by_itself_is_said_to_be_out_of_step(preset: str) -> None:
    experiment = load_preset(preset)
    exact = simulate(experiment.patched({"simulation": {"plant_substeps": FINER}}), estimate=False)
    told = 0
    for name, lane in simulate(experiment).lanes.items():
        assert lane.accuracy.error_estimate is not None
        settled = apart(lane, exact.lanes[name]) <= lane.accuracy.error_estimate
        assert settled or lane.accuracy.at_least
        swings = "out of step" in lane.accuracy.remark
        told += swings
        if name in ("tanh", "wide", "integral", "observer"):
            assert not lane.accuracy.at_least
    assert told


def test_how_far_two_runs_are_out_of_step_is_told_by_the_later_half() -> None:
    S = np.array([[1.0, 0.0], [1.0, 1e-9], [2.0, 2e-9], [-4.0, np.nan]])
    assert swings_apart(S, S) == 0.0
    assert swings_apart(S, S + 0.1) == pytest.approx(0.1 / 2e-9)
    assert swings_apart(S[:, :1], S[:, :1] + 0.1) == pytest.approx(0.025)
    assert APART > 0.025
    early = S[:, :1] + np.array([[9.0], [0.0], [0.0], [0.0]])
    assert swings_apart(S[:, :1], early) == 0.0
