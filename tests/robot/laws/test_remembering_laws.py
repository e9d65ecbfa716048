"""Super-twisting, integral and adaptive sliding mode: what each of them promises."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import R_S, W
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.margins.margin import loop_margin
from tests.reference.arm import arm
from tests.robot.laws.plain_loops import PlainLoop

Array = np.ndarray
NEW = ["super_twisting", "integral_smc", "adaptive_smc"]
MODES: dict[str, dict[str, Any]] = {
    "continuous": {"mode": "continuous"},
    "sampled": {"mode": "sampled", "control_rate": 1000.0, "plant_substeps": 4},
}


def experiment(lane: dict[str, Any], mode: str = "continuous", **changes: Any) -> Experiment:
    simulation = {"horizon": 2.0, **MODES[mode], **changes.pop("simulation", {})}
    return Experiment.from_document(
        {"robot": {"armature": 0.3}, "lanes": {"A": lane}, "simulation": simulation, **changes}
    )


def run(lane: dict[str, Any], mode: str = "continuous", **changes: Any) -> LaneRun:
    return simulate(experiment(lane, mode, **changes)).lanes["A"]


def memory_along(asked: Experiment) -> Array:
    """Return the first row of the memory at each step. Shape (n, 6)."""
    loop, rows = ClosedLoop(pack(asked), 8), []
    for _ in range(round(asked.simulation.horizon / loop.period) + 1):
        rows.append(loop.lanes["A"].work[W].copy())
        loop.step()
    return np.array(rows)


def drawn(law: str, seed: int, **fixed: Any) -> dict[str, Any]:
    dice = np.random.default_rng(seed)

    def each(low: float, high: float) -> list[float]:
        return [float(value) for value in np.exp(dice.uniform(np.log(low), np.log(high), JOINTS))]

    if law == "super_twisting":
        lane = {"k1": each(1, 30), "k2": each(10, 300), "z_max": each(2, 40)}
        return {"law": law, "lambda_": each(2, 20), **lane}
    lane = {"k1": each(1, 20), "k2": each(10, 60), "epsilon": each(0.1, 1.0)}
    lane["switching"] = str(dice.choice(["tanh", "saturation"]))
    if law == "integral_smc":
        return {"law": law, "kp": each(50, 900), "kd": each(5, 60), **lane, **fixed}
    lane |= {"k2_min": each(0.5, 5), "adaptation_rate": each(50, 2000), "lambda_": each(2, 20)}
    return {"law": law, **lane, **fixed}


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("law", NEW)
def test_a_sampled_loop_is_the_one_that_is_written_anew(law: str, seed: int) -> None:
    dice = np.random.default_rng(100 + seed)
    disturbance = {"constant": dice.uniform(-8, 8, JOINTS).tolist(), "nominal_mismatch": 0.9}
    asked = experiment(
        drawn(law, seed),
        "sampled",
        disturbance=disturbance,
        simulation={"horizon": 0.3, "initial_error": 0.05},
    )
    q, tau, memory, _ = PlainLoop(asked.document()).sampled()
    found = simulate(asked).lanes["A"]
    np.testing.assert_allclose(found.q, q, atol=1e-9)
    np.testing.assert_allclose(found.tau, tau, rtol=1e-6, atol=1e-6)
    # Before the first step nothing is remembered.
    np.testing.assert_allclose(memory_along(asked)[1:], memory[1:], rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("law", ["integral_smc", "adaptive_smc"])
def test_a_continuous_loop_is_the_solution_of_its_equations(law: str, seed: int) -> None:
    dice = np.random.default_rng(200 + seed)
    disturbance = {"constant": dice.uniform(-8, 8, JOINTS).tolist(), "nominal_mismatch": 0.9}
    # Where S crosses its layer the rate of the adapted gain jumps: slowly, that is smooth enough.
    slow = {"adaptation_rate": 30.0} if law == "adaptive_smc" else {}
    asked = experiment(
        drawn(law, seed, switching="tanh", **slow),
        disturbance=disturbance,
        simulation={"horizon": 0.5, "initial_error": 0.05, "step": 0.0005},
    )
    found = simulate(asked).lanes["A"]
    times = np.arange(0.0, 0.501, 0.05)
    exact = PlainLoop(asked.document()).continuous(times)
    np.testing.assert_allclose(found.q[::100], exact[:, :JOINTS], atol=5e-5)
    memory = memory_along(asked)[::100]
    known = exact[:, JOINTS : 2 * JOINTS]
    np.testing.assert_allclose(memory[1:], known[1:], atol=2e-3 * np.abs(known).max())


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("law", NEW)
def test_default_gains_reach_the_surface_and_stay(law: str, mode: str) -> None:
    for preset in ("paper", "realistic"):
        document = load_preset(preset).document()
        document["lanes"] = {"A": {"law": law}}
        document["simulation"].update(**MODES[mode], horizon=4.0, initial_error=0.02)
        found = simulate(Experiment.from_document(document)).lanes["A"]
        assert found.freeze is None
        assert found.accuracy.unconverged == 0
        late = found.S[len(found.S) // 2 :]
        assert np.abs(late).max() < {"super_twisting": 0.1, "integral_smc": 0.2}.get(law, 0.3)
        assert np.abs(found.e[-1]).max() < 0.04


@pytest.mark.parametrize("mode", MODES)
def test_super_twisting_reaches_and_its_integral_balances_the_disturbance(mode: str) -> None:
    constant = [8.0, -8.0, 4.0, 2.0, -2.0, 1.0]
    asked = experiment(
        {"law": "super_twisting"},
        mode,
        disturbance={"constant": constant},
        simulation={"horizon": 2.0, "initial_error": 0.05},
    )
    found, memory = simulate(asked).lanes["A"], memory_along(asked)
    room = {"continuous": 1e-5, "sampled": 2e-3}[mode]
    assert np.abs(found.S[0]).min() > 0.2
    assert np.abs(found.S[1500:]).max() < room
    model = arm(asked.document()["robot"])
    M = pin.crba(model, model.createData(), found.q[-1])
    M = np.triu(M) + np.triu(M, 1).T
    needed = np.linalg.solve(M, constant)
    # Explicitly sampled it swings by a few times T k2.
    np.testing.assert_allclose(memory[-1], needed, atol={"continuous": 1e-2, "sampled": 0.5}[mode])
    np.testing.assert_allclose(found.f[-1], M @ memory[-1], atol=1e-9)


def test_super_twisting_does_not_feel_a_matched_disturbance() -> None:
    swing = {"sine": {"amplitude": 5.0, "frequency": 1.0}}
    for lane, most in (
        ({"law": "super_twisting"}, 2e-6),
        ({"law": "super_twisting", "k2": 0.0}, 1),
    ):
        start = {"initial_error": 0.0}
        calm = run(lane, simulation=start)
        moved = run(lane, simulation=start, disturbance=swing)
        apart = np.abs(moved.q - calm.q)[1000:].max()
        assert apart < most
    assert apart > 1e-4  # without its integral


def test_the_torque_of_super_twisting_is_continuous() -> None:
    disturbance = {"constant": 5.0, "sine": {"amplitude": 5.0, "frequency": 1.0}}
    found = {}
    for name, lane in (
        ("twisting", {"law": "super_twisting"}),
        ("sign", {"law": "integral_smc", "switching": "sign", "k1": 0.0, "k2": 20.0}),
    ):
        found[name] = run(lane, "sampled", disturbance=disturbance)
    varied = {
        name: np.abs(np.diff(one.tau[1000:], axis=0)).sum(axis=0) for name, one in found.items()
    }
    assert (varied["twisting"] < 0.1 * varied["sign"]).all()
    for name in ("S", "e"):
        most = {key: np.abs(getattr(one, name)[1000:]).max() for key, one in found.items()}
        assert most["twisting"] < most["sign"]


def test_the_integral_of_super_twisting_stops_at_its_bound() -> None:
    asked = experiment(
        {"law": "super_twisting", "z_max": 3.0}, "sampled", disturbance={"constant": 30.0}
    )
    assert np.abs(memory_along(asked)).max() == 3.0


@pytest.mark.parametrize("mode", MODES)
def test_integral_sliding_mode_has_no_reaching_phase(mode: str) -> None:
    start = {"initial_error": 0.3, "initial_velocity": "rest"}
    found = run({"law": "integral_smc"}, mode, simulation=start)
    assert np.abs(found.e[0]).min() > 0.29
    assert not found.S[0].any()
    assert np.abs(found.S).max() < {"continuous": 1e-3, "sampled": 0.02}[mode]
    # From the first moment on the error obeys its own equation.
    times = np.arange(len(found.e)) * 1e-3
    s, e0, de0 = 20.0, found.e[0], found.de[0]
    exact = (e0 + (de0 + s * e0) * times[:, None]) * np.exp(-s * times[:, None])
    assert np.abs(found.e - exact).max() < {"continuous": 1e-4, "sampled": 1e-2}[mode]


def test_integral_sliding_mode_does_not_feel_a_matched_disturbance_within_its_bound() -> None:
    sine = {"amplitude": 4.0, "frequency": 1.0}
    start = {"initial_error": 0.1}

    def apart(**gains: Any) -> float:
        lane = {"law": "integral_smc", "switching": "sign", "k1": 0.0, **gains}
        calm = run(lane, simulation=start)
        return float(
            np.abs(run(lane, simulation=start, disturbance={"sine": sine}).q - calm.q).max()
        )

    assert apart(k2=30.0) < 1e-5
    assert apart(k2=1.0) > 1e-3


@pytest.mark.parametrize("mode", MODES)
def test_integral_sliding_mode_begins_anew_after_a_reset_and_a_change_of_law(mode: str) -> None:
    asked = experiment({"law": "smc", "k1": 20.0, "k2": 5.0}, mode, disturbance={"constant": 5.0})
    loop = ClosedLoop(pack(asked), 8)
    for _ in range(50):
        loop.step()
    loop.adopt(pack(asked.patched({"lanes": {"A": {"law": "integral_smc"}}})))
    for begin in (lambda: None, loop.restart, lambda: loop.restart_lane("A")):
        begin()
        loop.step()
        lane = loop.lanes["A"]
        assert not lane.record[(loop.number - 1) % 8, R_S].any()
        for _ in range(30):
            loop.step()
        assert np.abs(lane.record[(loop.number - 1) % 8, R_S]).max() > 0.0


@pytest.mark.parametrize("switching", ["tanh", "sign"])
def test_an_adapted_gain_grows_as_far_as_needed_and_falls_back(switching: str) -> None:
    pulse = {"amplitude": 12.0, "start": 0.5, "duration": 1.0}
    swing = {"amplitude": 0.3, "frequency": 5.0}
    lane = {"law": "adaptive_smc", "k1": 0.0, "adaptation_rate": 2000.0, "switching": switching}
    asked = experiment(
        lane, "sampled", disturbance={"pulse": pulse, "sine": swing}, simulation={"horizon": 4.0}
    )
    gain = np.maximum(memory_along(asked), 1.0)
    assert gain.min() == 1.0
    assert gain.max() <= 200.0
    assert gain[1400].max() > 8.0
    assert (gain[-1] < 0.6 * gain[1400]).any()
    sliding = np.abs(run(lane, "sampled", disturbance={"pulse": pulse}).S)
    assert sliding[500:700].max() > 0.5
    assert sliding[1200:1500].max() < 0.3


def test_an_adapted_gain_stays_within_its_bounds() -> None:
    for bounds in ({"k2_min": 2.0, "k2": 5.0}, {"k2_min": 7.0, "k2": 5.0}):
        lane = {"law": "adaptive_smc", **bounds}
        for mode in MODES:
            asked = experiment(lane, mode, disturbance={"constant": 40.0})
            gain = memory_along(asked)[1:]
            assert gain.max() == pytest.approx(5.0)
            assert gain.min() >= min(bounds.values()) - 1e-12


def test_the_new_laws_keep_what_they_remember_in_their_own_rows() -> None:
    for law in NEW:
        loop = ClosedLoop(pack(experiment({"law": law})), 8)
        for _ in range(5):
            loop.step()
        used = np.flatnonzero(loop.lanes["A"].work[W : W + 10].any(axis=1))
        assert used.max() < LAWS[law].memory


@pytest.mark.parametrize("law", NEW)
def test_margins_see_the_law_as_it_has_begun(law: str) -> None:
    # By an exact model: deviations grow where gamma is above 2, or above 1 with a period of delay.
    for delay, limit in ((0.0, 2.0), (0.001, 1.0)):
        asked = experiment({"law": law}, "sampled", simulation={"input_delay": delay})
        margin = loop_margin(pack(asked), "A")
        assert margin.holds
        assert margin.limit == pytest.approx(limit, rel=0.08)
