"""Lenses agree with the run that they look at, and with the law's own kernel."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.laws import LAWS
from slidetune.robot.lenses import LENSES, chattering, look_through, sliding_mode
from slidetune.robot.lenses.probe import Probe
from slidetune.robot.lenses.screen import document, evenly_along, rounded
from slidetune.robot.loop.metrics import torque_spectrum
from slidetune.robot.loop.simulate import LaneRun, simulate

LANE = "A"
SAMPLED = {"mode": "sampled", "control_rate": 1000.0, "plant_substeps": 4}
SOFT = {
    "robot": {"inertials": "datasheet", "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15]},
    "lane": {
        "law": "rbfnn_nftsm",
        **{"nu": 10.0, "c": 1.0, "mu": 0.1, "epsilon": 0.03, "width": 0.3},
        "k1": [80, 80, 40, 8, 8, 8],
        "k2": [40, 40, 25, 5, 5, 5],
        "learning_rate": 20.0,
    },
}


def experiment(lane: dict[str, Any], **sections: Any) -> Experiment:
    simulation = {"horizon": 2.0, **sections.pop("simulation", {})}
    return Experiment.from_document({"lanes": {LANE: lane}, "simulation": simulation, **sections})


def ran(one: Experiment) -> tuple[Packed, LaneRun]:
    return pack(one), simulate(one).lanes[LANE]


@pytest.fixture(scope="module")
def terminal() -> tuple[Packed, LaneRun]:
    """A lane whose surface bends, with an error to begin with and a constant disturbance."""
    lane = {"law": "nftsm", "nu": 5.0, "c": 1.0, "mu": 2.0, "epsilon": 0.05}
    return ran(
        experiment(
            lane,
            simulation={
                "initial_error": [0.2, -0.1, 0.05, 0.1, 0.1, 0.1],
                "initial_velocity": "rest",
            },
            disturbance={"constant": [-22.5, -33.0, -20.0, 0.0, 0.0, 0.0]},
        )
    )


@pytest.fixture(scope="module")
def restless() -> tuple[Packed, LaneRun]:
    """A sampled lane that switches by sign(S)."""
    lane = {**SOFT["lane"], "switching": "sign"}
    return ran(experiment(lane, robot=SOFT["robot"], simulation=SAMPLED))


# --- the sliding-mode lens ---------------------------------------------------------------------


@pytest.mark.parametrize("law", list(LAWS))
def test_the_sliding_curve_is_where_the_law_itself_says_that_S_is_zero(law: str) -> None:
    packed = pack(experiment({"law": law}))
    de = np.linspace(-2.0, 2.0, 9)[:, None] * np.ones(6)
    e = sliding_mode.sliding_curve(packed, LANE, de)
    probe = Probe(packed, LANE)
    for error, rate in zip(e, de, strict=True):
        assert np.abs(probe.surface(error, rate)[0]).max() < 1e-12
    assert np.all(np.sign(e) == -np.sign(de))


def test_the_curve_of_the_paper_is_its_equation_5() -> None:
    packed = pack(experiment({"law": "nftsm", "nu": 2.0, "c": 3.0, "mu": 0.5}))
    de = np.full((1, 6), -0.4)
    expected = -(3.0 * -0.4 - 0.5 * 0.4 ** (5 / 3)) / 2.0
    assert sliding_mode.sliding_curve(packed, LANE, de) == pytest.approx(np.full((1, 6), expected))


def test_recorded_sliding_variables_are_those_of_the_probe(terminal: Any) -> None:
    packed, run = terminal
    probe = Probe(packed, LANE)
    for row in (0, 5, 50, 500, 2000):
        S = probe.surface(run.e[row], run.de[row])[0]
        assert pytest.approx(run.S[row], abs=1e-12) == S


def test_layer_lies_beside_the_curve_by_its_width(terminal: Any) -> None:
    packed, run = terminal
    view = sliding_mode.look(packed, LANE, run)
    probe = Probe(packed, LANE)
    for j, joint in enumerate(view.joints):
        e, de = np.zeros(6), np.zeros(6)
        e[j], de[j] = joint.curve_e[10] + joint.layer_width, joint.curve_de[10]
        assert probe.surface(e, de)[0][j] == pytest.approx(joint.layer)


def test_where_S_does_not_depend_on_the_error_there_is_no_curve_and_no_time_constant() -> None:
    lane = {"law": "computed_torque", "kp": [0.0, 400.0, 0.0, 400.0, 400.0, 400.0]}
    seen = look_through(experiment(lane, simulation={"horizon": 0.1}), LANE, ("sliding",))
    for j, joint in enumerate(seen["sliding"]["joints"]):
        known = j not in (0, 2)
        assert all((e is not None) == known for e in joint["curve_e"])
        assert (joint["time_constant"] is not None) == known
        assert (joint["layer_width"] is not None) == known


def test_every_point_of_the_path_is_a_row_of_the_run(terminal: Any) -> None:
    packed, run = terminal
    for j, joint in enumerate(sliding_mode.look(packed, LANE, run).joints):
        rows = np.searchsorted(run.time, joint.time)
        assert np.array_equal(joint.e, run.e[rows, j])
        assert np.array_equal(joint.de, run.de[rows, j])
        assert rows[0] == 0
        assert rows[-1] == len(run.time) - 1


def test_reaching_is_what_the_metrics_say_and_the_layer_holds_after_it(terminal: Any) -> None:
    packed, run = terminal
    view = sliding_mode.look(packed, LANE, run)
    assert tuple(joint.reaching_time for joint in view.joints) == run.metrics.reaching_time
    assert any(time for time in run.metrics.reaching_time)
    for j, joint in enumerate(view.joints):
        inside = np.abs(run.S[:, j]) <= run.layer[j]
        assert joint.inside == pytest.approx(inside.mean())
        if joint.last_outside is not None:
            assert inside[run.time > joint.last_outside].all()
    assert view.outside == pytest.approx(np.mean((np.abs(run.S) > run.layer).any(axis=1)))


def test_V_is_half_S_M_S_of_the_build_arm(terminal: Any) -> None:
    packed, run = terminal
    V = sliding_mode.energy(packed, run.q[::100], run.S[::100])
    for number, row in enumerate(range(0, len(run.q), 100)):
        M = pin.crba(packed.model, packed.model.createData(), run.q[row])
        assert V[number] == pytest.approx(0.5 * run.S[row] @ M @ run.S[row])
    assert np.all(V > 0.0)


def test_V_falls_outside_the_layer_where_the_gains_beat_the_disturbance() -> None:
    lane = {
        "law": "nftsm",
        "nu": 5.0,
        "c": 1.0,
        "epsilon": 0.02,
        "inertia_shaped": True,
        "k1": 2.0,
        "k2": 2.0,
    }
    start = {"initial_error": 0.2, "initial_velocity": "rest"}
    trajectory = {"kind": "hold"}
    view = sliding_mode.look(
        *_named(ran(experiment(lane, simulation=start, trajectory=trajectory)))
    )
    assert view.outside > 0.05
    assert view.growing_outside == 0.0
    assert view.V[0] > 1.0
    assert view.V[-1] < 1e-3 * view.V[0]


def _named(made: tuple[Packed, LaneRun]) -> tuple[Packed, str, LaneRun]:
    return made[0], LANE, made[1]


def test_derivative_of_V_integrates_to_its_change(terminal: Any) -> None:
    packed, run = terminal
    view = sliding_mode.look(packed, LANE, run)
    late = view.time > 0.5
    change = np.trapezoid(view.V_rate[late], view.time[late])
    assert change == pytest.approx(view.V[-1] - view.V[late][0], abs=0.1 * np.ptp(view.V[late]))


def test_V_turns_with_every_switch_and_seldom_without(terminal: Any, restless: Any) -> None:
    assert sliding_mode.look(*_named(restless)).turns > 100.0
    assert sliding_mode.look(*_named(terminal)).turns < 20.0


# --- the chattering lens -----------------------------------------------------------------------


def test_figures_are_those_of_the_metrics(restless: Any) -> None:
    packed, run = restless
    view, metrics = chattering.look(packed, LANE, run), run.metrics
    assert view.variation == metrics.chattering
    assert view.above == metrics.high_frequency_torque
    assert view.switches == pytest.approx(np.sum(metrics.switches))
    assert [joint.switches for joint in view.joints] == metrics.switches.tolist()
    assert view.mae == pytest.approx(np.mean(metrics.mae))
    assert sum(joint.variation for joint in view.joints) == pytest.approx(metrics.chattering)
    squares = sum(joint.above**2 for joint in view.joints if joint.above is not None)
    assert np.sqrt(squares) == pytest.approx(metrics.high_frequency_torque)


def test_sign_switches_and_spreads_to_high_frequencies_and_tanh_does_not(restless: Any) -> None:
    packed, run = restless
    smooth = packed.experiment.patched({"lanes": {LANE: {"switching": "tanh"}}})
    hard = chattering.look(packed, LANE, run)
    soft = chattering.look(*_named(ran(smooth)))
    assert hard.switches > 50.0 * soft.switches
    assert hard.above is not None
    assert soft.above is not None
    assert hard.above > 100.0 * soft.above


def test_a_sine_of_torque_stands_at_its_frequency_with_its_power(restless: Any) -> None:
    packed, run = restless
    torque = np.zeros_like(run.tau)
    torque[:, 2] = 3.0 * np.sin(2.0 * np.pi * 333.0 * run.time)
    view = chattering.look(packed, LANE, replace(run, tau=torque))
    peak = view.frequency[np.argmax(view.joints[2].density)]
    assert peak == pytest.approx(333.0, rel=0.03)
    _, power = torque_spectrum(torque, 0.001, 50.0) or (None, np.zeros((1, 6)))
    assert view.joints[2].density.max() == pytest.approx(np.sqrt(power.max()))
    assert view.joints[2].above == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-2)
    assert view.joints[0].above == pytest.approx(0.0, abs=1e-9)


def test_a_loop_too_slow_for_50_hz_has_no_spectrum_and_says_so() -> None:
    lane = {**SOFT["lane"], "switching": "tanh"}
    slow = {"mode": "sampled", "control_rate": 80.0, "horizon": 1.0}
    view = chattering.look(*_named(ran(experiment(lane, robot=SOFT["robot"], simulation=slow))))
    assert view.above is None
    assert all(joint.above is None for joint in view.joints)
    assert len(view.frequency) == 0


# --- all of them -------------------------------------------------------------------------------


@pytest.mark.parametrize("law", list(LAWS))
def test_every_law_has_a_strict_document(law: str) -> None:
    seen = look_through(experiment({"law": law}, simulation={"horizon": 0.5}), LANE)
    assert set(seen) == {"horizon", "frozen", *LENSES}
    assert json.loads(json.dumps(seen, allow_nan=False)) == seen
    estimates = LAWS[law].network or law == "super_twisting"
    assert (seen["network"] is not None) == estimates


def test_a_lane_that_diverges_is_shown_up_to_there() -> None:
    wild = experiment({"law": "rbfnn_nftsm"}, simulation={"mode": "sampled", "control_rate": 200.0})
    seen = look_through(wild, LANE)
    json.dumps(seen, allow_nan=False)
    assert seen["frozen"]["time"] < 2.0
    assert seen["frozen"]["cause"]
    assert seen["sliding"]["joints"][0]["time"][-1] <= seen["frozen"]["time"]


def test_only_the_lenses_asked_for_are_looked_through() -> None:
    one = experiment({"law": "smc"}, simulation={"horizon": 0.2})
    assert set(look_through(one, LANE, ["chattering"])) == {"horizon", "frozen", "chattering"}


def test_an_unknown_lane_is_refused_and_the_known_are_named() -> None:
    with pytest.raises(InvalidExperimentError, match="there are: A"):
        look_through(experiment({"law": "smc"}), "B")


# --- what fits a screen ------------------------------------------------------------------------


def test_points_lie_evenly_along_a_path_that_begins_fast() -> None:
    t = np.linspace(0.0, 10.0, 10_001)
    x, y = np.exp(-t / 0.01), np.zeros_like(t)
    rows = evenly_along(x, y, 100)
    assert len(rows) <= 100
    assert rows[0] == 0
    assert rows[-1] == 10_000
    assert np.abs(np.diff(x[rows])).max() < 0.12
    assert np.all(np.diff(rows) > 0)


@given(st.floats(-1e200, 1e200, allow_nan=False))
def test_rounding_keeps_six_digits(value: float) -> None:
    kept = float(rounded(np.array([value]))[0])
    assert kept == pytest.approx(value, rel=6e-6, abs=1e-290)


def test_what_is_no_number_becomes_none() -> None:
    assert document(np.array([1.0, np.nan, np.inf])) == [1.0, None, None]
    assert document({"a": float("nan"), "b": (np.float64(2.0), True, "x")}) == {
        "a": None,
        "b": [2.0, True, "x"],
    }
