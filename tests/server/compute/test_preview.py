"""Whole responses and studies over HTTP: the numbers, who supersedes whom, what may break."""

from __future__ import annotations

import json
import struct
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import httpx
import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.knobs.knob import knob, knobs
from slidetune.robot.knobs.plan import EPSILONS, sensitivity, strip, switching_comparison
from slidetune.robot.knobs.variant import figures
from slidetune.robot.laws.terms.switching import SWITCHINGS
from slidetune.robot.loop.figures import STUDIED
from slidetune.robot.loop.response import response_channels
from slidetune.robot.loop.simulate import simulate
from tests.server.conftest import Served

Array = np.ndarray
Body = dict[str, Any]

SHORT = {"simulation": {"horizon": 1.0}}
SLOW = {
    "simulation": {"mode": "sampled", "control_rate": 4000.0, "plant_substeps": 99, "horizon": 20.0}
}
"""Next to the most that is run: a test can act meanwhile, however fast the machine is."""
CALM = {
    "robot": {"inertials": "datasheet", "armature": [0.6] * 3 + [0.15] * 3},
    "lanes": {
        "RBFNN-NFTSM": {
            "nu": 10,
            "c": 1,
            "mu": 0.1,
            "k1": [80, 80, 40, 8, 8, 8],
            "k2": [40, 40, 25, 5, 5, 5],
            "learning_rate": [40, 40, 20, 4, 4, 4],
        },
        "RBFNN-SMC": None,
        "NFTSM": None,
    },
}
"""Gains that a sampled loop at 1 kHz bears."""
WAIT = 120.0


def refuse_constant(name: str) -> float:
    raise AssertionError(f"{name} is no JSON")


def decoded(content: bytes) -> tuple[Body, dict[str, Array]]:
    """Return the JSON and, for each lane, its columns: time, then the channels. Shape (20, n)."""
    (length,) = struct.unpack_from("<I", content)
    head = json.loads(content[4 : 4 + length], parse_constant=refuse_constant)
    numbers = np.frombuffer(content, "<f4", offset=4 + length)
    lanes: dict[str, Array] = {}
    for lane in head["lanes"]:
        rows, points = 1 + len(head["channels"]), lane["points"]
        lanes[lane["name"]] = numbers[: rows * points].reshape(rows, points)
        path = numbers[rows * points : rows * points + 3 * lane["path_points"]]
        assert np.isfinite(path).all()
        numbers = numbers[rows * points + 3 * lane["path_points"] :]
    assert not len(numbers)
    return head, lanes


def preview(served: Served, **body: Any) -> tuple[Body, dict[str, Array]]:
    answer = served.http.post("/api/preview", json=body)
    assert answer.status_code == 200, answer.text
    return decoded(answer.content)


def solo(served: Served) -> Body:
    """Return the live experiment with its last lane alone."""
    document = served.app_state.document.experiment.document()
    return {**document, "lanes": {"NFTSM": document["lanes"]["NFTSM"]}}


def lines(served: Served, kind: str, **body: Any) -> list[Body]:
    """Return the rows of a study; every line must be one JSON object."""
    answer = served.http.post(f"/api/studies/{kind}", json=body)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].startswith("application/x-ndjson")
    assert answer.text.endswith("\n")
    rows = [json.loads(line, parse_constant=refuse_constant) for line in answer.text.splitlines()]
    assert [row["number"] for row in rows] == list(range(len(rows)))
    assert {row["count"] for row in rows} == {len(rows)}
    return rows


def assert_same_figures(row: Body, expected: Body) -> None:
    for name in STUDIED:
        assert row[name] == (None if expected[name] is None else pytest.approx(expected[name]))
    assert (row["state"], row["reason"]) == (expected["state"], expected["reason"])


def wait_for(condition: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + WAIT
    while not condition():
        assert time.monotonic() < deadline, f"not within {WAIT:g} s: {what}"
        time.sleep(0.005)


def wait_until_running(served: Served) -> None:
    """Wait until a worker has a task."""
    workers = served.app_state.workers
    wait_for(lambda: workers.tasks, "a task in a worker")


@pytest.fixture
def background() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(2) as pool:
        yield pool


def asked(background: ThreadPoolExecutor, served: Served, **body: Any) -> Future[httpx.Response]:
    def ask() -> httpx.Response:
        with httpx.Client(base_url=served.url, timeout=WAIT) as http:
            return http.post("/api/preview", json=body)

    return background.submit(ask)


# Whole responses


def test_metrics_are_those_of_simulate(served: Served) -> None:
    experiment = served.app_state.document.experiment.patched(SHORT)
    head, lanes = preview(served, patch=SHORT)
    run = simulate(experiment)
    assert (head["estimated"], head["horizon"]) == (True, 1.0)
    assert head["channels"] == list(response_channels(6))
    assert [lane["name"] for lane in head["lanes"]] == list(experiment.lanes)
    for lane in head["lanes"]:
        expected = run.lanes[lane["name"]].metrics.document()
        assert lane["metrics"].keys() == expected.keys()
        for name, value in expected.items():
            assert lane["metrics"][name] == pytest.approx(value), name
        assert lane["frozen"] is None
        assert lane["accuracy"] == run.lanes[lane["name"]].accuracy.document()
        assert lane["accuracy"]["error_estimate"] < 1e-4
        assert np.isfinite(lanes[lane["name"]]).all()


def test_columns_run_over_the_horizon_and_keep_every_peak(served: Served) -> None:
    run = simulate(served.app_state.document.experiment.patched(SHORT))
    _, lanes = preview(served, patch=SHORT)
    for name, (time_, *columns) in lanes.items():
        assert (time_[0], time_[-1]) == (0.0, 1.0)
        assert (np.diff(time_) > 0.0).all()
        by_channel = dict(zip(response_channels(6), columns, strict=True))
        for joint in range(6):
            whole = run.lanes[name].e[:, joint]
            thin = by_channel[f"e{joint + 1}"]
            assert (thin.min(), thin.max()) == pytest.approx((whole.min(), whole.max()))


def test_a_run_without_an_estimate_is_the_same_run(served: Served) -> None:
    patch = {**CALM, "simulation": {"mode": "sampled", "plant_substeps": 2, "horizon": 0.5}}
    without, columns = preview(served, patch=patch, estimate=False)
    with_one, same = preview(served, patch=patch)
    assert (without["estimated"], with_one["estimated"]) == (False, True)
    assert without["lanes"][0]["metrics"] == with_one["lanes"][0]["metrics"]
    assert without["lanes"][0]["accuracy"]["error_estimate"] is None
    assert with_one["lanes"][0]["accuracy"]["error_estimate"] > 0.0
    for name, table in columns.items():
        np.testing.assert_array_equal(table, same[name])


def test_an_estimate_that_is_known_is_told_to_who_asks_for_none(served: Served) -> None:
    patch = {**CALM, "simulation": {"horizon": 0.5}}
    known, _ = preview(served, patch=patch)
    again, _ = preview(served, patch=patch, estimate=False)
    assert again["lanes"] == known["lanes"]


def test_a_patch_is_tried_without_changing_the_live_document(served: Served) -> None:
    revision = served.app_state.document.revision
    plain, _ = preview(served, patch=SHORT)
    nu = {"lanes": {"NFTSM": {"nu": 30}}}
    other, _ = preview(served, patch={**SHORT, **nu})
    assert plain["revision"] == other["revision"] == revision == served.app_state.document.revision
    tried = simulate(served.app_state.document.experiment.patched({**SHORT, **nu})).lanes["NFTSM"]
    assert other["lanes"][2]["metrics"]["mae"] == pytest.approx(tried.metrics.mae.tolist())
    assert other["lanes"][2]["metrics"] != plain["lanes"][2]["metrics"]
    assert plain["lanes"][0]["metrics"] == other["lanes"][0]["metrics"]


def test_a_bad_value_is_refused_by_name(served: Served) -> None:
    answer = served.http.post("/api/preview", json={"patch": {"lanes": {"NFTSM": {"nu": -3}}}})
    assert answer.status_code == 422
    assert answer.json()["error"]["fields"][0]["path"] == "lanes.NFTSM.nu"


def test_a_diverged_lane_says_when_where_and_why_and_only_its_columns_end(served: Served) -> None:
    calm = served.app_state.document.experiment.patched({**CALM, **SHORT}).document()
    wild = {**calm["lanes"]["RBFNN-NFTSM"], "k1": 1000.0}
    document = {**calm, "lanes": {**calm["lanes"], "Wild": wild}}
    document["simulation"]["mode"] = "sampled"
    head, lanes = preview(served, experiment=document)
    answers = {lane["name"]: lane for lane in head["lanes"]}
    assert answers["RBFNN-NFTSM"]["frozen"] is None
    assert np.isfinite(lanes["RBFNN-NFTSM"]).all()
    frozen = answers["Wild"]["frozen"]
    freeze = simulate(Experiment.from_document(document)).lanes["Wild"].freeze
    assert freeze is not None
    assert (frozen["time"], frozen["joint"], frozen["cause"]) == (
        freeze.time,
        freeze.joint,
        freeze.cause,
    )
    assert answers["Wild"]["metrics"]["diverged_at"] == freeze.time
    time_, *columns = lanes["Wild"]
    assert np.isfinite(time_).all()
    after = time_ > freeze.time
    assert after.any()
    assert np.isnan(np.array(columns)[:, after]).all()


def test_paths_are_drawn_in_the_scene_left_there_and_taken_away(served: Served) -> None:
    paths = served.app_state.view.scene._responses
    preview(served, patch=SHORT, show=True)
    wait_for(lambda: paths._drawn == 3, "three paths in the scene")
    preview(served, patch=SHORT)
    preview(served, patch=SHORT, show=True, experiment=solo(served))
    wait_for(lambda: paths._drawn == 1, "one path in the scene")
    preview(served, patch=SHORT, show=False)
    wait_for(lambda: paths._drawn == 0, "no path in the scene")


# One request after another


def test_a_newer_request_of_a_client_supersedes_its_older(
    served: Served, background: ThreadPoolExecutor
) -> None:
    older = asked(background, served, patch={**CALM, **SLOW}, client="one")
    wait_until_running(served)
    newer, _ = preview(served, patch=SHORT, client="one")
    assert newer["horizon"] == 1.0
    answer = older.result(WAIT)
    assert (answer.status_code, answer.content) == (204, b"")


def test_clients_do_not_supersede_each_other(
    served: Served, background: ThreadPoolExecutor
) -> None:
    first = asked(background, served, patch=SHORT, client="one")
    second = asked(background, served, patch={**SHORT, "title": "two"}, client="two")
    assert [each.result(WAIT).status_code for each in (first, second)] == [200, 200]


def test_a_client_that_leaves_stops_its_run(served: Served) -> None:
    left = threading.Event()

    def leave() -> None:
        with (
            httpx.Client(base_url=served.url, timeout=0.3) as http,
            pytest.raises(httpx.ReadTimeout),
        ):
            http.post("/api/preview", json={"patch": {**CALM, **SLOW}, "client": "gone"})
        left.set()

    thread = threading.Thread(target=leave)
    thread.start()
    wait_until_running(served)
    assert left.wait(WAIT)
    thread.join(WAIT)
    wait_for(lambda: not served.app_state.workers.tasks, "the end of the run")


# Studies


def test_a_strip_tries_a_knob_along_its_track(served: Served) -> None:
    served.http.patch("/api/experiment", json=SHORT)
    experiment = served.app_state.document.experiment
    rows = lines(served, "strip", lane="NFTSM", field="nu", count=4)
    assert [row["value"] for row in rows] == pytest.approx(
        knob(experiment, "NFTSM", "nu").positions(4).tolist()
    )
    for row, trial in zip(rows, strip(experiment, "NFTSM", "nu", 4), strict=True):
        assert (row["name"], row["patch"]) == ("nu", trial.patch)
        assert row["revision"] == served.app_state.document.revision
        assert_same_figures(row, figures(experiment, "NFTSM", trial.patch))


def test_a_strip_of_six_shares_keeps_their_proportion_within_the_bounds(served: Served) -> None:
    shares = [1.0, 2.0, 4.0, 4.0, 2.0, 0.001]
    patch = {**SHORT, "lanes": {"NFTSM": {"mu": shares}}}
    served.http.patch("/api/experiment", json=patch)
    for row in lines(served, "strip", lane="NFTSM", field="mu", count=3):
        expected = [row["value"] * share / 4.0 for share in shares]
        assert row["patch"]["lanes"]["NFTSM"]["mu"] == pytest.approx(expected)


def test_sensitivity_begins_with_the_present_and_turns_every_knob_both_ways(served: Served) -> None:
    served.http.patch("/api/experiment", json=SHORT)
    experiment = served.app_state.document.experiment
    first, *rows = lines(served, "sensitivity", lane="NFTSM", change=0.1)
    assert (first["present"], first["patch"]) == (True, {})
    turned = [k.field for k in knobs(experiment, "NFTSM") if np.any(k.value)]
    assert [row["name"] for row in rows] == [field for field in turned for _ in range(2)]
    assert {row["factor"] for row in rows} == {0.9, 1.1}
    trials = sensitivity(experiment, "NFTSM")
    for row, trial in zip([first, *rows], trials, strict=True):
        assert_same_figures(row, figures(experiment, "NFTSM", trial.patch))


def test_switching_runs_along_the_layer_and_then_through_the_functions(served: Served) -> None:
    served.http.patch("/api/experiment", json=SHORT)
    experiment = served.app_state.document.experiment
    rows = lines(served, "switching", lane="RBFNN-NFTSM")
    curve, functions = rows[: len(EPSILONS)], rows[len(EPSILONS) :]
    assert [row["value"] for row in curve] == pytest.approx(EPSILONS.tolist())
    assert [row["value"] for row in functions] == ["tanh", "saturation", "sign"]
    trials = switching_comparison(experiment, "NFTSM")
    assert [trial.value for trial in trials][len(EPSILONS) :] == list(SWITCHINGS)
    power = experiment.patched({"lanes": {"NFTSM": {"reaching": "power"}}})
    assert "implicit" not in [trial.value for trial in switching_comparison(power, "NFTSM")]
    assert [row["value"] for row in functions if row["present"]] == ["tanh"]
    for row, trial in zip(rows, switching_comparison(experiment, "RBFNN-NFTSM"), strict=True):
        assert_same_figures(row, figures(experiment, "RBFNN-NFTSM", trial.patch))


@pytest.mark.parametrize(
    ("kind", "body", "known"),
    [
        ("strip", {"lane": "Nobody", "field": "nu"}, "RBFNN-NFTSM"),
        ("strip", {"lane": "NFTSM", "field": "courage"}, "epsilon"),
        ("sensitivity", {"lane": "Nobody"}, "RBFNN-NFTSM"),
        ("switching", {"lane": "Nobody"}, "RBFNN-NFTSM"),
    ],
)
def test_an_unknown_name_is_refused_and_lists_the_known(
    served: Served, kind: str, body: Body, known: str
) -> None:
    answer = served.http.post(f"/api/studies/{kind}", json=body)
    assert answer.status_code == 422
    assert known in answer.json()["error"]["message"]
