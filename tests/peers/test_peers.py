"""The loop that the peers are given is ours."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.cutting import cutting_of
from slidetune.robot.kernels.workspace import NODES, RECORD, Q, V, W
from slidetune.robot.loop.lane import Lane
from tests.peers import numpy_on_pinocchio, ours
from tests.peers.contest import Worker
from tests.peers.environments import PEERS, Peer, UnavailablePeerError, is_ready
from tests.peers.numpy_loop import extrapolated_step, held, plain_step
from tests.peers.preset_problem import preset_problem
from tests.peers.problem import SAMPLE, Array, Problem, Run

REFERENCE = Path(__file__).resolve().parents[1] / "data" / "rbfnn-nftsm.csv"
SCHEMES = ("plain", "extrapolated")


def angles(module: object, problem: Problem, scheme: str, steps: int) -> Array:
    variant = next(v for v in module.VARIANTS if v.scheme == scheme)
    return variant.prepare(problem, steps)().q


@pytest.mark.parametrize("scheme", SCHEMES)
def test_numpy_on_pinocchio_and_simulate_take_the_same_way(scheme: str) -> None:
    problem = preset_problem("paper")
    there = angles(numpy_on_pinocchio, problem, scheme, 1000)
    here = angles(ours, problem, scheme, 1000)
    assert here.shape == (1000 // SAMPLE + 1, 6)
    # Ours solves the equation of which theirs takes the first Newton step, and cuts the first rows:
    # what that leaves is within the bound of `make peers`. Later on both go the same way.
    np.testing.assert_allclose(there, here, rtol=0.0, atol=1e-6)
    moved = np.diff(there - here, axis=0)[10:]
    assert np.abs(moved).max() <= 1e-7


@pytest.mark.parametrize("scheme", SCHEMES)
def test_from_the_same_state_numpy_and_a_lane_take_the_same_step(scheme: str) -> None:
    problem = preset_problem("paper")
    names = dict.fromkeys(set(load_preset("paper").lanes) - {ours.LANE})
    settings = {"lanes": names, "simulation": {"scheme": scheme}}
    packed = pack(load_preset("paper").patched(settings))
    lane = Lane(ours.LANE, packed, np.zeros((1000, len(RECORD), JOINTS)), cutting_of(halvings=0))
    make = {"plain": plain_step, "extrapolated": extrapolated_step}[scheme]
    step = make(problem, numpy_on_pinocchio.mass_and_bias(problem))
    for row in range(1000):
        t = row * problem.h
        before = tuple(lane.work[rows].copy() for rows in (Q, V, slice(W, W + NODES)))
        assert lane.step(t, row, row) == 0
        if row < 300:
            continue  # at the start it solves a curve where NumPy takes its tangent
        q, v, weights = step(t, before)
        np.testing.assert_allclose(lane.work[Q], q, rtol=0.0, atol=1e-10)
        np.testing.assert_allclose(lane.work[V], v, rtol=0.0, atol=1e-7)
        np.testing.assert_allclose(lane.work[W : W + NODES], weights, rtol=0.0, atol=1e-7)


@pytest.mark.parametrize(("scheme", "error"), [("plain", 1e-3), ("extrapolated", 5e-5)])
def test_numpy_on_pinocchio_agrees_with_the_reference(scheme: str, error: float) -> None:
    problem = preset_problem("paper-undisturbed")
    found = angles(numpy_on_pinocchio, problem, scheme, 1000)
    truth = np.loadtxt(REFERENCE, delimiter=",", skiprows=1, max_rows=len(found))[:, 1:7]
    assert np.abs(found - truth).max() <= error


def explicit(problem: Problem, steps: int) -> Run:
    """Hold the torque over an explicit step of the arm."""
    model = pin.buildModelFromUrdf(problem.urdf)
    data, q, v = model.createData(), np.zeros(6), problem.v0.copy()

    def advance(torque: Array) -> tuple[Array, Array]:
        v[:] += problem.h * pin.aba(model, data, q, v, torque)
        q[:] += problem.h * v
        return q.copy(), v.copy()

    return held(problem, steps, advance)


def test_a_held_torque_diverges_at_one_millisecond_and_follows_at_half_a_microsecond() -> None:
    problem = preset_problem("paper-undisturbed")
    lost = explicit(problem, 100)()
    assert lost.diverged is not None
    assert lost.diverged <= 0.01
    fine = explicit(replace(problem, h=5e-7), 2000)()
    assert fine.diverged is None
    slow = angles(numpy_on_pinocchio, replace(problem, h=5e-6), "extrapolated", 200)
    assert np.abs(fine.q[-1] - slow[-1]).max() <= 1e-6


def test_a_problem_survives_the_pipe() -> None:
    problem = preset_problem("paper")
    text = json.dumps(problem.document())
    assert Problem.from_document(json.loads(text)).document() == problem.document()


@pytest.fixture(params=[peer for peer in PEERS if peer.requirement], ids=lambda peer: peer.name)
def worker(request: pytest.FixtureRequest) -> Iterator[Worker]:
    if not is_ready(request.param):
        pytest.skip(f"{request.param.title} is not installed: make peers")
    with closing(Worker(request.param)) as running:
        yield running


def test_every_installed_peer_takes_the_same_way(worker: Worker) -> None:
    problem = preset_problem("paper")
    here = angles(ours, problem, "plain", 100)
    number = [scheme for _, scheme in worker.variants].index("plain")
    answer = worker.ask(problem, number, 100)
    assert answer["diverged"] is None
    np.testing.assert_allclose(answer["q"], here, rtol=0.0, atol=1e-6)


def test_a_peer_that_can_not_be_started_says_why() -> None:
    with pytest.raises(UnavailablePeerError, match=r"No module named .*no_such_arm"):
        Worker(Peer("none", "Nobody", "no_such_arm"))
