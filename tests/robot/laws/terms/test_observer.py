"""The disturbance observer: what it estimates, how fast, and what it is good for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.margins.margin import loop_margin

Array = np.ndarray

ARM = {"inertials": "datasheet", "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15]}
LOST = np.array([5.0, -4.0, 3.0, 1.0, -1.0, 0.5])
RATES = np.array([10.0, 20.0, 40.0, 15.0, 30.0, 60.0])
GAINS: dict[str, dict[str, Any]] = {
    "smc": {"lambda_": 10.0, "k1": [80, 80, 40, 8, 8, 8], "k2": 2.0, "epsilon": 0.2},
    "nftsm": {
        "nu": 10.0,
        "c": 1.0,
        "mu": 0.1,
        "inertia_shaped": True,
        "k1": 20.0,
        "k2": 2.0,
        "epsilon": 0.2,
    },
    "computed_torque": {},
    "integral_smc": {"kp": 100.0, "kd": 20.0, "k1": 20.0, "k2": 2.0, "epsilon": 0.2},
    "adaptive_smc": {"lambda_": 10.0, "k1": 20.0, "k2": 2.0, "k2_min": 0.5, "epsilon": 0.2},
    "super_twisting": {"lambda_": 10.0, "k1": 5.0, "k2": 0.0},
}
FORGETFUL = ("smc", "nftsm", "computed_torque")
"""Laws that remember nothing themselves. z of super-twisting is part of f: it is held at 0 here."""
SAMPLED = {"mode": "sampled"}
CONTINUOUS = {"mode": "continuous"}
Numbers = dict[str, Any]


def experiment(law: str, lane: Numbers, simulation: Numbers, **more: Any) -> Experiment:
    document: Numbers = {
        "robot": ARM,
        "lanes": {"A": {"law": law, **GAINS[law], **lane}},
        "disturbance": {"constant": LOST.tolist()},
        "simulation": {"horizon": 1.0, "initial_velocity": "desired", **simulation},
    }
    return Experiment.from_document({**document, **more})


def run(law: str, lane: Numbers, simulation: Numbers, **more: Any) -> LaneRun:
    return simulate(experiment(law, lane, simulation, **more), estimate=False).lanes["A"]


@pytest.mark.parametrize("law", GAINS)
@pytest.mark.parametrize(("simulation", "close"), [(SAMPLED, 8e-3), (CONTINUOUS, 2e-4)])
def test_estimate_goes_to_a_constant_loss_at_its_rate(
    law: str, simulation: Numbers, close: float
) -> None:
    lane = {"observer": "momentum", "observer_rate": RATES.tolist()}
    ran = run(law, lane, simulation)
    expected = LOST * (1.0 - np.exp(-RATES * ran.time[:, None]))
    assert np.abs((ran.f - expected) / LOST).max() < close


@pytest.mark.parametrize("law", GAINS)
@pytest.mark.parametrize("simulation", [SAMPLED, CONTINUOUS])
def test_time_delay_estimation_knows_the_loss_after_one_step(law: str, simulation: Numbers) -> None:
    ran = run(law, {"observer": "time_delay"}, simulation)
    assert not ran.f[0].any()
    assert np.abs((ran.f[1:] - LOST) / LOST).max() < 2e-2


def momentum_form(model: pin.Model, ran: LaneRun, rate: float, held: bool) -> Array:
    """Return r of the momentum form from what was logged, by the trapezoidal rule. Shape (n, 6)."""
    data, rows = model.createData(), len(ran.q)
    momentum, push = np.empty((rows, JOINTS)), np.empty((rows, JOINTS))
    for row in range(rows):
        q, v = ran.q[row], ran.v[row]
        M = pin.crba(model, data, q)
        momentum[row] = (np.triu(M) + np.triu(M, 1).T) @ v
        C = pin.computeCoriolisMatrix(model, data, q, v)
        push[row] = C.T @ v - pin.computeGeneralizedGravity(model, data, q)
    r, total, step = np.zeros((rows, JOINTS)), np.zeros(JOINTS), ran.time[1]
    for row in range(1, rows):
        torque = ran.tau[row - 1] if held else 0.5 * (ran.tau[row - 1] + ran.tau[row])
        total = total + step * (torque + 0.5 * (push[row - 1] + push[row]) + 0.5 * r[row - 1])
        r[row] = rate * (momentum[row] - momentum[0] - total) / (1.0 + 0.5 * step * rate)
        total = total + 0.5 * step * r[row]
    return r


@pytest.mark.parametrize(("simulation", "close"), [(SAMPLED, 0.05), (CONTINUOUS, 0.01)])
def test_estimate_is_that_of_the_momentum_form_with_the_coriolis_matrix(
    simulation: Numbers, close: float
) -> None:
    swung = {"sine": {"amplitude": [6, 6, 4, 1, 1, 1], "frequency": 2.0}}
    lane = {"observer": "momentum", "observer_rate": 25.0}
    asked = experiment("nftsm", lane, simulation, disturbance=swung)
    ran = simulate(asked, estimate=False).lanes["A"]
    expected = momentum_form(pack(asked).model, ran, 25.0, simulation is SAMPLED)
    assert np.abs(expected).max() > 4.0
    assert np.abs(-ran.f - expected).max() < close


def test_momentum_form_is_met_the_better_the_faster_it_is_sampled() -> None:
    apart = []
    for rate in (500.0, 1000.0, 2000.0):
        lane = {"observer": "momentum", "observer_rate": 25.0}
        asked = experiment("nftsm", lane, {**SAMPLED, "control_rate": rate, "horizon": 0.5})
        ran = simulate(asked, estimate=False).lanes["A"]
        expected = momentum_form(pack(asked).model, ran, 25.0, held=True)
        apart.append(float(np.abs(-ran.f - expected).max()))
    assert apart[1] / apart[0] == pytest.approx(0.5, abs=0.1)
    assert apart[2] / apart[1] == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("observer", ["momentum", "time_delay"])
@pytest.mark.parametrize("simulation", [SAMPLED, CONTINUOUS])
def test_with_a_tenth_of_k2_the_steady_error_is_a_tenth_or_less(
    observer: str, simulation: Numbers
) -> None:
    long = {**simulation, "horizon": 2.0}
    without = np.abs(run("nftsm", {"k2": 20.0}, long).e[-200:]).max()
    observed = np.abs(run("nftsm", {"k2": 2.0, "observer": observer}, long).e[-200:]).max()
    assert observed < 0.1 * without


@pytest.mark.parametrize(("mismatch", "stable"), [(0.5, True), (1.9, True), (2.1, False)])
def test_time_delay_estimation_holds_as_long_as_the_model_is_less_than_twice_too_heavy(
    mismatch: float, stable: bool
) -> None:
    # Without rotor inertia the nominal M is so many times the true one: ||I - M^-1 M|| = |1 - s|.
    more = {
        "robot": {"inertials": "datasheet"},
        "trajectory": {"kind": "hold"},
        "disturbance": {"constant": 1.0, "nominal_mismatch": mismatch},
    }
    lane = {"observer": "time_delay", "k1": 5.0, "k2": 0.0, "nu": 2.0, "mu": 0.0}
    asked = experiment("nftsm", lane, SAMPLED, **more)
    model, nominal = pack(asked).model, pack(asked).nominal
    assert nominal is not None
    q = np.array(asked.trajectory.position)
    M, M_nominal = (pin.crba(one, one.createData(), q) for one in (model, nominal))
    apart = np.eye(JOINTS) - np.linalg.solve(M, M_nominal)
    assert (np.abs(np.linalg.eigvals(apart)).max() < 1.0) == stable
    assert loop_margin(pack(asked), "A").stable == stable
    ran = simulate(asked, estimate=False).lanes["A"]
    assert (ran.freeze is None) == stable


@pytest.mark.parametrize("simulation", [SAMPLED, CONTINUOUS])
def test_with_super_twisting_estimate_and_integral_share_the_loss(simulation: Numbers) -> None:
    lane = {"observer": "momentum", "observer_rate": 5.0, "k1": 15.0, "k2": 110.0}
    ran = run("super_twisting", lane, {**simulation, "horizon": 2.0})
    # Sampled, z goes up and down by T k2 a period.
    assert np.abs((ran.f[-400:].mean(axis=0) - LOST) / LOST).max() < 0.02
    alone = run("super_twisting", {"k1": 15.0, "k2": 110.0}, {**simulation, "horizon": 2.0})
    assert np.abs((alone.f[-400:].mean(axis=0) - LOST) / LOST).max() < 0.02


@pytest.mark.parametrize("law", sorted(set(GAINS) - {"nftsm"}))
def test_margin_of_every_observed_law_tells_whether_it_settles(law: str) -> None:
    told = set()
    for mismatch, delay in ((0.7, 0.0), (1.0, 1e-3), (2.8, 0.0)):
        lane = {"observer": "momentum", "observer_rate": 1500.0}
        disturbance = {"constant": 1.0, "nominal_mismatch": mismatch}
        simulation = {**SAMPLED, "input_delay": delay}
        asked = experiment(law, lane, simulation, disturbance=disturbance)
        stable = loop_margin(pack(asked), "A").stable
        diverged = simulate(asked, estimate=False).lanes["A"].freeze is not None
        if law == "super_twisting":
            assert diverged <= (not stable)  # it swings a little wherever something comes late
        else:
            assert diverged == (not stable), mismatch
        told.add(diverged)
    assert told == {True, False}


@pytest.mark.parametrize("observer", ["momentum", "time_delay"])
def test_margin_of_an_observed_loop_tells_whether_it_settles(observer: str) -> None:
    told = set()
    for mismatch, delay in ((0.7, 0.0), (1.6, 0.0), (2.8, 0.0), (1.0, 1e-3), (1.6, 1e-3)):
        lane = {"observer": observer, "observer_rate": 1500.0, "k2": 0.0}
        disturbance = {"constant": 1.0, "nominal_mismatch": mismatch}
        simulation = {**SAMPLED, "input_delay": delay}
        asked = experiment("nftsm", lane, simulation, disturbance=disturbance)
        stable = loop_margin(pack(asked), "A").stable
        assert (simulate(asked, estimate=False).lanes["A"].freeze is None) == stable, mismatch
        told.add(stable)
    assert told == {True, False}


@pytest.mark.parametrize("simulation", [SAMPLED, CONTINUOUS])
def test_a_torque_limit_does_not_wind_it_up(simulation: Numbers) -> None:
    # Too weak to hold its pose, the arm sinks against its friction: what is lost stays known.
    more = {"robot": {**ARM, "torque_limit": 20.0, "viscous_friction": 40.0}}
    lane = {"observer": "momentum", "observer_rate": 50.0}
    ran = run("nftsm", lane, simulation, **more, trajectory={"kind": "hold"})
    assert (np.abs(ran.tau[-1]) >= 20.0 - 1e-9).any()
    lost = LOST + 40.0 * ran.v
    assert np.abs(ran.f[-200:] - lost[-200:]).max() < 2.0


@pytest.mark.parametrize("observer", ["momentum", "time_delay"])
@pytest.mark.parametrize("simulation", [SAMPLED, CONTINUOUS])
def test_it_takes_the_velocity_of_the_start_for_no_loss(observer: str, simulation: Numbers) -> None:
    nothing = {"disturbance": {"constant": 0.0}}
    ran = run("nftsm", {"observer": observer}, simulation, **nothing)
    assert np.abs(ran.v[0]).max() > 0.5
    assert np.abs(ran.f).max() < 0.05


@pytest.mark.parametrize("law", FORGETFUL)
@pytest.mark.parametrize("simulation", [SAMPLED, CONTINUOUS])
def test_without_it_nothing_is_remembered_and_its_rate_does_nothing(
    law: str, simulation: Numbers
) -> None:
    one, other = (run(law, {"observer_rate": rate}, simulation) for rate in (5.0, 500.0))
    for name in ("q", "v", "tau", "S", "f", "weights"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert not one.f.any()
    lane = LAWS[law].lane
    assert LAWS[law].used_by(lane()).advance is None
    assert LAWS[law].used_by(lane.model_validate({"observer": "momentum"})).advance is not None


@pytest.mark.parametrize("law", GAINS)
def test_what_it_remembers_is_not_recorded_as_weights(law: str) -> None:
    ran = run(law, {"observer": "momentum"}, SAMPLED)
    assert not ran.weights.any()
    assert not ran.final_weights.any()
