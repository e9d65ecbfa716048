"""Torques that act later than the log says: by how much, and what is fitted all the same."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.identification.identify import identify
from slidetune.robot.loop.simulate import Run, simulate
from tests.robot.identification.test_identify import ONE, SIX, TWO, covered, log_of, unknowing

PERIOD = 0.001
"""Of a sampled loop in [s], whose hold acts for half of it later."""


def run_of(document: dict[str, Any], delay: float | None, horizon: float = 12.0) -> Run:
    """A continuous loop, or a sampled one whose torques come so much later."""
    simulation: dict[str, Any] = {"horizon": horizon}
    if delay is not None:
        simulation |= {"mode": "sampled", "input_delay": delay, "plant_substeps": 4}
    lanes = {"A": {"law": "computed_torque"}}
    whole = {**document, "lanes": lanes, "simulation": simulation}
    return simulate(Experiment.from_document(whole), estimate=False)


def told(remarks: tuple[str, ...]) -> tuple[float, float] | None:
    """By how much torques were shifted and half its interval in [s], if a remark says so."""
    for remark in remarks:
        if remark.startswith("torques act"):
            words = remark.split()
            sign = 1.0 if words[6] == "later" else -1.0
            return sign * float(words[2]) * 1e-3, float(words[4]) * 1e-3
    return None


@pytest.mark.parametrize("delay", [0.0, 0.0007, 0.003])
@pytest.mark.parametrize(("document", "noise"), [(SIX, 0.3), (TWO, 0.03)], ids=["six", "two"])
def test_a_delay_is_found_and_the_intervals_hold_all_the_same(
    document: dict[str, Any], noise: float, delay: float
) -> None:
    run = run_of(document, delay)
    found = identify(log_of(run, noise=noise, angles=1e-5, seed=3), unknowing(run))
    late = told(found.remarks)
    assert late is not None
    assert late[0] == pytest.approx(delay + PERIOD / 2, abs=max(2.0 * late[1], 1e-4))
    inside = covered(run, found)
    assert sum(inside) >= 0.85 * len(inside)


@pytest.mark.parametrize("late", [-0.004, 0.02, 0.05])
def test_a_shift_of_whatever_size_is_found(late: float) -> None:
    run = run_of(TWO, None)
    log = log_of(run, noise=0.03, angles=1e-5, seed=3)
    assert log.tau is not None
    early = [np.interp(run.time + late, run.time, column) for column in log.tau.T]
    found = identify(replace(log, tau=np.stack(early, axis=1)), unknowing(run))
    said = told(found.remarks)
    assert said is not None
    assert said[0] == pytest.approx(late, abs=max(2.0 * said[1], 1e-4))
    inside = covered(run, found)
    assert sum(inside) >= 0.85 * len(inside)


@pytest.mark.parametrize("document", [SIX, TWO, ONE], ids=["six", "two", "one"])
def test_nothing_is_shifted_where_torques_act_at_once(document: dict[str, Any]) -> None:
    run = run_of(document, None)
    for noise in (0.0, 0.3):
        found = identify(log_of(run, noise=noise, seed=5), unknowing(run))
        late = told(found.remarks)
        assert late is None or abs(late[0]) < 2e-4
