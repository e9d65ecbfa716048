"""What an observer makes of a loop's swing and of its border, against loops that run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.lenses.prediction import look
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.margin import loop_margin
from slidetune.robot.margins.observer_path import ObserverPath, observer_path
from tests.robot.lenses.test_prediction import agrees, drawn
from tests.robot.margins.test_law_states import grows

Array = np.ndarray


@pytest.mark.parametrize("share", [0.05, 0.6, 1.0])
@pytest.mark.parametrize("omega", [8.0, 300.0, 2500.0])
def test_a_sampled_observer_is_the_recursion_that_it_stands_for(share: float, omega: float) -> None:
    random, period, count = np.random.default_rng(3), 0.001, 40_000
    inertia = random.normal(size=(JOINTS, JOINTS))
    bias = random.normal(size=(JOINTS, 2 * JOINTS))
    path = ObserverPath(inertia, bias, np.full(JOINTS, share / period), period)
    turn = np.exp(1j * omega * period)
    asked, state = random.normal(size=JOINTS), random.normal(size=2 * JOINTS)
    z = turn ** np.arange(count)
    r, u = np.zeros(JOINTS, complex), np.zeros((count, JOINTS), complex)
    last_v, undriven = state[JOINTS:] / turn, bias @ state / turn - asked / turn
    for k in range(count):
        v = state[JOINTS:] * z[k]
        r = r + share * (inertia @ (v - last_v) / period + undriven - r)
        u[k] = asked * z[k] - r
        last_v, undriven = v, bias @ state * z[k] - u[k]
    # What a start leaves in the sum stands still beside the swing.
    end = slice(count // 2, None)
    swings = np.stack([z[end], np.ones(count - count // 2)], axis=1)
    found = np.linalg.lstsq(swings, u[end], rcond=None)[0][0]
    factor, motion = (part[0] for part in path.passed(np.array([omega])))
    np.testing.assert_allclose(factor * asked + motion @ state, found, rtol=1e-6, atol=1e-6)


def test_without_a_period_it_is_an_integral_and_a_damping() -> None:
    inertia, rate = np.diag(np.arange(1.0, 7.0)), np.full(JOINTS, 30.0)
    bias = np.zeros((JOINTS, 2 * JOINTS))
    factor, motion = ObserverPath(inertia, bias, rate, 0.0).passed(np.array([50.0]))
    np.testing.assert_allclose(factor[0], 1.0 + 30.0 / 50.0j)
    np.testing.assert_allclose(motion[0][:, JOINTS:], -30.0 * inertia, atol=1e-12)
    np.testing.assert_allclose(motion[0][:, :JOINTS], 0.0)


def test_its_slopes_are_those_of_the_nominal_arm() -> None:
    lane = {"law": "smc", "observer": "momentum", "observer_rate": 20.0}
    disturbance = {"nominal_mismatch": 0.7}
    packed = pack(Experiment.from_document({"lanes": {"A": lane}, "disturbance": disturbance}))
    q, v, a = np.random.default_rng(5).uniform(-1.0, 1.0, (3, JOINTS))
    path, model = observer_path(packed, "A", (q, v, a)), packed.nominal
    assert path is not None
    assert model is not None
    data, step = model.createData(), 1e-6
    M = pin.crba(model, data, q).copy()
    np.testing.assert_allclose(path.inertia, np.triu(M) + np.triu(M, 1).T, rtol=1e-12)
    for joint in range(JOINTS):
        by = step * np.eye(JOINTS)[joint]
        over_q = pin.rnea(model, data, q + by, v, a) - pin.rnea(model, data, q - by, v, a)
        over_v = pin.rnea(model, data, q, v + by, a) - pin.rnea(model, data, q, v - by, a)
        for column, slope in ((joint, over_q), (JOINTS + joint, over_v)):
            np.testing.assert_allclose(path.bias[:, column], slope / (2.0 * step), atol=1e-5)


def observed(seed: int) -> Experiment:
    """A drawn loop whose lane has a momentum observer; two of eight in continuous mode."""
    random, document = np.random.default_rng(500 + seed), drawn(seed).document()
    law = ("smc", "nftsm", "integral_smc", "super_twisting")[seed % 4]
    lane: dict[str, Any] = {
        "law": law,
        "observer": "momentum",
        "observer_rate": float(random.uniform(5.0, 60.0)),
    }
    if law in ("smc", "nftsm"):
        share = random.uniform(0.4, 2.0)
        lane["k2"] = [share * k2 for k2 in (40.0, 40.0, 25.0, 5.0, 5.0, 5.0)]
        lane["k1"] = [10.0, 10.0, 6.0, 1.0, 1.0, 1.0]
        lane["switching"] = "sign"
        lane |= {"nu": 8.0, "c": 1.0, "mu": 0.05} if law == "nftsm" else {}
    elif law == "integral_smc":
        gains = {"k1": 5.0, "k2": float(random.uniform(5.0, 30.0)), "kp": 100.0, "kd": 20.0}
        lane |= {**gains, "switching": "sign"}
    document["lanes"] = {"A": lane}
    if seed % 8 in (1, 2):
        document["simulation"] |= {"mode": "continuous", "step": 0.0005}
        document["robot"]["lag_order"] = "second"
    return Experiment.from_document(document)


@pytest.mark.parametrize("seed", range(12))
def test_observed_loops_chatter_as_predicted(seed: int) -> None:
    experiment = observed(seed)
    run = simulate(experiment, estimate=False).lanes["A"]
    assert run.freeze is None
    view = look(pack(experiment), "A", run)
    assert view is not None
    assert all(agrees(joint, experiment.simulation.row_period) for joint in view.joints), view


@pytest.mark.parametrize("delay", [0.0, 0.002])
@pytest.mark.parametrize("rate", [20.0, 400.0])
def test_gamma_reaches_its_limit_where_the_observed_loop_begins_to_swing(
    rate: float, delay: float
) -> None:
    document = drawn(0).document()
    robot = {**document["robot"], "lag": 0.0, "viscous_friction": 0.0}
    simulation = {**document["simulation"], "control_rate": 1000.0, "plant_substeps": 4}
    simulation |= {"input_delay": delay, "initial_error": 1e-5}

    def loop(k1: float) -> Experiment:
        lane = {"law": "smc", "lambda_": 2.0, "k1": k1, "k2": 0.0, "observer_rate": rate}
        lanes = {"A": {**lane, "observer": "momentum"}}
        changed = {"robot": robot, "simulation": simulation, "lanes": lanes}
        return Experiment.from_document({**document, **changed})

    low, high = 1e-3, 1000.0
    for _ in range(14):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if grows(loop(middle)) else (middle, high)
    # Told of gains well below it: the limit is a matter of the gains' proportion alone.
    margin = loop_margin(pack(loop(0.4 * low)), "A")
    assert margin.gamma is not None
    assert margin.limit is not None
    assert margin.stable
    assert margin.limit / margin.gamma * 0.4 == pytest.approx(1.0, rel=0.04)
