"""Laws with a memory of their own beside an observer's: their loops, written anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import NODES
from slidetune.robot.laws import LAWS
from slidetune.robot.laws.terms.observer import OBSERVER_MEMORY
from slidetune.robot.loop.simulate import simulate
from tests.robot.laws.plain_loops import PlainLoop
from tests.robot.laws.test_remembering_laws import MODES, NEW, drawn, experiment, memory_along, run

Array = np.ndarray
OBSERVERS = ["momentum", "time_delay"]
HEAVY = {"constant": [8.0, -8.0, 4.0, 2.0, -2.0, 1.0]}


def lost(dice: np.random.Generator) -> dict[str, Any]:
    return {"constant": dice.uniform(-8, 8, JOINTS).tolist(), "nominal_mismatch": 0.9}


def observed(dice: np.random.Generator, observer: str) -> dict[str, Any]:
    rates = np.exp(dice.uniform(np.log(5), np.log(100), JOINTS))
    return {"observer": observer, "observer_rate": rates.tolist()}


def test_every_law_with_a_model_has_an_observer_and_room_for_it() -> None:
    for law in LAWS.values():
        assert ("observer" in law.lane.model_fields) == law.model_based
        if law.model_based:
            used = law.used_by(law.lane.model_validate({"observer": "momentum"}))
            assert used.memory == law.memory + OBSERVER_MEMORY <= NODES
            assert used.advance is not None


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("observer", OBSERVERS)
@pytest.mark.parametrize("law", NEW)
def test_a_sampled_loop_is_the_one_that_is_written_anew(law: str, observer: str, seed: int) -> None:
    dice = np.random.default_rng(300 + seed)
    asked = experiment(
        {**drawn(law, seed), **observed(dice, observer)},
        "sampled",
        disturbance=lost(dice),
        simulation={"horizon": 0.3, "initial_error": 0.05},
    )
    loop = PlainLoop(asked.document())
    q, tau, memory, estimate = loop.sampled()
    found = simulate(asked).lanes["A"]
    np.testing.assert_allclose(found.q, q, atol=1e-9)
    np.testing.assert_allclose(found.tau, tau, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(memory_along(asked)[1:], memory[1:], rtol=1e-6, atol=1e-7)
    forward = estimate
    if law == "super_twisting":  # z balances F, too
        forward = estimate + [
            loop.torque(0.0, pose, 0 * pose, z)[0] - loop.torque(0.0, pose, 0 * pose, 0 * z)[0]
            for pose, z in zip(q, memory, strict=True)
        ]
    assert np.abs(estimate[-1]).max() > 1.0
    np.testing.assert_allclose(found.f, forward, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("observer", OBSERVERS)
@pytest.mark.parametrize("law", NEW)
def test_a_continuous_loop_is_the_solution_of_its_equations(
    law: str, observer: str, seed: int
) -> None:
    dice = np.random.default_rng(400 + seed)
    # What jumps with S, the sign or the rate of the gain, is kept away from or slow.
    fixed: dict[str, Any] = {"switching": "tanh"}
    if law == "adaptive_smc":
        fixed["adaptation_rate"] = 30.0
    lane = {**drawn(law, seed, **fixed), **observed(dice, observer)}
    start = {"initial_error": 0.05}
    if law == "super_twisting":
        lane |= {"k1": 3.0, "k2": 10.0, "lambda_": 5.0}
        start = {"initial_error": 0.8}
    asked = experiment(
        lane, disturbance=lost(dice), simulation={"horizon": 0.1, "step": 0.0005, **start}
    )
    found = simulate(asked).lanes["A"]
    if law == "super_twisting":
        assert np.abs(found.S).min() > 0.1
    times = np.arange(0.0, 0.101, 0.025)
    exact = PlainLoop(asked.document()).continuous(times)
    # Between two steps time-delay estimation is late by one.
    room = {"momentum": 5e-5, "time_delay": 2e-4}[observer]
    np.testing.assert_allclose(found.q[::50], exact[:, :JOINTS], atol=room)
    if observer == "momentum" and law != "super_twisting":
        np.testing.assert_allclose(found.f[::50], exact[:, 2 * JOINTS :], atol=0.02)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("observer", OBSERVERS)
@pytest.mark.parametrize("law", NEW)
def test_a_steady_error_goes_away_and_the_estimate_to_what_is_lost(
    law: str, observer: str, mode: str
) -> None:
    gentle = {"k2_min": 1.0, "adaptation_rate": 0.0} if law == "adaptive_smc" else {}
    lane: dict[str, Any] = {"law": law, "k2": 1.0, **gentle}
    if law == "super_twisting":
        lane["k2"] = 0.0  # no integral: what is left is the observer
    still = {"trajectory": {"kind": "hold"}, "disturbance": HEAVY}
    start = {"initial_error": 0.0, "horizon": 2.0}
    plain = run(lane, mode, simulation=start, **still)
    with_one = run({**lane, "observer": observer}, mode, simulation=start, **still)
    # An integral of S has no steady error of the angle: there it is S.
    kind = "S" if law == "integral_smc" else "e"
    before, after = (np.abs(getattr(one, kind)[-100:]).max() for one in (plain, with_one))
    assert before > 1e-4
    assert after < 0.01 * before
    np.testing.assert_allclose(with_one.f[-1], HEAVY["constant"], atol=1e-2)


@pytest.mark.parametrize("mode", MODES)
def test_the_observer_comes_to_carry_what_the_integral_of_super_twisting_has_carried(
    mode: str,
) -> None:
    carried = {}
    for rate in (2.0, 200.0):
        lane = {"law": "super_twisting", "observer": "momentum", "observer_rate": rate}
        asked = experiment(lane, mode, disturbance=HEAVY, simulation={"horizon": 3.0})
        found, z = simulate(asked).lanes["A"], memory_along(asked)
        np.testing.assert_allclose(found.f[-500:].mean(axis=0), HEAVY["constant"], atol=0.1)
        carried[rate] = np.abs(z).max(), np.abs(z[-500:].mean(axis=0)).max()
    assert carried[2.0][0] > 2.0 * carried[200.0][0]
    for most, left in carried.values():
        assert left < 0.1 * most
