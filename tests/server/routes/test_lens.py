"""The lenses over HTTP, through a real server and its workers."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import LaneRun, simulate
from tests.server.conftest import Served

LENSES = {"sliding", "network", "chattering", "prediction"}


def seen(served: Served, **body: Any) -> dict[str, Any]:
    """Ask for a lens and return the answer."""
    response = served.http.post("/api/lens", json=body, timeout=120.0)
    assert response.status_code == 200, response.text
    answer: dict[str, Any] = json.loads(response.text, parse_constant=refuse)
    return answer


def refuse(name: str) -> float:
    raise AssertionError(f"{name} is no JSON")


def run_of(served: Served, lane: str, patch: dict[str, Any] | None = None) -> LaneRun:
    experiment: Experiment = served.app_state.document.experiment
    return simulate(experiment.patched(patch) if patch else experiment).lanes[lane]


def shorten(served: Served) -> None:
    """Make the runs of a test short."""
    patch = {"simulation": {"horizon": 1.0}}
    assert served.http.patch("/api/experiment", json=patch).status_code == 200


def test_numbers_are_those_of_simulate(served: Served) -> None:
    shorten(served)
    run = run_of(served, "RBFNN-NFTSM")
    answer = seen(served, lane="RBFNN-NFTSM")
    assert (answer["lane"], answer["horizon"], answer["frozen"]) == ("RBFNN-NFTSM", 1.0, None)
    assert answer["revision"] == served.app_state.document.revision
    chattering, metrics = answer["chattering"], run.metrics
    assert chattering["variation"] == pytest.approx(metrics.chattering, rel=1e-9)
    assert chattering["above"] == pytest.approx(metrics.high_frequency_torque, rel=1e-9)
    for j, joint in enumerate(answer["sliding"]["joints"]):
        assert joint["reaching_time"] == metrics.reaching_time[j]
        assert joint["e"][-1] == pytest.approx(run.e[-1, j], rel=1e-5)
    for j, joint in enumerate(answer["network"]["joints"]):
        assert np.array(joint["weights"]) == pytest.approx(run.final_weights[:, j], rel=1e-5)


def test_a_patch_is_looked_at_and_the_live_experiment_stays(served: Served) -> None:
    shorten(served)
    before = served.app_state.document.experiment
    patch = {"lanes": {"NFTSM": {"nu": 30.0}}}
    answer = seen(served, lane="NFTSM", patch=patch, lenses=["sliding"])
    assert set(answer) == {"revision", "lane", "horizon", "frozen", "sliding"}
    assert answer["sliding"]["joints"][0]["time_constant"] == pytest.approx(10.0 / 30.0)
    assert served.app_state.document.experiment is before


def test_an_experiment_sent_along_is_looked_at_though_the_live_one_has_no_such_lane(
    served: Served,
) -> None:
    shorten(served)
    before = served.app_state.document.experiment
    served.http.post("/api/presets/chattering-tanh/load")
    assert "RBFNN-SMC" not in served.app_state.document.experiment.lanes
    patch = {"lanes": {"RBFNN-SMC": {"switching": "sign"}}}
    document = before.document()
    answer = seen(served, lane="RBFNN-SMC", experiment=document, patch=patch, lenses=["chattering"])
    run = simulate(before.patched(patch)).lanes["RBFNN-SMC"]
    assert answer["chattering"]["variation"] == pytest.approx(run.metrics.chattering, rel=1e-9)


def test_a_law_without_a_network_answers_null(served: Served) -> None:
    shorten(served)
    assert seen(served, lane="NFTSM", lenses=["network"])["network"] is None


def test_sign_in_continuous_mode_holds_s_at_zero_without_chattering(served: Served) -> None:
    shorten(served)
    sharp, smooth = (
        seen(
            served,
            lane="RBFNN-NFTSM",
            patch={"lanes": {"RBFNN-NFTSM": {"switching": name}}},
            lenses=["chattering"],
        )
        for name in ("sign", "tanh")
    )
    assert sharp["chattering"]["variation"] < 2.0 * smooth["chattering"]["variation"]
    assert sharp["chattering"]["mae"] < smooth["chattering"]["mae"]


def test_sign_in_sampled_mode_is_compared_by_the_same_route(served: Served) -> None:
    served.http.post("/api/presets/chattering-tanh/load")
    served.http.patch("/api/experiment", json={"simulation": {"horizon": 1.0}})
    lane = next(iter(served.app_state.document.experiment.lanes))
    restless, smooth = (
        seen(served, lane=lane, patch={"lanes": {lane: {"switching": name}}}, lenses=["chattering"])
        for name in ("sign", "tanh")
    )
    assert restless["chattering"]["switches"] > 50.0 * smooth["chattering"]["switches"]


def test_a_lane_that_diverges_is_told_without_a_nan(served: Served) -> None:
    served.http.patch("/api/experiment", json={"simulation": {"mode": "sampled"}})
    answer = seen(served, lane="RBFNN-NFTSM")
    assert set(answer) >= LENSES
    assert "Joint" in answer["frozen"]["cause"]


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"lane": "Nobody"},
        {"lane": 3},
        {"lane": "NFTSM", "lenses": []},
        {"lane": "NFTSM", "lenses": ["microscope"]},
        {"lane": "NFTSM", "patch": {"lanes": {"NFTSM": {"nu": -1}}}},
        {"lane": "NFTSM", "patch": {"lanes": {"NFTSM": None}}},
        {"lane": "NFTSM", "telescope": True},
    ],
)
def test_bad_requests_are_refused_in_the_one_shape(served: Served, body: dict[str, Any]) -> None:
    response = served.http.post("/api/lens", json=body)
    assert response.status_code == 422
    assert set(response.json()["error"]) == {"code", "message", "fields"}


def test_the_threshold_is_that_of_the_lens_and_needs_no_run(served: Served) -> None:
    assert served.http.post("/api/presets/chattering-tanh/load").status_code == 200
    shorten(served)
    answer = served.http.post("/api/threshold", json={"lane": "tanh"}, timeout=120.0).json()
    lens = seen(served, lane="tanh", lenses=["prediction"])["prediction"]
    assert answer["revision"] == served.app_state.document.revision
    assert answer["lane"] == "tanh"
    assert answer["threshold"]["common"] == lens["threshold"]
    assert answer["threshold"]["joints"] == []
    for body in ({}, {"lane": "Nobody"}, {"lane": "tanh", "lenses": ["sliding"]}):
        response = served.http.post("/api/threshold", json=body)
        assert response.status_code == 422
        assert set(response.json()["error"]) == {"code", "message", "fields"}
