"""What is said of the numbers before they are run, against what happens when they are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.advice.remark import Advice
from slidetune.robot.advice.sufficient import sufficient_layer, sufficient_rate
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.experiment.simulation import MAX_STEPS, Simulation
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.margins.margin import is_stable, margin_limit, sampling_margin, worst_margin

Array = np.ndarray
DATASHEET = {"inertials": "datasheet", "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15]}
CHATTERING = {
    "law": "rbfnn_nftsm",
    "nu": 10,
    "c": 1,
    "mu": 0.1,
    "k1": [80, 80, 40, 8, 8, 8],
    "k2": [40, 40, 25, 5, 5, 5],
    "learning_rate": [40, 40, 20, 4, 4, 4],
    "epsilon": 0.03,
}
DELAYS = [0.0, 0.0001, 0.0003, 0.0005, 0.001, 0.002]


def packed_of(document: dict[str, Any], lane: dict[str, Any] | None = None) -> Packed:
    lanes = {"A": lane or {"law": "rbfnn_nftsm"}}
    return pack(Experiment.from_document({"lanes": lanes, **document}))


def linear(share: float, delay: float, lane: dict[str, Any] | None = None) -> LaneRun:
    """Run linear gains at a share of the margin that is said to be the border."""
    lane = lane or {"law": "smc", "k2": 0.0, "lambda_": 0.5}
    document: dict[str, Any] = {
        "trajectory": {"kind": "hold"},
        "simulation": {
            "mode": "sampled",
            "input_delay": delay,
            "horizon": 2.0,
            "initial_error": 1e-4,
        },
    }
    probe = packed_of(document, {**lane, "k1": 1.0})
    pose = np.array(probe.experiment.trajectory.position)
    gain = share * margin_limit(probe.experiment.simulation) / sampling_margin(probe, "A", pose)
    packed = packed_of(document, {**lane, "k1": gain})
    return simulate(packed.experiment).lanes["A"]


@pytest.mark.parametrize("delay", DELAYS)
def test_linear_gains_just_below_the_border_decay(delay: float) -> None:
    run = linear(0.96, delay)
    assert run.freeze is None
    # With a delay the arm falls freely for a moment; what that leaves dies with 1/lambda.
    assert np.abs(run.v[-200:]).max() < 0.02
    assert np.abs(run.e[-200:]).max() < 0.1


@pytest.mark.parametrize("delay", DELAYS)
def test_linear_gains_just_above_the_border_diverge(delay: float) -> None:
    run = linear(1.04, delay)
    assert run.freeze is not None
    assert "γ" in run.freeze.cause


@pytest.mark.parametrize(("gamma", "diverges"), [(1.9, False), (2.1, True)])
def test_gamma_two_divides_a_layer_that_holds_from_a_limit_cycle(
    gamma: float, diverges: bool
) -> None:
    # k1 = 0: all of the slope is the layer's, and the switching bounds what comes of it.
    document = {
        "trajectory": {"kind": "hold"},
        "simulation": {"mode": "sampled", "horizon": 2.0, "initial_error": 1e-4},
    }
    lane = {"law": "smc", "k1": 0.0, "switching": "saturation", "lambda_": 0.5, "epsilon": 0.01}
    probe = packed_of(document, {**lane, "k2": 1.0})
    pose = np.array(probe.experiment.trajectory.position)
    k2 = gamma / sampling_margin(probe, "A", pose)
    run = simulate(packed_of(document, {**lane, "k2": k2}).experiment).lanes["A"]
    assert run.freeze is None
    assert (np.abs(run.S[-200:]).max() > 0.01) == diverges


def test_gamma_of_computed_torque_is_the_step_times_its_damping() -> None:
    lane = {"law": "computed_torque", "kp": 0.0, "kd": 1.0}
    document = {"trajectory": {"kind": "hold"}, "simulation": {"mode": "sampled", "horizon": 1.0}}
    probe = packed_of(document, lane)
    pose = np.array(probe.experiment.trajectory.position)
    # Shaped by the inertia, every joint has the same margin: h times kd.
    assert sampling_margin(probe, "A", pose) == pytest.approx(1e-3, rel=1e-9)
    slow = {"simulation": {"control_rate": 100.0, "horizon": 3.0, "initial_velocity": "rest"}}
    swing = {"trajectory": {"kind": "sine"}}
    for kd, diverges in ((190.0, False), (210.0, True)):
        patch = {**slow, **swing, "lanes": {"A": {"kd": kd}}}
        run = simulate(probe.experiment.patched(patch)).lanes["A"]
        assert (run.freeze is not None) == diverges


@pytest.mark.parametrize("substeps", [1, 4, 10])
@pytest.mark.parametrize("delay", [0.0, 0.1, 0.24, 0.26, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 12.3])
def test_border_under_delay_is_where_the_roots_leave_the_unit_circle(
    delay: float, substeps: int
) -> None:
    simulation = Simulation(mode="sampled", input_delay=delay * 1e-3, plant_substeps=substeps)
    whole, part = simulation.delay
    late = part / substeps
    polynomial = np.zeros(whole + 3)
    polynomial[:2] = 1.0, -1.0

    def largest(gamma: float) -> float:
        delayed = polynomial.copy()
        delayed[whole + 1] += gamma * (1.0 - late)
        delayed[whole + 2] += gamma * late
        return float(np.abs(np.roots(delayed)).max())

    border = margin_limit(simulation)
    assert largest(0.995 * border) < 1.0
    assert largest(1.005 * border) > 1.0


@pytest.mark.parametrize(("periods", "border"), [(0, 2.0), (1, 1.0), (2, 0.618034), (3, 0.445042)])
def test_border_under_whole_periods_of_delay(periods: int, border: float) -> None:
    simulation = Simulation(mode="sampled", input_delay=periods * 1e-3)
    assert margin_limit(simulation) == pytest.approx(border, rel=1e-4)


@pytest.mark.parametrize("delay", [0.0, 0.0005, 0.001])
@pytest.mark.parametrize("k1", [100.0, 300.0, 1000.0])
def test_a_proposed_rate_suffices_and_hardly_more(k1: float, delay: float) -> None:
    document = {"robot": DATASHEET, "simulation": {"mode": "sampled", "input_delay": delay}}
    packed = packed_of(document, {"law": "smc", "k1": k1, "k2": 0.0})
    rate = sufficient_rate(packed, "A")
    # In continuous time a delay bears pi/2 of damping times delay.
    bearable = worst_margin(packed, "A") * 1000.0 * delay < 0.9 * np.pi / 2
    assert (rate is not None) == bearable
    if rate is None:
        return
    for share, stable in ((1.0, True), (0.97, False)):
        other = packed.experiment.patched({"simulation": {"control_rate": share * rate}})
        assert is_stable(pack(other), "A") == (stable or rate == 1000.0)


def test_no_rate_outruns_a_delay_in_seconds() -> None:
    document = {"robot": DATASHEET, "simulation": {"mode": "sampled", "input_delay": 0.01}}
    assert sufficient_rate(packed_of(document, {**CHATTERING, "k1": 300}), "A") is None


def test_published_gains_have_the_published_margin() -> None:
    packed = packed_of({"simulation": {"mode": "sampled"}})
    gamma = sampling_margin(packed, "A", np.zeros(JOINTS))
    # 2675 per millisecond: it would take a step below 0.75 microseconds.
    assert worst_margin(packed, "A") == pytest.approx(2675.0, rel=0.01)
    assert 2.0 / gamma * 1e-3 == pytest.approx(7.5e-7, rel=0.01)


def test_margin_grows_with_the_gains_and_falls_with_rate_and_armature() -> None:
    document = {"simulation": {"mode": "sampled"}, "robot": {"armature": 0.5}}
    base = packed_of(document, CHATTERING)
    gamma = worst_margin(base, "A")
    for patch, grows in (
        ({"lanes": {"A": {"k1": 200}}}, True),
        ({"lanes": {"A": {"epsilon": 0.01}}}, True),
        ({"lanes": {"A": {"c": 5}}}, True),
        ({"robot": {"armature": 1.0}}, False),
        ({"lanes": {"A": {"epsilon": 0.1}}}, False),
    ):
        assert (worst_margin(pack(base.experiment.patched(patch)), "A") > gamma) == grows
    faster = pack(base.experiment.patched({"simulation": {"control_rate": 4000}}))
    assert worst_margin(faster, "A") == pytest.approx(gamma / 4.0)


def test_margin_tells_where_the_boundary_layer_chatters() -> None:
    simulation = {"simulation": {"mode": "sampled"}}
    packed = packed_of({"robot": DATASHEET, **simulation}, CHATTERING)
    assert worst_margin(packed, "A") < 2.0
    thin = packed.experiment.patched({"lanes": {"A": {"epsilon": 0.01}}})
    assert worst_margin(pack(thin), "A") > 2.0
    slow = packed.experiment.patched({"simulation": {"control_rate": 250}})
    assert worst_margin(pack(slow), "A") > 2.0
    wide = slow.patched({"lanes": {"A": {"epsilon": 0.1}}})
    assert worst_margin(pack(wide), "A") < 2.0


def test_sensor_noise_does_not_shake_the_margin() -> None:
    noise = {"sensor_noise": {"position": 0.01, "velocity": 0.5}}
    document = {"simulation": {"mode": "sampled"}, "disturbance": noise}
    assert worst_margin(packed_of(document), "A") == pytest.approx(
        worst_margin(packed_of({"simulation": {"mode": "sampled"}}), "A")
    )


def advice_by_path(
    document: dict[str, Any], lane: dict[str, Any] | None = None
) -> dict[str, Advice]:
    return {note.path: note for note in advice_on(packed_of(document, lane), "A")}


SAMPLED = {"simulation": {"mode": "sampled"}}
THIN = [0.01, 0.01, 0.01, 0.02, 0.02, 0.02]
THIN_SIGN = {**CHATTERING, "switching": "sign"}
RATING = [150, 150, 150, 28, 28, 28]
LIMITED = {**DATASHEET, "torque_limit": RATING}
WEAK = {"armature": 0.5, "torque_limit": RATING}
AT_REST = {"simulation": {"initial_velocity": "rest"}}
NOISES = ("position", "velocity")
DELAYED = {"simulation": {"input_delay": 0.001}, "robot": DATASHEET}
FAST = {
    "sine": {"amplitude": 5.0, "frequency": 100.0},
    "noise": {"amplitude": [0, 0, 0, 0, 0, 1.0], "bandwidth": 180.0},
}
COARSE = {"simulation": {"mode": "sampled", "control_rate": 200.0, "plant_substeps": 2}}
SLOW = {"law": "smc", "k1": 5.0, "k2": 1.0, "epsilon": 1.0}
PROPOSALS: list[tuple[str, dict[str, Any], dict[str, Any]]] = [
    ("lanes.A.epsilon", {**SAMPLED, "robot": DATASHEET}, {**CHATTERING, "epsilon": 0.01}),
    ("lanes.A.epsilon", {**SAMPLED, "robot": DATASHEET}, {**CHATTERING, "epsilon": THIN}),
    ("lanes.A.switching", {**SAMPLED, "robot": DATASHEET}, {**CHATTERING, "switching": "sign"}),
    ("lanes.A.switching", {**SAMPLED, "robot": DATASHEET}, {**THIN_SIGN, "epsilon": 0.001}),
    ("simulation.control_rate", {**SAMPLED, "robot": DATASHEET}, {**CHATTERING, "k1": 300}),
    ("lanes.A.nu", {}, {"law": "rbfnn_nftsm"}),
    ("lanes.A.nu", {"simulation": {"horizon": 120}}, {"law": "nftsm", "nu": 0.01, "c": 50}),
    ("lanes.A.lambda_", {}, {"law": "rbfnn_smc", "lambda_": 0.05}),
    ("lanes.A.kp", {}, {"law": "computed_torque", "kp": 2}),
    ("lanes.A.kp", {}, {"law": "computed_torque", "kp": 0}),
    ("lanes.A.width", {}, {"law": "rbfnn_nftsm", "width": 0.02}),
    ("lanes.A.leakage", {"robot": WEAK}, {"law": "rbfnn_nftsm"}),
    ("robot.torque_limit", {"robot": WEAK}, {"law": "nftsm"}),
    ("robot.torque_limit", {"robot": {**WEAK, "torque_limit": 100}}, {"law": "nftsm"}),
    ("robot.torque_limit", {"robot": LIMITED, **AT_REST}, {"law": "rbfnn_nftsm"}),
    ("disturbance.sine.frequency", {"disturbance": FAST, "simulation": {"step": 0.005}}, SLOW),
    ("disturbance.noise.bandwidth", {"disturbance": FAST}, SLOW),
    ("disturbance.noise.bandwidth", {"disturbance": FAST, **COARSE, "robot": DATASHEET}, SLOW),
    ("simulation.input_delay", DELAYED, {"law": "computed_torque"}),
]


def test_sign_is_said_to_chatter_where_it_is_sampled_and_only_there() -> None:
    sign = {**CHATTERING, "switching": "sign"}
    assert "lanes.A.switching" in advice_by_path({**SAMPLED, "robot": DATASHEET}, sign)
    assert "lanes.A.switching" not in advice_by_path({"robot": DATASHEET}, sign)


@pytest.mark.parametrize(("path", "document", "lane"), PROPOSALS)
def test_a_note_proposes_what_removes_it(
    path: str, document: dict[str, Any], lane: dict[str, Any]
) -> None:
    note = advice_by_path(document, lane)[path]
    assert note.patch is not None
    better = packed_of(document, lane).experiment.patched(note.patch)
    assert path not in {other.path for other in advice_on(pack(better), "A")}


@pytest.mark.parametrize(
    "document",
    [
        {
            "simulation": {"mode": "sampled", "horizon": 120, "control_rate": 100},
            "robot": {"armature": 0.5},
        },
        {"simulation": {"horizon": 120}, "robot": {"torque_limit": 100}},
        {"simulation": {"mode": "sampled", "input_delay": 0.05}},
        {"simulation": {"mode": "sampled", "horizon": 20, "control_rate": 10_000}},
    ],
)
@pytest.mark.parametrize(
    "lane", [{"law": "rbfnn_nftsm", "width": 0.02, "nu": 0.01, "c": 50}, CHATTERING]
)
def test_every_proposal_is_one_that_the_experiment_takes(
    document: dict[str, Any], lane: dict[str, Any]
) -> None:
    packed = packed_of(document, lane)
    found = advice_on(packed, "A")
    for note in found:
        assert note.message
        if note.patch is not None:
            steps = packed.experiment.patched(note.patch).simulation
            assert steps.horizon / steps.row_period <= MAX_STEPS


def test_saturation_at_the_start_is_told_with_the_joint() -> None:
    document = {
        "robot": {"torque_limit": [150, 150, 150, 28, 28, 28], "armature": 1.0},
        "simulation": {"initial_velocity": "rest"},
    }
    note = advice_by_path(document)["robot.torque_limit"]
    assert note.level == "info"
    assert "28 N·m" in note.message
    assert "joint 4" in note.message or "joint 5" in note.message or "joint 6" in note.message


def test_nothing_is_said_of_numbers_that_are_good() -> None:
    assert not advice_by_path({}, {"law": "smc"})
    good = {"robot": DATASHEET, "simulation": {"mode": "sampled"}}
    assert not advice_by_path(good, CHATTERING)


def test_delay_is_named_where_it_makes_the_difference() -> None:
    lane = {"law": "computed_torque", "kp": 2000.0, "kd": 300.0}
    slow = {"mode": "sampled", "control_rate": 200.0}
    assert not advice_by_path({"simulation": slow}, lane)
    note = advice_by_path({"simulation": {**slow, "input_delay": 0.005}}, lane)[
        "simulation.control_rate"
    ]
    assert note.level == "warning"
    assert "γ = 1.5" in note.message
    assert "the limit of this loop with this delay is 0.9" in note.message


def test_the_proposed_layer_is_hardly_wider_than_it_must_be() -> None:
    document = {"robot": DATASHEET, **SAMPLED}
    for epsilon in (0.001, 0.01, THIN):
        packed = packed_of(document, {**CHATTERING, "epsilon": epsilon})
        wide = sufficient_layer(packed, "A")
        assert wide is not None
        assert np.shape(wide) == np.shape(epsilon)
        for share, stable in ((1.0, True), (0.85, False)):
            patch = {"lanes": {"A": {"epsilon": np.multiply(share, wide).tolist()}}}
            assert is_stable(pack(packed.experiment.patched(patch)), "A") == stable


def test_no_layer_is_proposed_where_the_proportional_gain_is_the_trouble() -> None:
    document = {"robot": DATASHEET, **SAMPLED}
    assert sufficient_layer(packed_of(document, {**CHATTERING, "k1": 300}), "A") is None
    assert "lanes.A.epsilon" not in advice_by_path(document, {**CHATTERING, "k1": 300})


def test_a_network_winds_up_by_as_much_a_second_as_is_told() -> None:
    document = {
        "robot": {**DATASHEET, "torque_limit": 10.0},
        "trajectory": {"kind": "hold"},
        "simulation": {"mode": "sampled", "horizon": 0.2, "initial_error": 0.3},
    }
    lane = {**CHATTERING, "learning_rate": 20}
    note = advice_by_path(document, lane)["lanes.A.leakage"]
    told = float(note.message.split("= ")[2].split(" N·m")[0])
    joint = int(note.message.split("joint ")[1].split()[0]) - 1
    run = simulate(packed_of(document, lane).experiment).lanes["A"]
    assert abs(run.f[5, joint] - run.f[0, joint]) / 0.005 == pytest.approx(told, rel=0.05)


def test_settings_of_sampled_mode_are_told_of_in_continuous_mode_alone() -> None:
    noise = {"disturbance": {"sensor_noise": {"position": 1e-5, "velocity": 1e-3}}}
    paths = {"simulation.input_delay", *(f"disturbance.sensor_noise.{x}" for x in NOISES)}
    lane = {"law": "computed_torque"}
    assert paths == set(advice_by_path({**DELAYED, **noise}, lane))
    sampled = {"simulation": {"mode": "sampled", "input_delay": 0.001}}
    assert not advice_by_path({**noise, **sampled, "robot": DATASHEET}, lane)


def test_sampled_mode_is_not_proposed_where_it_would_diverge() -> None:
    document = {"simulation": {"input_delay": 0.001}}
    assert advice_by_path(document, {"law": "smc"})["simulation.input_delay"].patch is None


@pytest.mark.parametrize(("p", "k"), [(3, 3), (7, 3), (3, 5)])
def test_an_exponent_outside_its_bounds_is_refused_with_the_bounds(p: int, k: int) -> None:
    with pytest.raises(InvalidExperimentError, match="between 1 and 2") as refused:
        packed_of({}, {"law": "nftsm", "p": p, "k": k})
    assert [field.path for field in refused.value.fields] == ["lanes.A.p"]


def test_a_disturbance_that_the_steps_follow_is_not_told() -> None:
    slow = {"sine": {"amplitude": 5.0, "frequency": 10.0}, "noise": {"amplitude": 1.0}}
    assert not advice_by_path({"disturbance": slow}, SLOW)
    # Without a torque its frequency is nobody's business.
    still = {"sine": {"amplitude": 0.0, "frequency": 100.0}}
    assert not advice_by_path({"disturbance": still}, SLOW)
