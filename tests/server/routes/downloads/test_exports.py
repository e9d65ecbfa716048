"""The live session and whole runs as files, through a real server."""

from __future__ import annotations

import io
import json
import threading
import time
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.simulate import simulate
from slidetune.server.exports.recorded import Recorded
from slidetune.server.exports.recorded_window import recorded_window
from slidetune.server.live.telemetry import rows_of
from slidetune.server.state import recent_edits
from tests.server.conftest import Served
from tests.server.exports.exported import CALM, WILD, short_experiment
from tests.server.exports.test_mcap_file import read

EDITS = (
    {"lanes": {"A": {"kp": 300.0}}},
    {"lanes": {"A": {"kp": 200.0, "kd": 30.0}}},
    {"disturbance": {"constant": 3.0}},
)
STEPS = 40


def step(served: Served, count: int) -> None:
    served.http.post("/api/session/step", json={"count": count}).raise_for_status()
    until_done(served)


def until_done(served: Served) -> None:
    """Wait until the session has obeyed all commands and made all steps."""
    end = time.monotonic() + 60.0
    while served.app_state.session.waiting_steps:
        assert time.monotonic() < end, "steps wait still"
        time.sleep(0.001)
    done = threading.Event()
    served.app_state.session.ask(done.set)
    assert done.wait(60.0)


@pytest.fixture
def edited(served: Served) -> list[Experiment]:
    """A session of 40 steps under each of four experiments, which are returned."""
    served.http.post("/api/session/pause").raise_for_status()
    lanes = {"A": CALM, "B": WILD}
    simulation = {"mode": "sampled", "horizon": 10.0}
    begun = Experiment.from_document({"lanes": lanes, "simulation": simulation})
    served.http.put("/api/experiment", json=begun.document()).raise_for_status()
    served.http.post("/api/session/pause").raise_for_status()
    served.http.post("/api/session/reset").raise_for_status()
    experiments = [begun]
    step(served, STEPS)
    for patch in EDITS:
        served.http.patch("/api/experiment", json=patch).raise_for_status()
        experiments.append(experiments[-1].patched(patch))
        step(served, STEPS)
    return experiments


def repeated(experiments: list[Experiment]) -> tuple[np.ndarray, np.ndarray]:
    """Times and telemetry of the same edits made on a closed loop of one's own."""
    loop = ClosedLoop(pack(experiments[0]), 4096)
    times = []
    for experiment in experiments:
        loop.adopt(pack(experiment))
        for _ in range(STEPS):
            times.append(loop.time)
            loop.step()
    return np.array(times), rows_of(loop, 0, loop.number)


def test_a_window_is_what_the_loop_did_under_every_edit(
    served: Served, edited: list[Experiment]
) -> None:
    window = recorded_window(served.app_state, 60.0)
    times, rows = repeated(edited)
    assert np.allclose(window.time, times, rtol=0.0, atol=1e-9)
    lane, joints = window.lanes["A"], 6
    assert np.allclose(window.desired["q_d"], rows[:, :joints], rtol=2e-7, atol=1e-7)
    for place, group in enumerate(("e", "de", "tau", "S"), 0):
        first = 2 * joints + 3 + place * joints
        assert np.allclose(lane[group], rows[:, first : first + joints], rtol=2e-7, atol=1e-9)
    assert np.allclose(lane["q"], window.desired["q_d"] - lane["e"], rtol=0.0, atol=1e-12)
    assert Experiment.from_document(window.experiment) == edited[0]
    assert [edit.time for edit in window.edits] == pytest.approx(
        [times[STEPS], times[2 * STEPS], times[3 * STEPS]]
    )
    assert [edit.content["patch"] for edit in window.edits][:2] == list(EDITS[:2])


def test_a_lane_that_stands_still_leaves_a_gap_and_says_why(
    served: Served, edited: list[Experiment]
) -> None:
    window = recorded_window(served.app_state, 60.0)
    freeze = served.app_state.session.state()["lanes"]["B"]
    still = np.isnan(window.lanes["B"]["q"][:, 0])
    assert np.array_equal(still, window.time > freeze["time"] + 1e-9)
    (remark,) = window.remarks
    assert (remark.topic, remark.content["remark"]) == ("B", freeze["cause"])
    assert remark.time == pytest.approx(freeze["time"])
    served.http.post("/api/session/reset", json={"lane": "B"}).raise_for_status()
    step(served, 1)
    (remark,) = recorded_window(served.app_state, 60.0).remarks
    assert remark.content["remark"] == "It left its bounds, and has been reset since."


def test_a_lane_that_stood_still_all_along_says_why_at_the_first_row(
    served: Served, edited: list[Experiment]
) -> None:
    window = recorded_window(served.app_state, 10 * served.app_state.session.loop.period)
    freeze = served.app_state.session.state()["lanes"]["B"]
    assert np.isnan(window.lanes["B"]["q"]).all()
    (remark,) = window.remarks
    assert (remark.topic, remark.content["remark"]) == ("B", freeze["cause"])
    assert remark.time == window.time[0]


def test_a_window_whose_first_edits_are_forgotten_begins_with_what_its_first_row_was_made_by(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recent_edits, "LENGTH", 2)
    served.http.post("/api/session/pause").raise_for_status()
    until_done(served)
    step(served, 5)
    for nu in (1.0, 2.0, 3.0):  # the first of them is forgotten, and there is no row of the second
        patch = {"lanes": {"NFTSM": {"nu": nu}}}
        served.http.patch("/api/experiment", json=patch).raise_for_status()
    step(served, 4)
    window = recorded_window(served.app_state, 60.0)
    assert len(window.time) == 4
    assert window.experiment == served.app_state.document.experiment.document()
    assert window.edits == ()


def test_every_format_holds_the_same_window(served: Served, edited: list[Experiment]) -> None:
    window = recorded_window(served.app_state, 60.0)
    files = {
        format: download(served, "window", {"format": format, "seconds": 60.0})
        for format in ("csv", "parquet", "mcap")
    }
    for table in (
        pd.read_csv(io.BytesIO(files["csv"])),
        pd.read_parquet(io.BytesIO(files["parquet"])),
    ):
        assert np.array_equal(table["time [s]"], window.time)
        assert np.array_equal(table["revision"], revisions(window))
        assert np.array_equal(table["B/tau2 [N·m]"], window.lanes["B"]["tau"][:, 1], equal_nan=True)
        flange = window.lanes["B"]["flange"][:, 0]
        assert np.array_equal(table["B/flange_x [m]"], flange, equal_nan=True)
    metadata = pq.read_schema(io.BytesIO(files["parquet"])).metadata
    edits = json.loads(metadata[b"edits"])
    assert [edit["patch"] for edit in edits] == [one.content["patch"] for one in window.edits]
    assert experiment_from_yaml(metadata[b"experiment"]) == edited[0]
    messages = read(files["mcap"])
    states = [state.position for _, state in messages["/a/joint_states"]]
    assert np.array_equal(states, window.lanes["A"]["q"])
    stamps = [stamp for stamp, _ in messages["/edits"]]
    assert stamps == [round(edit.time * 1e9) for edit in window.edits]
    gains = [(stamp, json.loads(said.data)["kp"]) for stamp, said in messages["/a/gains"]]
    first = round(window.time[0] * 1e9)
    assert gains == [(first, 400.0), (stamps[0], 300.0), (stamps[1], 200.0)]


def revisions(window: Recorded) -> np.ndarray:
    assert window.revision is not None
    return window.revision


def download(served: Served, what: str, wanted: dict[str, Any]) -> bytes:
    answer = served.http.post(f"/api/exports/{what}", json=wanted, timeout=120.0)
    assert answer.status_code == 200, answer.text
    name = f"slidetune-{what}.{wanted['format']}"
    assert answer.headers["content-disposition"] == f'attachment; filename="{name}"'
    return answer.content


def test_a_window_of_a_few_seconds_is_no_longer(served: Served, edited: list[Experiment]) -> None:
    period = served.app_state.session.loop.period
    table = pd.read_csv(
        io.BytesIO(download(served, "window", {"format": "csv", "seconds": 10 * period}))
    )
    assert len(table) == 11


def test_a_run_is_the_one_that_a_script_makes(served: Served) -> None:
    experiment = short_experiment()
    served.http.put("/api/experiment", json=experiment.document()).raise_for_status()
    patch = {"lanes": {"Lane 1": {"kp": 300.0}}}
    content = download(served, "run", {"format": "parquet", "patch": patch})
    table = pd.read_parquet(io.BytesIO(content))
    run = simulate(experiment.patched(patch))
    assert np.array_equal(table["Lane 1/q4 [rad]"], run.lanes["Lane 1"].q[:, 3])
    assert "revision" not in table


def test_what_is_wrong_is_said(served: Served) -> None:
    for what, wanted, path in (
        ("window", {"format": "xlsx"}, "format"),
        ("window", {"format": "csv", "seconds": 61.0}, "seconds"),
        ("window", {"format": "csv", "seconds": 0.0}, "seconds"),
        ("run", {"format": "csv", "patch": {"lanes": {"none": {"nu": 1.0}}}}, "lanes.none"),
    ):
        answer = served.http.post(f"/api/exports/{what}", json=wanted)
        assert answer.status_code == 422, answer.text
        assert [field["path"] for field in answer.json()["error"]["fields"]] == [path]


def test_a_session_that_has_made_no_step_has_no_window(served: Served) -> None:
    served.http.post("/api/session/pause").raise_for_status()
    until_done(served)
    served.http.put("/api/experiment", json=short_experiment().document()).raise_for_status()
    until_done(served)
    answer = served.http.post("/api/exports/window", json={"format": "csv"})
    assert answer.status_code == 422
    assert answer.json()["error"]["code"] == "no_rows"
