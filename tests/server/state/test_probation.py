"""Accepted gains stay where they hold, and go back by themselves where they don't."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect

from tests.server.conftest import Served

LANE = "NFTSM"
LONG = 300.0


@contextmanager
def listening(served: Served) -> Iterator[ClientConnection]:
    with connect(served.live, proxy=None, max_size=None) as socket:
        json.loads(socket.recv(timeout=LONG))
        yield socket


def notice(socket: ClientConnection) -> str:
    end = time.monotonic() + LONG
    while time.monotonic() < end:
        told = socket.recv(timeout=LONG)
        if isinstance(told, str) and (message := json.loads(told))["type"] == "notice":
            return str(message["message"])
    raise AssertionError("no notice came")


def prepare(served: Served, goals: dict[str, Any]) -> None:
    patch = {"goals": goals, "disturbance": {"constant": [5.0, 5.0, 3.0, 1.0, 1.0, 1.0]}}
    served.http.patch("/api/experiment", json=patch).raise_for_status()
    served.http.patch("/api/session", json={"speed": 10.0}).raise_for_status()


def simulated(served: Served) -> float:
    return float(served.http.get("/api/session").json()["time"])


def reach(served: Served, moment: float) -> None:
    end = time.monotonic() + LONG
    while simulated(served) < moment and time.monotonic() < end:
        time.sleep(0.02)


def accept(served: Served, **gains: Any) -> dict[str, Any]:
    body = {"lane": LANE, "patch": {"lanes": {LANE: gains}}, "client": "me"}
    answer = served.http.post("/api/studies/accept", json=body)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def gains(served: Served) -> dict[str, Any]:
    return dict(served.http.get("/api/experiment").json()["experiment"]["lanes"][LANE])


def decided(served: Served) -> None:
    watch = served.app_state.session.watches[LANE]
    end = time.monotonic() + LONG
    while not watch.decided and time.monotonic() < end:
        time.sleep(0.02)
    assert watch.decided


@contextmanager
def paused(served: Served) -> Iterator[None]:
    served.http.post("/api/session/pause").raise_for_status()
    end = time.monotonic() + LONG
    while served.http.get("/api/session").json()["playing"]:
        assert time.monotonic() < end, "the session goes on"
        time.sleep(0.02)
    yield
    served.http.post("/api/session/play").raise_for_status()


def near(bound: float, **more: Any) -> dict[str, Any]:
    return {"kind": "response", "channel": "e", "bound": bound, "priority": "hard", **more}


def test_gains_that_hold_stay(served: Served) -> None:
    prepare(served, {"near": near(0.5)})
    reach(served, 2.0)
    made = accept(served, k2=[200.0] * 6)
    assert made["watched"] == ["near"]
    decided(served)
    assert gains(served)["k2"] == 200.0 or gains(served)["k2"] == [200.0] * 6
    edits = served.http.get("/api/history").json()["edits"]
    assert edits[-1]["author"] == "me"


def test_gains_that_leave_a_hard_goal_go_back_and_say_why(served: Served) -> None:
    prepare(served, {"near": near(0.02)})
    reach(served, 3.0)
    before = gains(served)
    with listening(served) as socket:
        # A hundredth of every gain can't hold the load.
        accept(served, k1=1.0, k2=0.1)
        said = notice(socket)
    assert said.startswith(f"{LANE} went back to its former gains: |e| of joint ")
    assert "0.02 rad is allowed" in said
    assert gains(served) == before
    assert served.http.get("/api/history").json()["edits"][-1]["author"] == "probation"


def test_gains_after_gains_on_probation_go_back_to_those_before_both(served: Served) -> None:
    prepare(served, {"near": near(0.02)})
    reach(served, 3.0)
    before = gains(served)
    with listening(served) as socket:
        with paused(served):
            accept(served, k1=1.0, k2=0.1)
            accept(served, k1=1.1)
        assert notice(socket).startswith(f"{LANE} went back to its former gains")
    assert gains(served) == before


def test_each_lane_has_its_own_probation(served: Served) -> None:
    other = "RBFNN-SMC"
    prepare(served, {"near": near(0.02)})
    reach(served, 3.0)
    before = gains(served)
    with listening(served) as socket:
        with paused(served):
            accept(served, k1=1.0, k2=0.1)
            lanes = served.http.get("/api/experiment").json()["experiment"]["lanes"]
            body = {"lane": other, "patch": {"lanes": {other: lanes[other]}}}
            served.http.post("/api/studies/accept", json=body).raise_for_status()
        while not notice(socket).startswith(f"{LANE} went back"):
            pass
    assert gains(served) == before


def test_a_goal_that_was_taken_out_meanwhile_is_not_watched(served: Served) -> None:
    prepare(served, {"near": near(0.02)})
    reach(served, 3.0)
    with paused(served):
        accept(served, k1=1.0, k2=0.1)
        served.http.patch("/api/experiment", json={"goals": {"near": None}}).raise_for_status()
    decided(served)
    assert gains(served)["k1"] in (1.0, [1.0] * 6)


def test_a_lane_that_diverges_goes_back_and_runs_again(served: Served) -> None:
    served.http.post("/api/presets/chattering-tanh/load").raise_for_status()
    free = {"robot": {"torque_limit": None}, "goals": {"near": near(50.0)}}
    served.http.patch("/api/experiment", json=free).raise_for_status()
    before = served.http.get("/api/experiment").json()["experiment"]["lanes"]["tanh"]
    with listening(served) as socket:
        # One gain for all joints: what the base bears is too much for the wrist.
        body = {"lane": "tanh", "patch": {"lanes": {"tanh": {"k1": 900.0}}}}
        served.http.post("/api/studies/accept", json=body).raise_for_status()
        said = notice(socket)
    assert said.startswith("tanh went back to its former gains: ")
    assert served.http.get("/api/experiment").json()["experiment"]["lanes"]["tanh"] == before
    end = time.monotonic() + LONG
    while served.http.get("/api/session").json()["lanes"]["tanh"]["status"] != "running":
        assert time.monotonic() < end, "the lane stands still"
        time.sleep(0.02)


def test_a_mean_is_judged_at_the_end_and_a_figure_of_whole_runs_not_at_all(served: Served) -> None:
    figure = {"kind": "figure", "priority": "hard"}
    goals = {
        "quiet": {**figure, "figure": "mae", "bound": 1e-7},
        "itae": {**figure, "figure": "itae", "bound": 1e-9},
        "soft": near(1e-9, priority="soft"),
    }
    prepare(served, goals)
    reach(served, 1.0)
    with listening(served) as socket:
        made = accept(served, nu=1.5)
        assert (made["watched"], made["unwatched"]) == (["quiet"], ["itae"])
        accepted = simulated(served)
        said = notice(socket)
    assert "mean" in said
    assert simulated(served) >= accepted + 9.0


def test_what_the_old_gains_left_is_not_blamed_on_the_new_ones(served: Served) -> None:
    # The error starts outside of the bound and comes within it.
    prepare(served, {"near": near(0.05)})
    served.http.patch("/api/experiment", json={"simulation": {"initial_error": 0.3}})
    served.http.post("/api/session/reset").raise_for_status()
    accept(served, nu=2.0)
    decided(served)
    assert gains(served)["nu"] == 2.0


def test_whoever_changes_the_lane_ends_the_watch(served: Served) -> None:
    prepare(served, {"near": near(0.02)})
    reach(served, 1.0)
    served.http.post("/api/session/pause").raise_for_status()
    accept(served, k1=1.0, k2=0.1)
    served.http.patch("/api/experiment", json={"lanes": {LANE: {"k1": 2.0}}}).raise_for_status()
    served.http.post("/api/session/play").raise_for_status()
    decided(served)
    assert gains(served)["k1"] == 2.0


@pytest.mark.parametrize(
    "patch", [{"robot": {"lag": 0.0}}, {"lanes": {"RBFNN-SMC": {"nu": 1.0}}}, {"lanes": 3}, {}]
)
def test_nothing_but_the_lane_is_accepted(served: Served, patch: dict[str, Any]) -> None:
    before = served.http.get("/api/experiment").json()
    body = {"lane": LANE, "patch": patch}
    answer = served.http.post("/api/studies/accept", json=body)
    assert answer.status_code == 422
    assert answer.json()["error"]["fields"][0]["path"] == "patch"
    body = {"lane": "X", "patch": {"lanes": {"X": {}}}}
    assert served.http.post("/api/studies/accept", json=body).status_code == 422
    assert served.http.get("/api/experiment").json() == before
