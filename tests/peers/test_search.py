"""The search by hand is the search of ``tune``: the same gains, and errors that agree."""

from __future__ import annotations

from typing import Any

import pytest

from tests.peers import numpy_on_pinocchio
from tests.peers.problem import Problem
from tests.peers.search import GAINS, LOST, by_hand, by_tune, searched, wanted

TRIALS = 12
"""As many as are drawn before the sampler looks at results."""


def ask(problem: Problem, steps: int) -> dict[str, Any]:
    plain = next(one for one in numpy_on_pinocchio.VARIANTS if one.scheme == "plain")
    trace = plain.prepare(problem, steps)()
    return {"q": trace.q, "diverged": trace.diverged, "seconds": 0.0}


def test_by_hand_the_same_gains_are_tried_and_the_same_errors_found() -> None:
    experiment = searched("plain", 0.5)
    here, there = by_tune(experiment, TRIALS), by_hand(experiment, TRIALS, ask)
    assert here.values == there.values
    assert set(here.values[0]) == set(GAINS) == set(wanted(experiment, TRIALS).gains)
    for ours, theirs in zip(here.errors, there.errors, strict=True):
        if ours < LOST:
            # Theirs is over every 20th step.
            assert theirs == pytest.approx(ours, rel=0.1)
    assert sum(error < LOST for error in here.errors) > TRIALS / 2
