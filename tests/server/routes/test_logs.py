"""Logs over HTTP: brought, compared with the live experiment, followed, fitted, removed."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.guard.limits import MAX_LOGS
from slidetune.server.logs.store import MOST_SHOWN
from tests.server.conftest import Served

FRICTION = {"viscous_friction": [6.0, 6.0, 4.0, 2.0, 1.5, 1.0]}
LATE = 0.8
"""Time in [s] by which the log begins after the motion."""
TRUE: dict[str, Any] = {
    "title": "The arm as it is",
    "lanes": {"A": {"law": "smc", "k1": 20.0, "k2": 5.0}},
    "trajectory": {"kind": "sine"},
    "disturbance": {"constant": 0.0},
    "robot": {"inertials": "datasheet", **FRICTION},
    "simulation": {"horizon": 5.0, "initial_error": 0.0, "initial_velocity": "desired"},
}


@lru_cache(maxsize=1)
def run() -> Run:
    return simulate(Experiment.from_document(TRUE))


@lru_cache(maxsize=4)
def log_text(names: str = "q{}", torque: str = "tau{}", time: str = "t [s]") -> bytes:
    """Return a log of the run from ``LATE`` on, every second row, as CSV."""
    lane, first = run().lanes["A"], round(LATE / (run().time[1] - run().time[0]))
    rows = slice(first, None, 2)
    columns = [run().time[rows] - run().time[first], lane.q[rows], lane.tau[rows]]
    heads = [time, *(f.format(j) for f in (names, torque) if f for j in range(1, 7))]
    table = np.column_stack(columns)[:, : len(heads)]
    lines = [",".join(heads), *(",".join(f"{value:.9g}" for value in row) for row in table)]
    return ("\n".join(lines) + "\n").encode()


def send(served: Served, text: bytes, name: str = "arm.csv", **wanted: Any) -> httpx.Response:
    data = {"wanted": json.dumps(wanted)} if wanted else {}
    return served.http.post("/api/logs", files={"file": (name, text)}, data=data)


@pytest.fixture
def live(served: Served) -> Iterator[Served]:
    """The server with an arm without friction, and no log."""
    without = {**TRUE["robot"], "viscous_friction": 0.0}
    served.app_state.document.replace(Experiment.from_document({**TRUE, "robot": without}))
    yield served
    for log in served.http.get("/api/logs").json()["logs"]:
        served.http.delete(f"/api/logs/{log['number']}").raise_for_status()


def decoded(answer: httpx.Response) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    data = answer.content
    length = int.from_bytes(data[:4], "little")
    head = json.loads(data[4 : 4 + length])
    table = np.frombuffer(data, "<f4", offset=4 + length)
    table = table.reshape(1 + len(head["channels"]), head["lanes"][0]["points"])
    return head, dict(zip(["time", *head["channels"]], table, strict=True))


def test_a_log_is_brought_listed_and_forgotten(live: Served) -> None:
    report = send(live, log_text()).json()
    log = report["log"]
    assert report["reason"] is None
    assert (log["name"], log["arm"], log["shown"], log["shift"]) == (
        "arm.csv",
        "jaka_zu5",
        False,
        None,
    )
    assert log["rows"] == len(log_text().splitlines()) - 1
    assert log["rate"] == pytest.approx(500.0)
    assert log["holds"] == ["angles", "torques"]
    assert live.http.get("/api/logs").json()["logs"] == [log]
    before = live.http.get("/api/session").json()["results"]["logs"]
    assert live.http.delete(f"/api/logs/{log['number']}").status_code == 204
    assert live.http.get("/api/logs").json()["logs"] == []
    assert live.http.get("/api/session").json()["results"]["logs"] > before
    gone = live.http.get(f"/api/logs/{log['number']}/curves")
    assert (gone.status_code, gone.json()["error"]["code"]) == (404, "unknown_log")


def test_its_error_is_that_of_the_run_at_the_shift_that_is_found(live: Served) -> None:
    number = send(live, log_text()).json()["log"]["number"]
    nothing_yet = live.http.get(f"/api/logs/{number}/curves")
    assert nothing_yet.status_code == 204
    answer = live.http.post(f"/api/logs/{number}/curves", json={"shift": "auto"})
    head, columns = decoded(answer)
    # The angles alone tell it: an arm that follows late looks better than it is.
    assert head["shift"] == pytest.approx(LATE, abs=0.05)
    assert any("follows late" in remark for remark in head["remarks"])
    exact = live.http.post(f"/api/logs/{number}/curves", json={"shift": LATE})
    head, columns = decoded(exact)
    assert (head["shift"], head["rms"], head["against"]) == (LATE, None, "experiment")
    assert (head["begin"], head["end"]) == (pytest.approx(LATE), pytest.approx(5.0, abs=0.01))
    lane = run().lanes["A"]
    later = run().time >= LATE - 1e-9
    for joint in range(1, 7):
        error = lane.e[later, joint - 1]
        assert columns[f"e{joint}"].max() == pytest.approx(error.max(), rel=1e-2, abs=1e-6)
        assert columns[f"tau{joint}"].min() == pytest.approx(
            lane.tau[later, joint - 1].min(), rel=1e-2, abs=1e-2
        )
        assert np.isnan(columns[f"S{joint}"]).all()
    mae = np.abs(lane.e[later]).mean(axis=0)
    assert head["lanes"][0]["metrics"]["mae"] == pytest.approx(mae.tolist(), rel=1e-2)
    assert live.http.get(f"/api/logs/{number}/curves").content == exact.content
    assert live.http.get("/api/logs").json()["logs"][0]["shift"] == LATE


def test_a_shift_beyond_the_horizon_leaves_no_rows_and_says_so(live: Served) -> None:
    number = send(live, log_text()).json()["log"]["number"]
    head, columns = decoded(live.http.post(f"/api/logs/{number}/curves", json={"shift": 60}))
    assert len(columns["time"]) == 0
    assert any("no rows between 0 and 5 s" in remark for remark in head["remarks"])
    assert head["lanes"][0]["metrics"]["flange_rms"] is None


def test_no_more_logs_are_kept_or_shown_than_may_be(live: Served) -> None:
    numbers = [send(live, log_text()).json()["log"]["number"] for _ in range(MAX_LOGS)]
    full = send(live, log_text())
    assert (full.status_code, full.json()["error"]["code"]) == (507, "too_many_logs")
    for number in numbers[:MOST_SHOWN]:
        shown = live.http.patch(f"/api/logs/{number}", json={"shown": True})
        assert shown.json()["shown"] is True
    refused = live.http.patch(f"/api/logs/{numbers[MOST_SHOWN]}", json={"shown": True})
    assert refused.status_code == 422
    assert "hide arm.csv and arm.csv first" in refused.json()["error"]["message"]


def test_columns_that_nobody_names_are_mapped(live: Served) -> None:
    text = log_text("axis {} place", "", "stamp [s]")
    report = send(live, text).json()
    assert report["log"] is None
    assert report["columns"][:2] == ["stamp [s]", "axis 1 place"]
    assert report["joints"] == [f"joint_{number}" for number in range(1, 7)]
    assert report["mapping"] == {"time": "stamp [s]"}
    assert "joint_1" in report["reason"]["message"]
    mapping = {str(joint): f"axis {joint} place" for joint in range(1, 7)}
    read = send(live, text, mapping=mapping, angles="rad").json()
    assert read["log"]["holds"] == ["angles"]


@pytest.mark.parametrize(
    ("change", "row", "column", "words"),
    [
        ((b"\n0.002,", b"\n0.0,"), 3, "t [s]", "time stands still"),
        ((b"\n0.002,", b"\n0.002,nan,nan,"), 3, "", "has 15 cells where the header has 13"),
        ((b"\n0.002,", b"\noops,"), 3, "t [s]", "'oops' is no number"),
    ],
)
def test_what_is_wrong_has_row_and_column(
    live: Served, change: tuple[bytes, bytes], row: int, column: str, words: str
) -> None:
    report = send(live, log_text().replace(*change)).json()
    reason = report["reason"]
    assert (reason["row"], reason["column"]) == (row, column)
    assert words in reason["message"]
    assert reason["message"].startswith("arm.csv: ")
    assert live.http.get("/api/logs").json()["logs"] == []


@pytest.mark.parametrize(
    ("files", "data", "words"),
    [
        ({}, {"wanted": "{}"}, "multipart/form-data"),
        ({"other": ("a.csv", b"1")}, {}, "must be a CSV or MCAP file"),
        ({"file": ("..", b"1")}, {}, "no name of a file"),
        ({"file": ("a.xlsx", b"PK\x03\x04")}, {}, "save the sheet as CSV"),
        ({"file": ("a.csv", b"t,q1\n")}, {}, "a header and no rows"),
        ({"file": ("a.csv", b"t,q1\n")}, {"wanted": "["}, "isn't valid JSON"),
        ({"file": ("a.csv", b"t,q1\n")}, {"wanted": '{"angles": "gon"}'}, "must be one of"),
        ({"file": ("a.csv", b"t,q1\n")}, {"wanted": '{"mapping": {"1": 3}}'}, "must be a text"),
    ],
)
def test_what_is_no_log_is_refused_in_words(
    live: Served, files: Any, data: dict[str, str], words: str
) -> None:
    answer = live.http.post("/api/logs", files=files, data=data)
    assert answer.status_code == 422, answer.text
    assert words in answer.json()["error"]["message"]


def test_a_log_is_followed_after_one_edit(live: Served) -> None:
    number = send(live, log_text()).json()["log"]["number"]
    found = live.http.post(f"/api/logs/{number}/trajectory", json={}).json()
    assert found["waypoints"] * 6 <= 3000
    assert max(found["rms"]) < 1e-3
    assert found["patch"]["trajectory"]["origin"] == "arm.csv"
    assert any("comes to rest" in remark for remark in found["remarks"])
    changed = live.http.patch("/api/experiment", json=found["patch"])
    assert changed.json()["experiment"]["trajectory"]["kind"] == "recorded"
    head, columns = decoded(live.http.post(f"/api/logs/{number}/curves", json={"shift": "auto"}))
    assert head["shift"] == pytest.approx(0.0, abs=1e-3)
    assert np.abs(columns["e1"]).max() < 5e-3
    coarse = live.http.post(f"/api/logs/{number}/trajectory", json={"spacing": 1e-3})
    assert coarse.status_code == 422
    assert "spacing must be in" in coarse.json()["error"]["message"]


def test_limits_that_a_motion_exceeds_are_told_apart(live: Served) -> None:
    time = np.arange(400) * 0.01
    fast = np.zeros((400, 6))
    fast[:, 0] = 1.5 * np.sin(8.0 * time)
    lines = ["t [s],q1,q2,q3,q4,q5,q6"]
    lines += [
        ",".join(map(repr, [float(t), *row.tolist()])) for t, row in zip(time, fast, strict=True)
    ]
    number = send(live, "\n".join(lines).encode()).json()["log"]["number"]
    found = live.http.post(f"/api/logs/{number}/trajectory", json={}).json()
    (limit,) = found["limits"]
    assert "joint_1 moves at" in limit
    assert limit not in found["remarks"]


def test_friction_that_acted_is_recovered(live: Served) -> None:
    number = send(live, log_text()).json()["log"]["number"]
    body = {"parts": ["viscous_friction"]}
    found = live.http.post(f"/api/logs/{number}/identify", json=body).json()
    for joint, (estimate, true) in enumerate(
        zip(found["estimates"], FRICTION["viscous_friction"], strict=True)
    ):
        assert estimate["path"] == f"robot.viscous_friction.{joint}"
        assert estimate["present"] == 0.0
        assert estimate["value"] == pytest.approx(true, rel=0.1)
        assert estimate["low"] <= estimate["value"] <= estimate["high"]
    assert set(found["patch"]["robot"]) == {"viscous_friction"}
    assert len(found["time"]) == len(found["residual"][5]) == len(found["torque"][0])
    changed = live.http.patch("/api/experiment", json=found["patch"])
    assert changed.status_code == 200
    needless = live.http.post(f"/api/logs/{number}/identify", json={"constants": [1.0]})
    assert needless.status_code == 422
    assert "no currents" in needless.json()["error"]["message"]


def test_a_log_of_another_arm_is_not_compared(live: Served) -> None:
    number = send(live, log_text()).json()["log"]["number"]
    pendulum = {"robot": {"model": "pendulum"}, "lanes": {"A": {"law": "smc"}}}
    live.app_state.document.replace(Experiment.from_document(pendulum))
    for what in ("curves", "trajectory", "identify"):
        refused = live.http.post(f"/api/logs/{number}/{what}", json={})
        assert refused.status_code == 422
        assert "a log of the arm jaka_zu5" in refused.json()["error"]["message"]


def test_nothing_of_a_file_stays_behind(
    live: Served, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    live.app_state.logs.archive(0)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert send(live, log_text()).json()["log"]
    assert list(tmp_path.iterdir()) == []
