"""The past over HTTP, through a real server: edits, moments, branches."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from slidetune.robot.kernels.workspace import Q
from tests.server.conftest import Served

LANE = "RBFNN-NFTSM"


def until(condition: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + 30.0
    while not condition():
        assert time.monotonic() < deadline, f"waited in vain until {what}"
        time.sleep(0.01)


def edits(served: Served) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = served.http.get("/api/history").json()["edits"]
    return found


def set_gain(served: Served, **gains: float) -> dict[str, Any]:
    """Change gains of the lane and return the entry that it made."""
    answer = served.http.patch("/api/experiment", json={"lanes": {LANE: gains}})
    assert answer.status_code == 200, answer.text
    return edits(served)[-1]


def run_past(served: Served, seconds: float) -> None:
    """Let the session run until so much of it is recorded."""

    def recorded() -> bool:
        past = served.http.get("/api/session/past").json()
        return past["to"] is not None and past["to"] - past["from"] >= seconds

    until(recorded, f"{seconds} s are recorded")


def looked_at(served: Served) -> float | None:
    """Return the time of the moment that the scene shows, ``None`` for the present."""
    moment = served.app_state.view.past
    return None if moment is None else moment.time


def test_an_edit_is_listed_with_who_when_which_and_what(served: Served) -> None:
    before = time.time()
    edit = set_gain(served, nu=2.5)
    assert edit["author"] == "http"
    assert before - 1.0 <= edit["time"] <= time.time() + 1.0
    assert edit["revision"] == served.app_state.document.revision
    assert edit["changes"] == [{"path": ["lanes", LANE, "nu"], "from": 0.3, "to": 2.5}]


def test_restoring_brings_back_the_experiment_and_lets_time_go_on(served: Served) -> None:
    first = set_gain(served, nu=2.0)
    wanted = served.app_state.document.experiment
    set_gain(served, c=3.0)
    epoch = served.app_state.session.epoch
    answer = served.http.post(f"/api/history/{first['number']}/restore")
    assert answer.status_code == 200
    assert served.app_state.document.experiment == wanted
    assert answer.json()["experiment"] == wanted.document()
    assert answer.json()["revision"] == served.app_state.document.revision
    assert served.app_state.session.epoch == epoch
    last = edits(served)[-1]
    assert last["changes"] == [{"path": ["lanes", LANE, "c"], "from": 3.0, "to": 10.0}]


def test_restoring_brings_back_a_lane_that_was_removed(served: Served) -> None:
    edit = set_gain(served, nu=2.0)
    served.http.patch("/api/experiment", json={"lanes": {"NFTSM": None}})
    assert "NFTSM" not in served.app_state.document.experiment.lanes
    served.http.post(f"/api/history/{edit['number']}/restore")
    assert "NFTSM" in served.app_state.document.experiment.lanes
    until(lambda: "NFTSM" in served.app_state.session.loop.lanes, "the lane runs again")


def test_an_edit_that_is_not_kept_cannot_be_restored(served: Served) -> None:
    answer = served.http.post("/api/history/999999/restore")
    assert answer.status_code == 404
    assert "999999" in answer.json()["error"]["message"]


def test_looking_back_pauses_and_shows_the_moment_before(served: Served) -> None:
    run_past(served, 0.5)
    wanted = 0.33
    answer = served.http.post("/api/session/look", json={"time": wanted})
    assert answer.status_code == 202
    shown = answer.json()["time"]
    assert wanted - 0.11 < shown <= wanted
    until(lambda: not served.app_state.session.playing, "the session pauses")
    assert looked_at(served) == shown
    served.http.post("/api/session/look", json={"time": None})
    assert looked_at(served) is None


def test_time_that_goes_on_ends_the_look_back(served: Served) -> None:
    run_past(served, 0.3)
    served.http.post("/api/session/look", json={"time": 0.1})
    until(lambda: not served.app_state.session.playing, "the session pauses")
    served.http.post("/api/session/play")
    until(lambda: looked_at(served) is None, "the scene shows the present")


def test_a_fork_goes_back_and_goes_on_with_a_variant_beside_its_origin(served: Served) -> None:
    run_past(served, 0.6)
    body = {"time": 0.3, "origin": LANE, "name": "Variant", "gains": {"nu": 30.0}}
    # Slowly, so that time has not come this far again before it is looked at.
    served.app_state.session.set_speed(0.1)
    present = served.app_state.session.loop.time
    answer = served.http.post("/api/session/fork", json=body)
    assert answer.status_code == 200, answer.text
    lanes = answer.json()["experiment"]["lanes"]
    assert lanes["Variant"] == {**lanes[LANE], "nu": 30.0}
    until(lambda: "Variant" in served.app_state.session.loop.lanes, "the lane is there")
    loop = served.app_state.session.loop
    assert loop.time < present
    served.app_state.session.set_speed(1.0)
    # One step old, both stand where the origin stood: what differs is their gains.
    until(lambda: served.app_state.session.playing and loop.time > 0.5, "time goes on")
    angles = {name: loop.lanes[name].work[Q].copy() for name in (LANE, "Variant")}
    assert not np.array_equal(angles[LANE], angles["Variant"])
    np.testing.assert_allclose(angles[LANE], angles["Variant"], atol=0.1)


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"origin": "Nobody"}, "origin"),
        ({"name": "NFTSM"}, "name"),
        ({"gains": {"nu": -1.0}}, "lanes.Variant.nu"),
        ({"time": -1.0}, "time"),
    ],
)
def test_a_bad_fork_is_refused_by_name_and_changes_nothing(
    served: Served, change: dict[str, Any], path: str
) -> None:
    before = served.app_state.document.experiment
    body = {"time": 0.0, "origin": LANE, "name": "Variant", **change}
    answer = served.http.post("/api/session/fork", json=body)
    assert answer.status_code == 422
    assert path in [field["path"] for field in answer.json()["error"]["fields"]]
    assert served.app_state.document.experiment is before


def test_going_back_gives_the_experiment_that_it_was_whoever_edits_meanwhile(
    served: Served,
) -> None:
    served.http.put("/api/experiment", json={"lanes": {"A": {"law": "smc"}}}).raise_for_status()
    document, done = served.app_state.document, threading.Event()
    before = document.experiment

    def edit() -> None:
        value = 0
        while not done.is_set():
            value = value % 50 + 1
            document.patch({"lanes": {"A": {"lambda_": float(value), "k2": float(value)}}})

    editor = threading.Thread(target=edit)
    editor.start()
    try:
        for _ in range(100):
            assert document.restore(before).experiment == before
    finally:
        done.set()
        editor.join()
