"""A law's memory: moved on with the state, kept with it, and no other law's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.law_call import Advance
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import NODES, PERIOD, RIGHT, S_FALL, S_FREE, TAU, S, W
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.simulate import simulate

Array = np.ndarray
ROWS = slice(W, W + NODES)


def clock(h, state, into, _gains, _M, _nle, work):  # type: ignore[no-untyped-def]
    """Time and the integral of S."""
    for j in range(JOINTS):
        s = work[S, j]
        if work[PERIOD, 0] == 0.0:
            s = work[S_FREE, j] - work[S_FALL, j] * work[RIGHT, j]
        work[into + W, j] = work[state + W, j] + h
        work[into + W + 1, j] = work[state + W + 1, j] + h * s


def bounded(_h, state, into, _gains, _M, _nle, work):  # type: ignore[no-untyped-def]
    """Keep the largest torque so far."""
    for j in range(JOINTS):
        work[into + W, j] = max(work[state + W, j], abs(work[TAU, j]))


compiled_clock = kernel(clock)


def remembering(monkeypatch: pytest.MonkeyPatch, advance: Advance) -> None:
    monkeypatch.setitem(LAWS, "smc", replace(LAWS["smc"], memory=2, advance=advance))


def experiment(law: str = "smc", mode: str = "continuous", **changes: Any) -> Experiment:
    simulation = {"mode": mode, "step": 0.002, "control_rate": 500.0, "horizon": 0.1}
    lane = {"law": law, "k1": 20.0, "k2": 5.0}
    document = {
        "robot": {"armature": 0.3},
        "lanes": {"A": lane if "k1" in LAWS[law].lane.model_fields else {"law": law}},
        "simulation": {**simulation, "initial_error": 0.1, **changes.pop("simulation", {})},
        **changes,
    }
    return Experiment.from_document(document)


def stepped(packed: Packed, steps: int = 10) -> ClosedLoop:
    loop = ClosedLoop(packed, 64)
    for _ in range(steps):
        loop.step()
    return loop


def memory(loop: ClosedLoop) -> Array:
    return np.array(loop.lanes["A"].work[ROWS])


@pytest.mark.parametrize("advance", [clock, compiled_clock])
@pytest.mark.parametrize("mode", ["plain", "extrapolated", "sampled"])
def test_memory_moves_on_with_time(
    mode: str, advance: Advance, monkeypatch: pytest.MonkeyPatch
) -> None:
    remembering(monkeypatch, advance)
    sampled = mode == "sampled"
    changes = {} if sampled else {"simulation": {"scheme": mode}}
    asked = experiment("smc", "sampled" if sampled else "continuous", **changes)
    loop = stepped(pack(asked))
    np.testing.assert_allclose(memory(loop)[0], 0.02, rtol=1e-12)
    # What it integrates is S along the run, to the order of the scheme.
    run = simulate(asked).lanes["A"]
    rows = run.S[:11]
    share = {"plain": 1.0, "extrapolated": 0.5, "sampled": 0.0}[mode]
    exact = 0.002 * ((1.0 - share) * rows[:-1] + share * rows[1:]).sum(axis=0)
    room = {"plain": 1e-2, "extrapolated": 5e-3, "sampled": 1e-12}[mode]
    np.testing.assert_allclose(memory(loop)[1], exact, rtol=room)


def test_a_memory_is_moved_on_alike_compiled_and_called_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Coulomb friction and a limit have steps cut.
    hard = {"robot": {"armature": 0.3, "coulomb_friction": 5.0, "torque_limit": 30.0}}
    for mode in ("continuous", "sampled"):
        found = []
        for advance in (clock, compiled_clock):
            remembering(monkeypatch, advance)
            found.append(memory(stepped(pack(experiment("smc", mode, **hard)), 40)))
        np.testing.assert_allclose(*found, rtol=1e-12)
        np.testing.assert_allclose(found[0][0], 0.08, rtol=1e-12)


def test_a_sampled_law_remembers_the_torque_within_its_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    remembering(monkeypatch, kernel(bounded))
    loop = stepped(pack(experiment("smc", "sampled", robot={"armature": 0.3, "torque_limit": 7.0})))
    assert memory(loop)[0].max() == 7.0


def test_a_memory_is_not_recorded_as_weights(monkeypatch: pytest.MonkeyPatch) -> None:
    remembering(monkeypatch, compiled_clock)
    for mode in ("continuous", "sampled"):
        assert not simulate(experiment("smc", mode)).lanes["A"].weights.any()


def test_what_a_memory_raises_freezes_its_lane(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> None:
        raise ArithmeticError("no memory")

    remembering(monkeypatch, fail)
    for mode in ("continuous", "sampled"):
        loop = stepped(pack(experiment("smc", mode)), 2)
        freeze = loop.lanes["A"].freeze
        assert freeze is not None
        assert "no memory" in freeze.cause


@pytest.fixture
def two_memories(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], Packed]:
    """Give two laws a memory; return the experiment with one or another law."""
    for name in ("smc", "nftsm"):
        law = replace(LAWS[name], memory=2, advance=compiled_clock)
        monkeypatch.setitem(LAWS, name, law)
    return lambda law: pack(experiment(law))


def test_another_law_begins_with_an_empty_memory(two_memories: Callable[[str], Packed]) -> None:
    for before, after in (("smc", "nftsm"), ("smc", "rbfnn_smc"), ("rbfnn_smc", "smc")):
        loop = stepped(two_memories(before))
        assert memory(loop).any()
        loop.adopt(two_memories(after))
        assert not memory(loop).any()
        loop.step()
        assert np.allclose(memory(loop)[0], 0.002) or not LAWS[after].memory


def test_memory_and_weights_go_on_where_the_law_can_use_them(
    two_memories: Callable[[str], Packed],
) -> None:
    for before, after, goes_on in (("smc", "smc", False), ("rbfnn_smc", "rbfnn_nftsm", True)):
        loop = stepped(two_memories(before))
        known = memory(loop)
        for law in ("computed_torque", after):  # which neither needs nor changes weights
            loop.adopt(two_memories(law))
            np.testing.assert_array_equal(memory(loop), known * goes_on)


def test_a_lane_goes_back_to_the_memory_that_it_had(two_memories: Callable[[str], Packed]) -> None:
    loop = stepped(two_memories("smc"))
    past, known = loop.state(), memory(loop)
    loop.adopt(two_memories("nftsm"))
    for _ in range(5):
        loop.step()
    loop.restore(past)
    assert not memory(loop).any()  # the present law is another one than that of the past
    loop.adopt(two_memories("smc"))
    loop.restore(past)
    np.testing.assert_array_equal(memory(loop), known)
    loop.step()
    np.testing.assert_allclose(memory(loop)[0], 0.022, rtol=1e-12)
