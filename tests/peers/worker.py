"""One contestant in a process of its own: ``python -m tests.peers.worker MODULE``.

It says what it is, then answers one request a line, all in JSON. Times are taken here, so that the
pipe is not in them; processor time, so that another process is not either.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import sys
from time import perf_counter, process_time
from types import ModuleType
from typing import Any

import numpy as np

from tests.peers.problem import Problem, Variant

LOOPS = 2000
"""Evaluations of M and h timed at once (*ours*)."""


def _dynamics(peer: ModuleType, problem: Problem) -> dict[str, Any]:
    """Return the time of M and h alone in [s]."""
    evaluate = peer.mass_and_bias(problem)
    q, v = np.linspace(0.1, 0.6, 6), np.linspace(0.6, 0.1, 6)
    evaluate(q, v)
    begin = process_time()
    for _ in range(LOOPS):
        evaluate(q, v)
    return {"seconds": (process_time() - begin) / LOOPS}


def _batches(peer: ModuleType) -> tuple[Variant, ...]:
    """Return the ways in which a peer makes many runs in one call; their trace is that of one."""
    return getattr(peer, "BATCHES", ())


def _run(variant: Variant, problem: Problem, steps: int) -> dict[str, Any]:
    """Return what a run did and its time in [s], also on the wall; loading the arm is not in it."""
    run = variant.prepare(problem, steps)
    gc.collect()
    begin, start = process_time(), perf_counter()
    trace = run()
    seconds, wall = process_time() - begin, perf_counter() - start
    return {"seconds": seconds, "wall": wall, "q": trace.q.tolist(), "diverged": trace.diverged}


def main() -> None:
    """Serve until the other side closes."""
    # Some simulators print to standard output from C++.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def answer(message: dict[str, Any]) -> None:
        print(json.dumps(message), file=answers, flush=True)

    peer = importlib.import_module(f"tests.peers.{sys.argv[1]}")
    ways = {"variants": peer.VARIANTS, "batches": _batches(peer)}
    names = {kind: [way[:2] for way in all_of_them] for kind, all_of_them in ways.items()}
    answer({"version": peer.VERSION, **names})
    for line in sys.stdin:
        request = json.loads(line)
        problem = Problem.from_document(request["problem"])
        if request["variant"] is None:
            answer(_dynamics(peer, problem))
        else:
            way = ways["batches" if request["batch"] else "variants"][request["variant"]]
            answer(_run(way, problem, request["steps"]))


if __name__ == "__main__":
    main()
