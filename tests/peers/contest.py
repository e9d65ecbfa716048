"""Contestants in processes of their own, and rounds in which each runs once, in random order."""

from __future__ import annotations

import json
import random
import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from tests.peers.environments import ROOT, Peer, UnavailablePeerError, interpreter
from tests.peers.problem import SAMPLE, Array, Problem

PROBE = 5 * SAMPLE
"""Steps of the first run, which warms up and tells how long a step takes (*ours*)."""


class Worker:
    """A peer in its own process; end it with ``close``.

    Attributes:
        peer: which.
        version: its name and version, as it says itself.
        variants: name and scheme of each way in which it runs the loop.
        batches: the same of each way in which it makes many runs in one call.
    """

    def __init__(self, peer: Peer) -> None:
        """Start it.

        Raises:
            UnavailablePeerError: if it can't be installed or started.
        """
        self.peer = peer
        command = [str(interpreter(peer)), "-W", "ignore", "-m", "tests.peers.worker", peer.module]
        self._errors = TemporaryFile("w+", errors="replace")  # noqa: SIM115 - until close()
        self._process = subprocess.Popen(
            command,
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            encoding="utf-8",
        )
        hello = self._read()
        self.version: str = hello["version"]
        self.variants: list[tuple[str, str]] = [
            (name, scheme) for name, scheme in hello["variants"]
        ]
        self.batches: list[tuple[str, str]] = [(name, scheme) for name, scheme in hello["batches"]]

    def _read(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if line:
            answer: dict[str, Any] = json.loads(line)
            return answer
        self._process.wait()
        self._errors.seek(0)
        said = self._errors.read().strip().splitlines()
        self.close()
        raise UnavailablePeerError(f"it ended: {said[-1] if said else 'no reason given'}")

    def ask(
        self, problem: Problem, variant: int | None, steps: int = 0, batch: bool = False
    ) -> dict[str, Any]:
        """Let it run one variant, or M and h alone where that is ``None``; or one of its batches.

        Raises:
            UnavailablePeerError: if it ends instead.
        """
        assert self._process.stdin is not None
        request = {
            "problem": problem.document(),
            "variant": variant,
            "steps": steps,
            "batch": batch,
        }
        # Where it has ended already, its last words say more than a broken pipe.
        with suppress(BrokenPipeError):
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        return self._read()

    def close(self) -> None:
        """End its process."""
        self._process.kill()
        self._process.communicate()
        self._errors.close()


@dataclass
class Entry:
    """One variant of one peer, and what was measured of it.

    Attributes:
        worker: the peer.
        number: of the variant; ``None`` stands for M and h alone.
        steps: control periods of a timed run.
        error: greatest distance to the reference in [rad], undisturbed.
        compared: over how long the reference was followed in [s].
        diverged: when it left its bounds in [s], or ``None``.
        times: processor time a step in [s], one a round.
        q: angles of the last timed run in [rad]. Shape (n, 6).
    """

    worker: Worker
    number: int | None
    steps: int = 0
    error: float = 0.0
    compared: float = 0.0
    diverged: float | None = None
    times: list[float] = field(default_factory=list)
    q: Array = field(default_factory=lambda: np.empty((0, 6)))

    @property
    def name(self) -> str:
        """What it runs."""
        return "" if self.number is None else self.worker.variants[self.number][0]

    @property
    def scheme(self) -> str:
        """How it runs it; see ``Variant``."""
        return "dynamics" if self.number is None else self.worker.variants[self.number][1]

    def measure(self, problem: Problem) -> None:
        """Run once more and note the time of a step."""
        answer = self.worker.ask(problem, self.number, self.steps)
        if self.number is None:
            self.times.append(answer["seconds"])
            return
        self.diverged = answer["diverged"]
        if self.diverged is None:
            self.times.append(answer["seconds"] / self.steps)
            self.q = np.array(answer["q"])


def entries(worker: Worker) -> list[Entry]:
    """Return all that a peer runs: M and h alone, then each of its loops."""
    return [Entry(worker, number) for number in (None, *range(len(worker.variants)))]


def _affordable(steps: int, seconds_a_step: float, seconds: float) -> int:
    """Return as many of the steps as fit into a time, in whole rows of a trace."""
    share = min(steps, int(seconds / max(seconds_a_step, 1e-9)))
    return max(share // SAMPLE * SAMPLE, PROBE)


def follow_reference(
    entry: Entry, problem: Problem, truth: Array, steps: int, patience: tuple[float, float]
) -> None:
    """Warm up, compare with the reference, and choose the length of timed runs.

    Args:
        entry: what to run.
        problem: the loop that the reference solves.
        truth: angles of the reference in [rad], a row every ``SAMPLE`` steps. Shape (n, 6).
        steps: control periods of a whole run.
        patience: processor time in [s] for the comparison and for a timed run.
    """
    entry.worker.ask(problem, entry.number, PROBE)
    if entry.number is None:
        return
    probe = entry.worker.ask(problem, entry.number, PROBE)
    cost = probe["seconds"] / PROBE
    entry.steps = _affordable(steps, cost, patience[0])
    answer = entry.worker.ask(problem, entry.number, entry.steps)
    q = np.array(answer["q"])
    entry.error = float(np.abs(q - truth[: len(q)]).max())
    entry.compared = entry.steps * problem.h
    entry.steps = _affordable(steps, answer["seconds"] / entry.steps, patience[1])


def run_rounds(
    contest: Sequence[Entry], problem: Problem, rounds: int, progress: Callable[[float], None]
) -> None:
    """Let everything run once a round, in an order that is drawn anew each time."""
    for turn in range(rounds):
        order = list(contest)
        random.Random(turn).shuffle(order)
        for place, entry in enumerate(order):
            entry.measure(problem)
            progress((turn * len(order) + place + 1) / (rounds * len(order)))


def ratio(entry: Entry, base: Entry) -> float:
    """Return the median over all rounds of one time over another of the same round."""
    return float(np.median(np.divide(entry.times, base.times)))


def distance(entry: Entry, base: Entry) -> float:
    """Return the greatest difference of the angles of two timed runs in [rad]."""
    rows = min(len(entry.q), len(base.q))
    return float(np.abs(entry.q[:rows] - base.q[:rows]).max())
