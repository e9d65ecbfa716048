"""The integration against solutions of high accuracy that share no code with it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate

DATA = Path(__file__).parents[2] / "data"
LANES = {"RBFNN-NFTSM": "rbfnn-nftsm", "RBFNN-SMC": "rbfnn-smc", "NFTSM": "nftsm"}


def reference(lane: str) -> dict[str, np.ndarray]:
    table = np.loadtxt(DATA / f"{LANES[lane]}.csv", delimiter=",", skiprows=1)
    groups = np.split(table[:, 1:], 4, axis=1)
    return {"time": table[:, 0], **dict(zip(("q", "v", "tau", "S"), groups, strict=True))}


def difference(run: Run, lane: str, column: str, skip: int = 0) -> float:
    truth = reference(lane)
    rows = np.searchsorted(run.time, truth["time"] - 1e-9)
    rows = rows[rows < len(run.time)]
    np.testing.assert_allclose(run.time[rows], truth["time"][: len(rows)], atol=1e-9)
    found = getattr(run.lanes[lane], column)[rows]
    return float(np.abs(found - truth[column][: len(rows)])[skip:].max())


@pytest.mark.parametrize("lane", LANES)
def test_angles_agree_with_the_reference_at_one_millisecond(undisturbed: Run, lane: str) -> None:
    assert len(reference(lane)["time"]) == 501
    assert difference(undisturbed, lane, "q") <= 5e-5


@pytest.mark.parametrize("lane", LANES)
def test_velocities_agree_with_the_reference(undisturbed: Run, lane: str) -> None:
    assert difference(undisturbed, lane, "v") <= 5e-4


@pytest.mark.parametrize("lane", LANES)
def test_torque_and_sliding_variable_agree_once_the_start_is_over(
    undisturbed: Run, lane: str
) -> None:
    # At rest against 1 rad/s, the torque of the wrists falls by 1700 N m within a microsecond.
    assert difference(undisturbed, lane, "tau", skip=10) <= 0.05
    assert difference(undisturbed, lane, "S", skip=10) <= 5e-4


@pytest.mark.parametrize("lane", LANES)
def test_first_row_is_evaluated_before_any_step(undisturbed: Run, lane: str) -> None:
    truth, found = reference(lane), undisturbed.lanes[lane]
    np.testing.assert_allclose(found.tau[0], truth["tau"][0], atol=1e-5)
    np.testing.assert_allclose(found.S[0], truth["S"][0], atol=1e-9)


def test_extrapolation_is_worth_its_price() -> None:
    document = {
        "lanes": {"RBFNN-NFTSM": {"law": "rbfnn_nftsm"}},
        "simulation": {"initial_velocity": "rest", "horizon": 2.0},
    }
    fine = Experiment.from_document(document)
    plain = simulate(fine.patched({"simulation": {"scheme": "plain"}}))
    extrapolated = simulate(fine)
    ratio = difference(plain, "RBFNN-NFTSM", "q") / difference(extrapolated, "RBFNN-NFTSM", "q")
    assert ratio > 30.0
