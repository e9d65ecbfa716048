"""What an unstable sampled loop is said to come to."""

from __future__ import annotations

import pytest

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack

LANE = {"law": "computed_torque", "kp": 2000.0, "kd": 300.0}
LATE = {"mode": "sampled", "control_rate": 200.0, "input_delay": 0.005}


@pytest.mark.parametrize(
    ("limit", "outcome"),
    [
        (None, "expect divergence."),
        (50.0, "expect a limit cycle within the torque limits, or divergence."),
    ],
)
def test_divergence_alone_is_expected_only_where_no_torque_limit_can_hold_the_loop(
    limit: float | None, outcome: str
) -> None:
    document = {"simulation": LATE, "robot": {"torque_limit": limit}, "lanes": {"A": LANE}}
    notes = advice_on(pack(Experiment.from_document(document)), "A")
    found = {note.path: note.message for note in notes}
    assert outcome in found["simulation.control_rate"]
