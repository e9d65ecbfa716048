"""What would keep the workers from everybody else is refused before it begins."""

from __future__ import annotations

from typing import Any

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.server.compute.run_cost import refuse_if_costly
from tests.server.conftest import Served

COSTLY = {"simulation": {"mode": "sampled", "control_rate": 10000.0, "plant_substeps": 200}}


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("/api/preview", {}),
        ("/api/lens", {"lane": "NFTSM"}),
        ("/api/studies/strip", {"lane": "NFTSM", "field": "nu"}),
        ("/api/studies/sensitivity", {"lane": "NFTSM"}),
        ("/api/studies/switching", {"lane": "NFTSM"}),
    ],
)
def test_what_would_take_the_workers_for_minutes_is_refused_with_its_cost(
    served: Served, path: str, body: dict[str, Any]
) -> None:
    assert served.http.patch("/api/experiment", json=COSTLY).status_code == 200
    answer = served.http.post(path, json=body)
    assert answer.status_code == 422
    (field,) = answer.json()["error"]["fields"]
    assert field["path"] == "simulation.plant_substeps"
    assert "20,000,000 steps of the arm" in field["message"]
    assert "at most 8,000,000" in field["message"]
    assert served.app_state.workers.tasks == 0


def test_the_longest_run_at_the_usual_substeps_is_not_refused() -> None:
    longest = Experiment().patched(
        {"simulation": {"mode": "sampled", "control_rate": 10000.0, "horizon": 20.0}}
    )
    refuse_if_costly(longest)
    refuse_if_costly(longest.patched({"simulation": {"mode": "continuous"}}))
