"""One contestant in a process of its own: ``python -m tests.peers.worker MODULE``.

It says what it is, then answers one request a line, all in JSON. Times are processor time, taken
here, so that neither the pipe nor another process is in them.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import sys
from time import process_time
from types import ModuleType
from typing import Any

import numpy as np

from tests.peers.problem import Problem

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


def _run(peer: ModuleType, problem: Problem, variant: int, steps: int) -> dict[str, Any]:
    """Return what one run did and its time in [s]; loading the arm is not in it."""
    run = peer.VARIANTS[variant].prepare(problem, steps)
    gc.collect()
    begin = process_time()
    trace = run()
    seconds = process_time() - begin
    return {"seconds": seconds, "q": trace.q.tolist(), "diverged": trace.diverged}


def main() -> None:
    """Serve until the other side closes."""
    # Some simulators print to standard output from C++.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def answer(message: dict[str, Any]) -> None:
        print(json.dumps(message), file=answers, flush=True)

    peer = importlib.import_module(f"tests.peers.{sys.argv[1]}")
    answer({"version": peer.VERSION, "variants": [v[:2] for v in peer.VARIANTS]})
    for line in sys.stdin:
        request = json.loads(line)
        problem = Problem.from_document(request["problem"])
        if request["variant"] is None:
            answer(_dynamics(peer, problem))
        else:
            answer(_run(peer, problem, request["variant"], request["steps"]))


if __name__ == "__main__":
    main()
