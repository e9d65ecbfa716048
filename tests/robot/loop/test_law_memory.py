"""What a law remembers beside the motion: how a lane keeps it, forgets it and brings it back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.workspace import NETWORK, NODES, R_F, W
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.simulate import simulate

OBSERVED = {"law": "smc", "lambda_": 10, "k1": 8, "k2": 5, "epsilon": 0.5, "observer": "momentum"}
REMEMBERING = ["super_twisting", "integral_smc", "adaptive_smc"]
MODES = ["continuous", "sampled"]


def document(lane: dict[str, Any], mode: str) -> dict[str, Any]:
    return {
        "robot": {"armature": 0.3},
        "lanes": {"A": lane},
        "disturbance": {"constant": 2.0},
        "simulation": {"mode": mode, "horizon": 0.2, "initial_velocity": "desired"},
    }


def loop_of(lane: dict[str, Any], mode: str, steps: int) -> ClosedLoop:
    loop = ClosedLoop(pack(Experiment.from_document(document(lane, mode))), 512)
    for _ in range(steps):
        loop.step()
    return loop


def change(loop: ClosedLoop, patch: dict[str, Any]) -> None:
    loop.adopt(pack(loop.packed.experiment.patched(patch)))


@pytest.mark.parametrize("mode", MODES)
def test_what_an_observer_remembers_does_not_become_weights_of_a_network(mode: str) -> None:
    loop = loop_of(OBSERVED, mode, 50)
    work = loop.lanes["A"].work
    assert work[W : W + NODES].any()
    change(loop, {"lanes": {"A": {"law": "rbfnn_smc"}}})
    assert not work[W : W + NODES].any()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("before", [{"law": "rbfnn_smc", "width": 1.0}, {"law": "nftsm"}])
def test_an_observer_that_is_switched_on_begins_with_no_estimate(
    before: dict[str, Any], mode: str
) -> None:
    loop = loop_of({**before, "k1": 8, "k2": 5}, mode, 50)
    law = "smc" if before["law"] == "rbfnn_smc" else before["law"]
    change(loop, {"lanes": {"A": {"law": law, "observer": "momentum"}}})
    loop.step()
    assert not loop.lanes["A"].record[50, R_F].any()
    for _ in range(100):
        loop.step()
    assert (loop.lanes["A"].work[NETWORK] > 1.0).all()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("law", REMEMBERING)
def test_a_law_with_a_memory_of_its_own_keeps_it_when_its_observer_is_switched(
    law: str, mode: str
) -> None:
    own = LAWS[law].memory
    loop = loop_of({"law": law}, mode, 50)
    work = loop.lanes["A"].work
    before = work[W : W + NODES].copy()
    assert before[:own].any()
    assert not before[own:].any()
    change(loop, {"lanes": {"A": {"observer": "momentum"}}})
    np.testing.assert_array_equal(work[W : W + NODES], before)
    for _ in range(20):
        loop.step()
    before = work[W : W + NODES].copy()
    assert before[own:].any()
    change(loop, {"lanes": {"A": {"observer": "none"}}})
    np.testing.assert_array_equal(work[W : W + own], before[:own])
    assert not work[W + own : W + NODES].any()


@pytest.mark.parametrize("observer", ["none", "momentum"])
@pytest.mark.parametrize("between", ["computed_torque", "smc", "rbfnn_smc", "nftsm"])
@pytest.mark.parametrize("law", REMEMBERING)
def test_no_law_finds_the_memory_that_it_once_left(law: str, between: str, observer: str) -> None:
    loop = loop_of({"law": law, "observer": observer}, "sampled", 50)
    assert loop.lanes["A"].work[W : W + NODES].any()
    for other in (between, law):
        change(loop, {"lanes": {"A": {"law": other}}})
        assert not loop.lanes["A"].work[W : W + NODES].any()
        if other == between:
            change(loop, {"disturbance": {"constant": 1.0}})


@pytest.mark.parametrize("mode", MODES)
def test_weights_go_on_behind_a_law_that_needs_none(mode: str) -> None:
    loop = loop_of({"law": "rbfnn_smc", "width": 1.0}, mode, 50)
    weights = loop.lanes["A"].work[W : W + NODES].copy()
    assert weights.any()
    change(loop, {"lanes": {"A": {"law": "computed_torque"}}})
    loop.step()
    change(loop, {"lanes": {"A": {"law": "rbfnn_nftsm"}}})
    np.testing.assert_array_equal(loop.lanes["A"].work[W : W + NODES], weights)


@pytest.mark.parametrize("law", ["smc", *REMEMBERING])
@pytest.mark.parametrize("mode", MODES)
def test_a_moment_of_the_past_is_repeated_to_the_last_bit(mode: str, law: str) -> None:
    lane = OBSERVED if law == "smc" else {"law": law, "observer": "momentum"}
    loop = loop_of(lane, mode, 40)
    past, record = loop.state(), loop.lanes["A"].record
    for _ in range(60):
        loop.step()
    first = record[:100].copy()
    loop.restore(past)
    for _ in range(60):
        loop.step()
    np.testing.assert_array_equal(record[:100], first)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("observer", ["momentum", "time_delay"])
def test_an_estimate_goes_on_in_the_other_mode(mode: str, observer: str) -> None:
    loop = loop_of({**OBSERVED, "observer": observer}, mode, 100)
    other = MODES[1 - MODES.index(mode)]
    change(loop, {"simulation": {"mode": other}})
    for _ in range(5):
        loop.step()
    estimate = loop.lanes["A"].record[90:105, R_F]
    assert np.abs(np.diff(estimate, axis=0)).max() < 0.15


@pytest.mark.parametrize("mode", MODES)
def test_a_memory_moved_on_in_plain_python_is_the_compiled_one(
    mode: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    experiment = Experiment.from_document(document(OBSERVED, mode))
    compiled = simulate(experiment, estimate=False).lanes["A"]
    advance: Any = LAWS["smc"].advance
    monkeypatch.setitem(LAWS, "smc", replace(LAWS["smc"], advance=advance.py_func))
    called_back = simulate(experiment, estimate=False).lanes["A"]
    for name in ("q", "v", "tau", "f"):
        np.testing.assert_array_equal(getattr(called_back, name), getattr(compiled, name))


@pytest.mark.parametrize("mode", MODES)
def test_what_moves_a_memory_on_may_raise(mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise ArithmeticError("no memory left")

    monkeypatch.setitem(LAWS, "smc", replace(LAWS["smc"], advance=fails))
    loop = loop_of(OBSERVED, mode, 3)
    freeze = loop.lanes["A"].freeze
    assert freeze is not None
    assert "no memory left" in freeze.cause
