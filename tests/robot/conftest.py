"""Runs that several files look at, made once."""

from __future__ import annotations

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate

PAPER_LANES = {
    "RBFNN-NFTSM": {"law": "rbfnn_nftsm"},
    "RBFNN-SMC": {"law": "rbfnn_smc"},
    "NFTSM": {"law": "nftsm"},
}


@pytest.fixture(scope="session")
def undisturbed() -> Run:
    """The paper's comparison without a disturbance, from rest: S0."""
    document = {"lanes": PAPER_LANES, "simulation": {"initial_velocity": "rest"}}
    return simulate(Experiment.from_document(document))


@pytest.fixture(scope="session")
def disturbed() -> Run:
    """The paper's comparison with the fitted constant torque: S1."""
    disturbance = {"constant": [-22.5, -33.0, -20.0, 0.0, 0.0, 0.0]}
    return simulate(Experiment.from_document({"lanes": PAPER_LANES, "disturbance": disturbance}))
