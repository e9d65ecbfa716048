"""Whole responses a second: the runs are those of the loop, and the figures say what they claim."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest

from tests.peers import ours
from tests.peers.contest import Worker
from tests.peers.environments import PEERS, is_ready
from tests.peers.preset_problem import preset_problem
from tests.peers.problem import SAMPLE
from tests.peers.responses import Responder, base, strays


@pytest.fixture
def worker() -> Iterator[Worker]:
    with closing(Worker(PEERS[0])) as running:
        yield running


@pytest.mark.parametrize("scheme", ["plain", "extrapolated"])
def test_a_batch_makes_the_runs_of_the_loop(scheme: str, worker: Worker) -> None:
    problem = preset_problem("paper")
    single = next(v for v in ours.VARIANTS if v.scheme == scheme).prepare(problem, 100)()
    number = [s for _, s in worker.batches].index(scheme)
    answer = worker.ask(problem, number, 100, batch=True)
    np.testing.assert_array_equal(answer["q"], single.q)
    assert answer["wall"] > 0.0


def test_a_replay_that_leaves_the_way_of_the_loop_is_told(worker: Worker) -> None:
    problem = preset_problem("paper")
    plain = Responder((worker,), 0, "simulate", "plain", 100)
    plain.measure(problem, 100)
    replay = Responder((worker,), 0, "rollout", "open", 100, q=plain.q.copy())
    own = Responder((worker,), 1, "simulate", "extrapolated", 100)
    everything = [plain, own, replay]
    assert base(replay, everything) is plain
    assert not list(strays(everything, SAMPLE * problem.h, 1e-6))
    replay.q[-1, 0] += 1e-3
    ((found, off),) = strays(everything, SAMPLE * problem.h, 1e-6)
    assert found is replay
    assert off == pytest.approx(1e-3)


def test_mujoco_replays_the_way_of_the_loop() -> None:
    peer = next(peer for peer in PEERS if peer.name == "mujoco")
    if not is_ready(peer):
        pytest.skip("MuJoCo is not installed: make peers")
    problem = preset_problem("paper")
    plain = next(v for v in ours.VARIANTS if v.scheme == "plain").prepare(problem, 1000)()
    with closing(Worker(peer)) as running:
        answer = running.ask(problem, 0, 1000, batch=True)
    np.testing.assert_allclose(answer["q"], plain.q, rtol=0.0, atol=1e-6)
