"""Studies of the gains over HTTP: what a strip makes of positions that don't hold."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from robot.response import only_lane, quickened
from robot.simulate import simulate
from tests.server.conftest import Served


def strip(served: Served, lane: str, field: str, count: int = 6) -> list[dict[str, Any]]:
    body = {"lane": lane, "field": field, "count": count}
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
    prepare(served, "chattering-tanh", robot={"torque_limit": None})
    rows = strip(served, "tanh", "k1")
    assert rows[0]["state"] == "good"
    assert rows[-1]["state"] == "diverged"
    assert "Joint" in rows[-1]["reason"]
    assert rows[-1]["mae"] is None


def test_a_strip_sets_all_joints_alike_and_changes_nothing_live(served: Served) -> None:
    prepare(served, "chattering-tanh")
    before = served.studio.document.experiment
    assert isinstance(before.lanes["tanh"].k1, tuple)
    rows = strip(served, "tanh", "k1", 3)
    assert [row["patch"]["lanes"]["tanh"]["k1"] for row in rows] == [0.0, 500.0, 1000.0]
    assert served.studio.document.experiment is before


def test_the_figures_are_those_of_a_whole_run(served: Served) -> None:
    prepare(served, "paper")
    row = strip(served, "NFTSM", "c", 3)[1]
    experiment = served.studio.document.experiment.patched(row["patch"])
    metrics = simulate(quickened(only_lane(experiment, "NFTSM"))).lanes["NFTSM"].metrics
    assert row["value"] == pytest.approx(np.sqrt(0.05 * 50.0))
    assert row["mae"] == metrics.mae.mean()
    assert row["max_error"] == metrics.max_error.max()
    assert row["flange_rms"] == metrics.flange_rms
