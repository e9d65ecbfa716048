"""What the pencil says, beside what simulate() does: bands, never trajectories."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.lenses import look_through
from slidetune.robot.lenses.prediction import PredictedJoint, PredictionView, look
from slidetune.robot.loop.simulate import simulate

Array = np.ndarray

LAG = {"lag": 0.004, "lag_order": "second"}
FREE: dict[str, Any] = {"robot": {"coulomb_friction": 0.0}}
"""Friction takes part of a swing while a joint turns round, which the lens says."""
CHATTERING: list[tuple[str, str, dict[str, Any]]] = [
    ("chattering-sign", "sign", {}),
    ("chattering-sign", "sign", {"robot": LAG}),
    ("chattering-sign", "tanh", {"robot": LAG}),
    ("chattering-tanh-250hz", "narrow", {}),
    ("realistic", "RBFNN-NFTSM", {"robot": LAG}),
    ("realistic", "NFTSM", {"robot": LAG}),
    ("realistic", "RBFNN-SMC", {"robot": {"lag": 0.003, "lag_order": "second"}}),
    ("drive-lag", "sign", FREE),
    ("drive-lag", "implicit", FREE),
    ("drive-lag", "tanh", {"robot": {**FREE["robot"], **LAG}}),
    ("drive-lag", "implicit", {"robot": {**FREE["robot"], **LAG}}),
]
"""Shipped lanes that chatter, as they are and with drives as they are built."""


def seen(experiment: Experiment, lane: str) -> PredictionView:
    run = simulate(experiment, estimate=False).lanes[lane]
    exact = {"sensor_noise": {"position": 0.0, "velocity": 0.0}}
    quiet = experiment.patched({"disturbance": exact})
    view = look(pack(experiment), lane, run, simulate(quiet, estimate=False).lanes[lane])
    assert view is not None
    return view


def agrees(joint: PredictedJoint, period: float) -> bool:
    """Tell whether a joint swings as predicted.

    Where the samples decide, the frequency is any between the slowest and the fastest, and the
    swing as much farther as it takes longer.
    """
    frequency, amplitude = joint.measured_frequency, joint.measured_amplitude
    assert frequency is not None
    assert amplitude is not None
    assert joint.frequency is not None
    assert joint.amplitude is not None
    assert joint.slowest is not None
    assert joint.fastest is not None
    if joint.coarse:
        farther = amplitude * frequency / (joint.amplitude * joint.frequency)
        return 0.9 * joint.slowest < frequency < 1.1 * joint.fastest and 0.75 < farther < 1.33
    # A period is a whole number of samples.
    late = abs(1.0 / frequency - 1.0 / joint.frequency)
    near = late < max(0.1 / joint.frequency, period)
    return near and abs(joint.amplitude / amplitude - 1.0) < 0.25


@pytest.mark.parametrize(("preset", "lane", "patch"), CHATTERING)
def test_presets_that_chatter_do_so_as_predicted(
    preset: str, lane: str, patch: dict[str, Any]
) -> None:
    experiment = load_preset(preset).patched(patch)
    view = seen(experiment, lane)
    period = experiment.simulation.row_period
    thin = [
        joint
        for joint in view.joints
        if joint.threshold is not None and joint.layer < 0.8 * joint.threshold
    ]
    assert thin
    assert all(agrees(joint, period) for joint in thin), view


@pytest.mark.parametrize(
    ("preset", "lane"), [("chattering-sign", "tanh"), ("chattering-tanh-250hz", "wide")]
)
def test_presets_that_are_smooth_are_predicted_to_be(preset: str, lane: str) -> None:
    view = seen(load_preset(preset), lane)
    assert view.threshold is not None
    for joint in view.joints:
        assert joint.layer > view.threshold
        assert joint.amplitude == 0.0
        assert joint.measured_frequency is None


@pytest.mark.parametrize(
    ("preset", "lane"),
    [(name, lane) for name in ("paper", "experiment-quintic") for lane in load_preset(name).lanes]
    + [("drive-lag", "integral")],
)
def test_what_nothing_makes_swing_is_silent_and_has_its_picture(preset: str, lane: str) -> None:
    view = seen(load_preset(preset), lane)
    for joint in view.joints:
        assert not joint.amplitude
        assert joint.measured_frequency is None
        curve, dots = joint.curve[0] + 1j * joint.curve[1], joint.line[1]
        assert len(curve) == len(joint.curve_frequency) > 50
        assert dots.max() == pytest.approx(-joint.layer, rel=1e-2)
        if joint.crossing is not None:
            assert joint.layer > abs(joint.crossing[0])
            assert joint.clearance is None
        elif joint.clearance is None:
            assert np.abs(curve).max() <= joint.layer
        else:
            assert joint.nearest is not None
            near = int(np.argmin(np.abs(joint.curve_frequency - joint.nearest)))
            assert abs(curve[near]) > joint.layer
            assert abs(np.angle(curve[near])) == pytest.approx(np.pi - joint.clearance)


@pytest.mark.parametrize("robot", [{}, LAG])
def test_super_twisting_behind_drives_swings_as_predicted(robot: dict[str, Any]) -> None:
    experiment = load_preset("drive-lag").patched({"robot": {**FREE["robot"], **robot}})
    view = seen(experiment, "super-twisting")
    assert view.switching == "twisting"
    assert view.threshold is None
    assert view.epsilon is None
    assert all(agrees(joint, 0.001) for joint in view.joints), view
    for joint in view.joints:
        amplitudes, real, imaginary = joint.line
        assert joint.crossing is not None
        assert np.all(np.diff(amplitudes) > 0.0)
        # The dots pass through the point where they meet the curve.
        off = np.hypot(real - joint.crossing[0], imaginary - joint.crossing[1])
        assert off.min() < 0.1 * np.hypot(*joint.crossing)


@pytest.mark.parametrize("seed", range(8))
def test_drawn_super_twisting_swings_as_predicted(seed: int) -> None:
    random = np.random.default_rng(100 + seed)
    bound = float(random.uniform(30.0, 300.0))
    lane = {
        "law": "super_twisting",
        "k1": 1.5 * bound**0.5 * float(random.uniform(0.7, 1.5)),
        "k2": 1.1 * bound * float(random.uniform(0.5, 1.5)),
        "lambda_": float(random.uniform(3.0, 15.0)),
    }
    document = drawn(seed).document()
    document["lanes"] = {"A": lane}
    experiment = Experiment.from_document(document)
    view = seen(experiment, "A")
    assert all(agrees(joint, experiment.simulation.row_period) for joint in view.joints), view


def test_an_implicit_sign_without_delay_is_predicted_to_be_silent() -> None:
    """And with one period of it, joints that swing do so at the sixth of the control rate."""
    patch = {"robot": {"lag": 0.0}, "simulation": {"input_delay": 0.0, "horizon": 4.0}}
    view = seen(load_preset("drive-lag").patched(patch), "implicit")
    for joint in view.joints:
        assert joint.amplitude == 0.0
        assert joint.measured_frequency is None
    late = load_preset("drive-lag").patched({**patch, "simulation": {"horizon": 4.0}})
    for joint in seen(late, "implicit").joints:
        assert joint.frequency == pytest.approx(1000.0 / 6.0, rel=0.02)
        if joint.measured_frequency is not None:
            assert joint.measured_frequency == pytest.approx(joint.frequency, rel=0.1)


def test_an_observer_carries_the_load() -> None:
    view = seen(load_preset("drive-lag"), "observer")
    assert all(joint.load == 0.0 for joint in view.joints)


def drawn(seed: int) -> Experiment:
    """A loop whose frequency is its drives' more than its samples', mostly."""
    random = np.random.default_rng(seed)
    rate = float(random.choice([250.0, 500.0, 1000.0, 2000.0, 4000.0]))
    order = ["first", "second"][seed % 2]
    lag = float(random.uniform(0.002, 0.01)) * min(max(1.0, 800.0 / rate), 1.5)
    delay = float(random.uniform(0.0, 0.003)) + (2.0 / rate if order == "first" else 0.0)
    k2 = np.array([40.0, 40.0, 25.0, 5.0, 5.0, 5.0]) * random.uniform(0.4, 2.0)
    k1 = np.array([20.0, 20.0, 12.0, 2.0, 2.0, 2.0]) * random.choice([0.0, 0.5, 1.0])
    law = str(random.choice(["smc", "nftsm", "rbfnn_nftsm"]))
    lane = {"law": law, "k1": k1.tolist(), "k2": k2.tolist(), "switching": "sign"}
    if law != "smc":
        lane.update(nu=8.0, c=float(random.uniform(0.7, 2.0)), mu=0.05)
    if law == "nftsm" and random.random() < 0.5:
        lane.update(inertia_shaped=True, k1=5.0, k2=float(random.uniform(5.0, 30.0)))
    if law == "rbfnn_nftsm":
        lane.update(learning_rate=[40, 40, 20, 4, 4, 4])
    document = {
        "robot": {
            "inertials": "datasheet",
            "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15],
            "viscous_friction": [5, 5, 4, 0.8, 0.8, 0.8],
            "lag": lag,
            "lag_order": order,
        },
        "lanes": {"A": lane},
        "trajectory": {"kind": "hold", "position": random.uniform(-1.2, 1.2, 6).tolist()},
        "simulation": {
            "mode": "sampled",
            "control_rate": rate,
            "plant_substeps": max(4, int(8000 / rate)),
            "input_delay": min(delay, 0.05),
            "horizon": 3.0,
            "initial_error": random.uniform(-0.003, 0.003, 6).tolist(),
        },
    }
    return Experiment.from_document(document)


@pytest.mark.parametrize("seed", range(16))
def test_drawn_loops_chatter_as_predicted(seed: int) -> None:
    experiment = drawn(seed)
    first = seen(experiment, "A")
    period = experiment.simulation.row_period
    assert all(agrees(joint, period) for joint in first.joints), first
    assert first.threshold is not None
    # And within half of the layer that would silence it.
    switching = ("tanh", "saturation")[seed % 4 // 2]
    layer = {"switching": switching, "epsilon": [0.5 * joint.threshold for joint in first.joints]}  # type: ignore[operator]
    second = seen(experiment.patched({"lanes": {"A": layer}}), "A")
    assert all(agrees(joint, period) for joint in second.joints), second


def test_the_proposed_layer_is_silent_and_in_the_form_of_the_lanes_own() -> None:
    experiment = load_preset("chattering-sign").patched({"robot": LAG})
    one = seen(experiment, "sign")
    assert isinstance(one.epsilon, float)
    assert one.threshold is not None
    assert one.threshold < one.epsilon < 1.15 * one.threshold
    each = experiment.patched({"lanes": {"sign": {"epsilon": [0.03] * 6}}})
    several = seen(each, "sign").epsilon
    assert isinstance(several, list)
    for layer in (one.epsilon, several):
        wide = experiment.patched({"lanes": {"sign": {"switching": "tanh", "epsilon": layer}}})
        assert all(joint.measured_frequency is None for joint in seen(wide, "sign").joints)


def test_the_layer_proposed_in_place_of_an_implicit_sign_is_silent() -> None:
    experiment = load_preset("drive-lag")
    one = seen(experiment, "implicit")
    assert one.joints[0].amplitude
    change = {"switching": "tanh", "epsilon": one.epsilon}
    smooth = seen(experiment.patched({"lanes": {"implicit": change}}), "implicit")
    assert smooth.threshold == pytest.approx(one.threshold)
    assert not any(joint.amplitude or joint.measured_frequency for joint in smooth.joints)


def test_continuous_mode_chatters_by_its_drives_alone() -> None:
    smooth = load_preset("chattering-sign").patched(
        {"simulation": {"mode": "continuous", "horizon": 3.0}}
    )
    for joint in seen(smooth, "sign").joints:
        assert joint.frequency is None
        assert joint.threshold is None
        assert joint.measured_frequency is None
    view = seen(smooth.patched({"robot": LAG}), "sign")
    for joint in view.joints:
        assert joint.frequency == pytest.approx(1.0 / (2.0 * np.pi * 0.004), rel=0.05)
        assert agrees(joint, 0.001)


def test_limits_and_friction_are_told_where_they_act() -> None:
    experiment = load_preset("chattering-sign").patched({"robot": LAG})
    free, tight, sticky = (
        seen(experiment.patched({"robot": patch, "simulation": {"horizon": 3.0}}), "sign").joints[3]
        for patch in (
            {"torque_limit": None, "coulomb_friction": 0.0},
            {"torque_limit": 5.5},
            {"coulomb_friction": 4.0},
        )
    )
    assert free.limited == 0.0
    assert free.sticking == 0.0
    assert tight.limited > 0.5
    assert sticky.sticking > 0.0


@pytest.mark.parametrize("switching", ["sign", "tanh"])
def test_a_loop_that_no_layer_holds_is_given_no_amplitude(switching: str) -> None:
    document = drawn(2).document()
    k1 = [720.0, 720.0, 480.0, 96.0, 96.0, 96.0]
    lane = {"law": "smc", "k1": k1, "k2": [40.0, 40.0, 25.0, 5.0, 5.0, 5.0], "epsilon": 0.5}
    document["lanes"] = {"A": {**lane, "switching": switching}}
    experiment = Experiment.from_document(document)
    run = simulate(experiment, estimate=False).lanes["A"]
    assert run.freeze is not None
    view = look(pack(experiment), "A", run)
    assert view is not None
    assert view.threshold is None
    for joint in view.joints:
        assert joint.frequency is not None
        assert joint.amplitude is None
        assert joint.threshold is None


def beside_a_slow_drive(**lane: Any) -> Experiment:
    document = drawn(2).document()
    gains = {"law": "integral_smc", "k1": 7.5, "k2": 30.0, "kp": 100.0, "kd": 20.0}
    document["lanes"] = {"A": {**gains, "switching": "sign", **lane}}
    document["robot"] |= {"lag": [0.001, 0.002, 0.015, 0.002, 0.007, 0.001], "lag_order": "second"}
    document["simulation"] |= {"control_rate": 250.0, "plant_substeps": 32, "input_delay": 0.0}
    return Experiment.from_document(document)


def test_joints_beside_one_with_a_slow_drive_have_their_limit_cycles() -> None:
    experiment = beside_a_slow_drive()
    view = seen(experiment, "A")
    assert view.threshold is not None
    for joint in view.joints:
        assert joint.threshold is not None
        assert joint.amplitude
    # Those that joint 3 hardly moves.
    assert all(agrees(view.joints[alone], 0.004) for alone in (0, 4, 5)), view


def test_a_layer_that_a_lane_may_not_have_is_not_proposed() -> None:
    slow = beside_a_slow_drive(k1=0.0, k2=1000.0, kp=4.0, kd=3.0).patched({"robot": {"lag": 0.03}})
    view = seen(slow, "A")
    assert view.threshold is not None
    assert view.threshold > 10.0
    assert view.epsilon is None


def test_a_lane_without_a_switching_term_has_no_prediction() -> None:
    experiment = Experiment.from_document(
        {"lanes": {"A": {"law": "computed_torque"}}, "simulation": {"horizon": 0.5}}
    )
    assert look_through(experiment, "A", ["prediction"])["prediction"] is None


def test_what_it_shows_is_plain_json() -> None:
    experiment = load_preset("chattering-sign").patched({"simulation": {"horizon": 1.0}})
    shown = look_through(experiment, "sign", ["prediction"])
    json.dumps(shown, allow_nan=False)
    assert len(shown["prediction"]["joints"]) == 6
