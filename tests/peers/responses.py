"""Whole responses a second on two cores: a batch in two threads, or two processes at once."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field

import numpy as np

from tests.peers.contest import PROBE, Entry, Worker
from tests.peers.problem import BATCH, THREADS, Array, Problem

HEADINGS = ("closed loop", "scheme", "on two cores", "runs a second", "ours / this")
REPLAYED = 3.0
"""How long the replayed torque keeps the arm on the way of the closed loop in [s] (*ours*): for
twice as long at least; without feedback a rounding error grows for ever."""


@dataclass
class Responder:
    """One way to get whole responses, and what was measured of it.

    Attributes:
        workers: the peer, once or once for each process.
        number: of the batch where there is one worker, else of the variant.
        name: what it runs.
        scheme: how; see ``Variant``.
        steps: control periods of a timed run.
        rates: whole runs a second, one figure a round.
        q: angles of the last run in [rad]. Shape (n, 6).
    """

    workers: Sequence[Worker]
    number: int
    name: str
    scheme: str
    steps: int
    rates: list[float] = field(default_factory=list)
    q: Array = field(default_factory=lambda: np.empty((0, 6)))

    @property
    def in_threads(self) -> bool:
        """Whether it is a batch in threads of one process."""
        return len(self.workers) == 1

    def measure(self, problem: Problem, whole: int) -> None:
        """Run once more and note how many runs of ``whole`` control periods a second that gives."""
        if self.in_threads:
            answers = [self.workers[0].ask(problem, self.number, self.steps, batch=True)]
        else:
            with ThreadPoolExecutor(len(self.workers)) as pool:
                asked = [
                    pool.submit(worker.ask, problem, self.number, self.steps)
                    for worker in self.workers
                ]
                answers = [one.result() for one in asked]
        runs = BATCH if self.in_threads else 1
        rate = sum(runs / answer["wall"] for answer in answers)
        self.rates.append(rate * self.steps / whole)
        self.q = np.array(answers[0]["q"])


def _pairs(contest: Sequence[Entry], problem: Problem, stack: ExitStack) -> Iterator[Responder]:
    """Yield every loop of the others that follows, in two processes."""
    ours, seconds = contest[0].worker, dict[str, Worker]()
    for entry in contest:
        if entry.worker is ours or entry.number is None or entry.diverged is not None:
            continue
        peer = entry.worker.peer
        if peer.name not in seconds:
            seconds[peer.name] = Worker(peer)
            stack.callback(seconds[peer.name].close)
        second = seconds[peer.name]
        second.ask(problem, entry.number, PROBE)
        yield Responder((entry.worker, second), entry.number, entry.name, entry.scheme, entry.steps)


def responders(
    workers: Sequence[Worker],
    contest: Sequence[Entry],
    problem: Problem,
    steps: int,
    stack: ExitStack,
) -> list[Responder]:
    """Return all that give whole responses: the batches, ours first, then the others' loops.

    Args:
        workers: the peers.
        contest: their loops, timed once at least.
        problem: what they run.
        steps: control periods of a whole run.
        stack: ends the processes that this starts.
    """
    batches = [
        Responder((worker,), number, name, scheme, steps)
        for worker in workers
        for number, (name, scheme) in enumerate(worker.batches)
    ]
    for batch in batches:
        batch.workers[0].ask(problem, batch.number, PROBE, batch=True)
    return [*batches, *_pairs(contest, problem, stack)]


def run_responses(
    all_of_them: Sequence[Responder],
    problem: Problem,
    steps: int,
    rounds: int,
    progress: Callable[[float], None],
) -> None:
    """Let everything run once a round, one after the other, in an order that is drawn anew."""
    for turn in range(rounds):
        order = list(all_of_them)
        random.Random(turn).shuffle(order)
        for place, responder in enumerate(order):
            responder.measure(problem, steps)
            progress((turn * len(order) + place + 1) / (rounds * len(order)))


def base(responder: Responder, all_of_them: Sequence[Responder]) -> Responder:
    """Return our own batch of the same scheme; of the plain one for the replay of its torques."""
    own = {other.scheme: other for other in all_of_them if other.workers[0].peer.name == "ours"}
    scheme = "plain" if responder.scheme == "open" else responder.scheme
    return own.get(scheme, own["extrapolated"])


def row(
    responder: Responder,
    all_of_them: Sequence[Responder],
    schemes: dict[str, str],
    figure: Callable[[float], str],
) -> list[str]:
    """Return a row of the table."""
    ours = base(responder, all_of_them)
    # The best of each: what else a machine does can only lower a rate on the wall.
    times = max(ours.rates) / max(responder.rates)
    return [
        f"{responder.workers[0].version}: {responder.name}",
        schemes[responder.scheme],
        f"{BATCH} runs, {THREADS} threads" if responder.in_threads else "2 processes",
        figure(max(responder.rates)),
        "1" if ours is responder else figure(times),
    ]


def strays(
    all_of_them: Sequence[Responder], sample: float, agreement: float
) -> Iterator[tuple[Responder, float]]:
    """Yield what leaves the way of the closed loop while its torques are replayed, and how far.

    Args:
        all_of_them: what has run.
        sample: time between two rows of a trace in [s].
        agreement: greatest difference in angle in [rad].
    """
    for responder in all_of_them:
        if responder.scheme != "open":
            continue
        ours = base(responder, all_of_them).q
        rows = min(round(REPLAYED / sample), len(ours), len(responder.q))
        off = float(np.abs(ours[:rows] - responder.q[:rows]).max())
        if not off <= agreement:
            yield responder, off
