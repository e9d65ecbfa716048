"""A lane that leaves its bounds beside one that doesn't, to be exported."""

from __future__ import annotations

from slidetune.robot.experiment.document import Experiment

CALM = {"law": "computed_torque", "kp": 400.0, "kd": 40.0}
WILD = {"law": "nftsm", "k1": 1000.0, "k2": 1000.0}


def short_experiment(horizon: float = 0.1) -> Experiment:
    """Two lanes whose names differ in signs alone; the second leaves its bounds at once."""
    lanes = {"Lane 1": CALM, "lane-1": WILD}
    simulation = {"mode": "sampled", "horizon": horizon}
    return Experiment.from_document({"title": "Two", "lanes": lanes, "simulation": simulation})
