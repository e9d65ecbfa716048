"""Lessons over HTTP, through a real server."""

from __future__ import annotations

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference
from tests.server.conftest import Served


def test_lessons_are_listed_in_order(served: Served) -> None:
    listed = served.http.get("/api/lessons").json()["lessons"]
    assert [lesson["name"] for lesson in listed][:2] == ["sliding-surface", "chattering"]
    assert all(set(lesson) == {"name", "title", "summary", "minutes", "steps"} for lesson in listed)
    for lesson in listed:
        whole = served.http.get(f"/api/lessons/{lesson['name']}").json()
        assert len(whole["steps"]) == lesson["steps"]


def test_a_step_can_be_reached_from_the_one_before_by_a_patch(served: Served) -> None:
    http = served.http
    steps = http.get("/api/lessons/boundary-layer").json()["steps"]
    http.post(f"/api/presets/{steps[0]['preset']}/load")
    for step in steps:
        live = http.get("/api/experiment").json()["experiment"]
        answer = http.patch("/api/experiment", json=difference(live, step["experiment"]))
        assert answer.status_code == 200, answer.text
        wanted = Experiment.from_document(step["experiment"])
        assert served.app_state.document.experiment == wanted


@pytest.mark.parametrize("name", ["nobody", "..%2fpaper", "%00"])
def test_unknown_lessons_are_not_found(served: Served, name: str) -> None:
    answer = served.http.get(f"/api/lessons/{name}")
    assert answer.status_code == 404
    assert set(answer.json()["error"]) == {"code", "message", "fields"}
