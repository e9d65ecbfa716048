"""Studies of the gains over HTTP: what a strip makes of positions that don't hold."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import simulate
from tests.server.conftest import Served


def strip(
    served: Served, lane: str, field: str, count: int = 6, **more: Any
) -> list[dict[str, Any]]:
    body = {"lane": lane, "field": field, "count": count, **more}
    answer = served.http.post("/api/studies/strip", json=body)
    assert answer.status_code == 200, answer.text
    return [json.loads(line) for line in answer.text.splitlines()]


def prepare(served: Served, preset: str, **patch: Any) -> None:
    assert served.http.post(f"/api/presets/{preset}/load").status_code == 200
    change = {"simulation": {"horizon": 1.0}, **patch}
    answer = served.http.patch("/api/experiment", json=change)
    assert answer.status_code == 200, answer.text


def test_positions_that_chatter_are_told_from_those_that_are_calm(served: Served) -> None:
    prepare(served, "chattering-tanh")
    rows = strip(served, "tanh", "epsilon")
    states = [row["state"] for row in rows]
    assert states[0] == "chattering"
    assert states[-1] == "good"
    assert states == sorted(states)
    chattering = [row["chattering"] for row in rows]
    assert chattering[0] > 10.0 * chattering[-1]


def test_positions_that_diverge_have_a_reason_and_no_figures(served: Served) -> None:
    # One gain for all joints: what the base bears is too much for the wrist.
    alike = {"tanh": {"k1": 8.0}}
    prepare(served, "chattering-tanh", robot={"torque_limit": None}, lanes=alike)
    rows = strip(served, "tanh", "k1")
    assert rows[0]["state"] == "good"
    assert rows[-1]["state"] == "diverged"
    assert "Joint" in rows[-1]["reason"]
    assert rows[-1]["mae"] is None


def test_a_strip_scales_all_joints_and_changes_nothing_live(served: Served) -> None:
    prepare(served, "chattering-tanh")
    before = served.app_state.document.experiment
    assert isinstance(before.lanes["tanh"].k1, tuple)
    rows = strip(served, "tanh", "k1", 3)
    shares = np.array([1.0, 1.0, 0.5, 0.1, 0.1, 0.1])
    scaled = np.array([row["patch"]["lanes"]["tanh"]["k1"] for row in rows])
    np.testing.assert_allclose(scaled, np.outer([0.0, 500.0, 1000.0], shares))
    assert served.app_state.document.experiment is before


def test_a_strip_of_one_joint_leaves_the_others_as_they_are(served: Served) -> None:
    prepare(served, "paper", lanes={"NFTSM": {"nu": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]}})
    rows = strip(served, "NFTSM", "nu", 3, joint=2)
    assert [row["value"] for row in rows] == pytest.approx([0.01, 1.0, 100.0])
    for row in rows:
        assert row["patch"]["lanes"]["NFTSM"]["nu"] == [1.0, row["value"], 3.0, 4.0, 5.0, 6.0]
        assert row["state"] == "good"
    assert len({row["mae"] for row in rows}) == 3
    rows = strip(served, "NFTSM", "c", 2, joint=6)
    assert rows[0]["patch"]["lanes"]["NFTSM"]["c"] == [10.0] * 5 + [0.05]


@pytest.mark.parametrize(("field", "joint"), [("alpha", 1), ("nu", 7), ("nu", 0)])
def test_a_share_that_no_joint_has_is_refused(served: Served, field: str, joint: int) -> None:
    prepare(served, "paper")
    body = {"lane": "NFTSM", "field": field, "joint": joint}
    answer = served.http.post("/api/studies/strip", json=body)
    assert answer.status_code == 422
    assert answer.json()["error"]["fields"][0]["path"] == "joint"


def test_gains_of_six_are_turned_all_in_proportion(served: Served) -> None:
    nu = [1.0, 2.0, 3.0, 4.0, 5.0, 95.0]
    prepare(served, "paper", lanes={"NFTSM": {"nu": nu}})
    answer = served.http.post("/api/studies/sensitivity", json={"lane": "NFTSM"})
    rows = [json.loads(line) for line in answer.text.splitlines()]
    down, up = [row["value"] for row in rows if row["name"] == "nu"]
    assert down == pytest.approx([0.9 * value for value in nu])
    assert up == pytest.approx([1.1 * value for value in nu[:5]] + [100.0])
    assert {row["state"] for row in rows} == {"good"}


def test_the_figures_are_those_of_a_whole_run(served: Served) -> None:
    prepare(served, "paper")
    row = strip(served, "NFTSM", "c", 3)[1]
    experiment = served.app_state.document.experiment.patched(row["patch"])
    metrics = simulate(only_lane(experiment, "NFTSM")).lanes["NFTSM"].metrics
    assert row["value"] == pytest.approx(np.sqrt(0.05 * 50.0))
    assert row["mae"] == metrics.mae.mean()
    assert row["max_error"] == metrics.max_error.max()
    assert row["flange_rms"] == metrics.flange_rms
