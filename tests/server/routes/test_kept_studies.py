"""Studies over HTTP: begun, followed, stopped, gone on with, read in every form, deleted."""

from __future__ import annotations

import csv
import io
import json
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import numpy as np
import pyarrow.parquet
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.study.outcome import outcome
from slidetune.robot.study.results import result_of
from slidetune.robot.study.study import Study
from slidetune.server.guard import limits
from tests.server.conftest import Served

LANE = "NFTSM"
GOALS = {
    "near": {"kind": "figure", "figure": "mae", "bound": 0.01},
    "quiet": {"kind": "figure", "figure": "chattering", "bound": 500.0},
}
GAINS = {"nu": {"low": 0.1, "high": 30.0}}
LONG = 300.0


def prepare(served: Served, horizon: float = 0.3) -> Experiment:
    ranges = {"payload": [0.0, 3.0]}
    patch = {"simulation": {"horizon": horizon}, "goals": GOALS, "uncertainty": ranges}
    served.http.patch("/api/experiment", json=patch).raise_for_status()
    return served.app_state.document.experiment


def begun(served: Served, kind: str = "tune", title: str = "", **wanted: Any) -> int:
    if kind == "tune":
        wanted = {"gains": GAINS, "draws": 0, **wanted}
    body = {"kind": kind, "title": title, "wanted": {"lane": LANE, **wanted}}
    answer = served.http.post("/api/studies", json=body)
    assert answer.status_code == 201, answer.text
    return int(answer.json()["id"])


def study(served: Served, number: int) -> dict[str, Any]:
    answer = served.http.get(f"/api/studies/{number}")
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def ended(served: Served, number: int, *states: str) -> dict[str, Any]:
    end = time.monotonic() + LONG
    while time.monotonic() < end:
        found = study(served, number)
        if found["state"] not in ("waiting", "running"):
            assert found["state"] in (states or ("done",)), found["message"]
            return found
        time.sleep(0.05)
    raise AssertionError("the study came to no end")


def events(served: Served, number: int, first: int = 0) -> list[dict[str, Any]]:
    told = []
    address = f"/api/studies/{number}/events?first={first}"
    with served.http.stream("GET", address, timeout=LONG) as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        for line in stream.iter_lines():
            if line.startswith("data: "):
                told.append(json.loads(line.removeprefix("data: ")))
    return told


def test_a_search_is_followed_to_its_end_and_tells_what_its_gains_do(served: Served) -> None:
    experiment = prepare(served)
    number = begun(served, trials=20, title="quick")
    told = events(served, number)
    entries = [entry for event in told for entry in event["entries"]]
    assert [entry["number"] for entry in entries] == list(range(20))
    assert told[-1]["state"] == "done"
    assert told[-1]["made"] == 20
    found = study(served, number)
    best = found["result"]["best"]
    assert found["title"] == "quick"
    assert found["wanted"]["trials"] == 20
    assert best["outcome"]["cost"] == min(entry["outcome"]["cost"] for entry in entries)
    again = outcome(experiment.patched(best["patch"]), LANE)
    # The search's cost is not that of one run.
    assert {**again.document(), "cost": best["outcome"]["cost"]} == best["outcome"]
    assert events(served, number, first=18)[0]["entries"] == entries[18:]
    listed = served.http.get("/api/studies").json()["studies"]
    assert listed[0]["id"] == number
    assert listed[0]["made"] == listed[0]["total"] == 20


def test_thousands_of_trials_are_summed_up_as_they_are(served: Served) -> None:
    experiment = prepare(served)
    number = begun(served, trials=2)
    ended(served, number)
    store, random = served.app_state.studies.store, np.random.default_rng(1)
    first = store.entries(number)[0]
    documents = []
    for place in range(2, 3000):
        cost, *figures = random.random(5).tolist()
        names = first["outcome"]["figures"]
        ratios = dict(zip(GOALS, random.random(2).round(3).tolist(), strict=True))
        told = {"cost": cost, "figures": dict(zip(names, figures, strict=True)), "ratios": ratios}
        values = {"nu": float(random.uniform(0.1, 30.0))}
        made = {**first["outcome"], **told, "kept": bool(place % 2)}
        documents.append({**first, "number": place, "values": values, "outcome": made})
    store.append(number, 2, [(one, None) for one in documents])
    found = study(served, number)
    whole = Study.from_document("tune", experiment, found["wanted"])
    entries = whole.read(store.texts(number))
    assert len(entries) == found["made"] == 3000
    assert found["result"] == json.loads(json.dumps(result_of(whole, entries)))
    best = min(entries, key=lambda one: one.outcome.cost)
    assert found["result"]["best"] == best.document()  # type: ignore[union-attr]
    assert len(found["result"]["front"]) > 1


def test_the_live_session_goes_on_while_a_study_is_read(served: Served) -> None:
    prepare(served)
    number = begun(served, trials=2)
    ended(served, number)
    served.http.post("/api/session/play").raise_for_status()
    with ThreadPoolExecutor(1) as threads:
        with served.app_state.studies.store._lock:  # so it is under way for as long as it is held
            asked = threads.submit(study, served, number)
            begin = served.http.get("/api/session").json()["time"]
            end = time.monotonic() + LONG
            while served.http.get("/api/session").json()["time"] <= begin + 0.2:
                assert time.monotonic() < end
            assert not asked.done()
        assert asked.result(LONG)["made"] == 2


def test_a_study_is_of_the_experiment_as_it_was(served: Served) -> None:
    before = prepare(served)
    number = begun(served, "robustness", draws=8)
    served.http.patch("/api/experiment", json={"lanes": {LANE: {"nu": 0.5}}}).raise_for_status()
    found = ended(served, number)
    assert found["experiment"]["lanes"] == before.document()["lanes"]
    first = served.http.get(f"/api/studies/{number}/entries").json()["entries"][0]
    from slidetune.robot.study.draws import drawn

    assert first["outcome"] == outcome(drawn(before, 0), LANE).document()


def test_bands_come_from_the_draws_and_are_empty_of_a_search(served: Served) -> None:
    prepare(served)
    number = begun(served, "robustness", draws=12)
    found = ended(served, number)
    bands = served.http.get(f"/api/studies/{number}/bands").json()
    assert bands["draws"] == 12
    e1 = bands["curves"]["e1"]
    assert len(bands["time"]) == len(e1["low"]) > 50
    for low, median, high in zip(e1["low"], e1["median"], e1["high"], strict=True):
        assert low <= median <= high
    assert found["result"]["quantiles"]["figures"]["mae"]["p5"] > 0.0
    search = begun(served, trials=2)
    ended(served, search)
    assert served.http.get(f"/api/studies/{search}/bands").json()["draws"] == 0


def test_the_worst_that_was_found_is_told_with_where_it_is(served: Served) -> None:
    prepare(served)
    number = begun(served, "worst", trials=12)
    found = ended(served, number)["result"]["worst_found"]
    entries = served.http.get(f"/api/studies/{number}/entries").json()["entries"]
    assert found["outcome"]["cost"] == max(entry["outcome"]["cost"] for entry in entries)
    assert 0.0 <= found["values"]["payload"] <= 3.0


@pytest.mark.parametrize(
    ("kind", "wanted"),
    [
        ("tune", {"trials": 3}),
        ("robustness", {"draws": 3}),
        ("worst", {"trials": 3}),
        ("sweep", {"axes": [{"field": "nu", "low": 1, "high": 9, "count": 3}]}),
    ],
)
def test_an_entry_is_of_an_experiment_that_does_just_that(
    served: Served, kind: str, wanted: dict[str, Any]
) -> None:
    prepare(served)
    number = begun(served, kind, **wanted)
    ended(served, number)
    entries = served.http.get(f"/api/studies/{number}/entries").json()["entries"]
    for place, entry in enumerate(entries):
        address = f"/api/studies/{number}/entries/{place}/experiment"
        document = served.http.get(address).raise_for_status().json()
        found = outcome(Experiment.from_document(document), LANE).document()
        if kind == "tune":  # whose cost is not that of one run
            found["cost"] = entry["outcome"]["cost"]
        assert found == entry["outcome"]
    beyond = served.http.get(f"/api/studies/{number}/entries/3/experiment")
    assert beyond.status_code == 404
    assert beyond.json()["error"]["message"] == f"study {number} has no entry 3"


def test_a_stopped_study_keeps_what_is_done_and_goes_on(served: Served) -> None:
    prepare(served, horizon=4.0)
    number = begun(served, trials=20_000)
    end = time.monotonic() + LONG
    while study(served, number)["made"] < 8 and time.monotonic() < end:
        time.sleep(0.02)
    assert served.http.post(f"/api/studies/{number}/stop").json()["state"] == "stopped"
    stopped = ended(served, number, "stopped")
    kept = served.http.get(f"/api/studies/{number}/entries").json()["entries"]
    assert len(kept) >= 8
    assert stopped["result"]["best"] is not None
    assert events(served, number)[-1]["state"] == "stopped"
    served.http.post(f"/api/studies/{number}/resume").raise_for_status()
    while study(served, number)["made"] <= len(kept) and time.monotonic() < end:
        time.sleep(0.02)
    served.http.post(f"/api/studies/{number}/stop").raise_for_status()
    more = served.http.get(f"/api/studies/{number}/entries").json()["entries"]
    assert more[: len(kept)] == kept
    assert [entry["number"] for entry in more] == list(range(len(more)))


def test_one_runs_at_a_time_and_a_waiting_one_can_be_deleted(served: Served) -> None:
    prepare(served, horizon=4.0)
    first, second = begun(served, trials=20_000), begun(served, trials=4)
    assert study(served, second)["state"] == "waiting"
    assert served.http.delete(f"/api/studies/{second}").status_code == 204
    assert served.http.get(f"/api/studies/{second}").status_code == 404
    third = begun(served, trials=2)
    # The first one is deleted while it runs: the third one's turn comes.
    assert served.http.delete(f"/api/studies/{first}").status_code == 204
    assert ended(served, third)["made"] == 2
    for method, rest in (("get", ""), ("post", "/stop"), ("post", "/resume"), ("delete", "")):
        answer = getattr(served.http, method)(f"/api/studies/{first}{rest}")
        assert answer.status_code == 404
        assert answer.json()["error"]["code"] == "unknown_study"


@pytest.mark.parametrize(
    ("body", "path"),
    [
        ({"kind": "tune", "wanted": {"lane": "X"}}, "lane"),
        ({"kind": "tune", "wanted": {"trials": 0}}, "trials"),
        ({"kind": "tune", "wanted": {"gains": {"wings": {}}}}, "gains.wings"),
        ({"kind": "tune", "wanted": {"sampler": "grid"}}, "sampler"),
        ({"kind": "guess"}, "kind"),
        ({"kind": "tune", "wanted": 3}, "wanted"),
        ({"kind": "tune", "more": 3}, "more"),
        ({"kind": "sweep", "wanted": {}}, "axes"),
        ({"kind": "tune", "experiment": {"lanes": {"A": {"law": "none"}}}}, "lanes.A.law"),
        ({"kind": "tune", "experiment": {"lanes": {"A": {"law": "nftsm"}}}}, "goals"),
    ],
)
def test_what_can_come_to_nothing_is_refused_by_field_and_not_kept(
    served: Served, body: dict[str, Any], path: str
) -> None:
    prepare(served)
    before = served.http.get("/api/studies").json()
    answer = served.http.post("/api/studies", json=body)
    assert answer.status_code == 422
    assert path in [field["path"] for field in answer.json()["error"]["fields"]]
    assert served.http.get("/api/studies").json() == before


def test_a_study_comes_as_a_file_in_every_form(served: Served) -> None:
    prepare(served)
    number = begun(served, trials=6, title='a "b": c')
    found = ended(served, number)
    entries = served.http.get(f"/api/studies/{number}/entries").json()["entries"]

    def file(form: str) -> httpx.Response:
        answer = served.http.get(f"/api/studies/{number}/download?format={form}")
        assert answer.status_code == 200, answer.text
        assert f"study-{number}." in answer.headers["content-disposition"]
        return answer

    preset = experiment_from_yaml(file("preset").content)
    best = found["result"]["best"]
    assert preset.lanes[LANE].model_dump()["nu"] == best["values"]["nu"]
    third = experiment_from_yaml(file("preset&trial=3").content)
    assert third.lanes[LANE].model_dump()["nu"] == entries[3]["values"]["nu"]
    lost = served.http.get(f"/api/studies/{number}/download?format=preset&trial=6")
    assert lost.status_code == 422
    assert "0 to 5" in lost.text
    rows = list(csv.DictReader(io.StringIO(file("csv").text)))
    assert [float(row["nu"]) for row in rows] == [entry["values"]["nu"] for entry in entries]
    errors = [entry["outcome"]["figures"]["mae"] for entry in entries]
    assert [float(row["mae [rad]"]) for row in rows] == errors
    table = pyarrow.parquet.read_table(io.BytesIO(file("parquet").content))
    assert table["mae"].to_pylist() == errors
    assert table.schema.field("mae").metadata[b"unit"] == b"rad"
    assert table["kept"].to_pylist() == [entry["outcome"]["kept"] for entry in entries]
    # What was downloaded can be begun again, and comes to the same.
    headers = {"content-type": "application/yaml"}
    again = served.http.post("/api/studies", content=file("yaml").content, headers=headers)
    assert again.status_code == 201, again.text
    assert again.json()["title"] == 'a "b": c'
    repeated = ended(served, again.json()["id"])
    assert repeated["result"] == found["result"]
    draws = begun(served, "robustness", draws=2)
    ended(served, draws)
    refused = served.http.get(f"/api/studies/{draws}/download?format=preset")
    assert refused.status_code == 422
    assert served.http.get(f"/api/studies/{draws}/download?format=parquet").status_code == 200


def test_so_many_studies_are_kept_and_no_more(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    prepare(served)
    number = begun(served, trials=1)
    ended(served, number)
    count = len(served.http.get("/api/studies").json()["studies"])
    monkeypatch.setattr("slidetune.server.routes.kept_studies.MAX_KEPT_STUDIES", count)
    answer = served.http.post("/api/studies", json={"kind": "tune", "wanted": {"lane": LANE}})
    assert answer.status_code == 507
    assert "delete one" in answer.json()["error"]["message"]
    assert count <= limits.MAX_KEPT_STUDIES


def test_what_is_no_number_is_no_study(served: Served) -> None:
    for method, rest in (("delete", "kinds"), ("get", "accept"), ("get", "strip")):
        answer = getattr(served.http, method)(f"/api/studies/{rest}")
        assert answer.status_code == 405
    assert served.http.get("/api/studies/none").status_code == 404
    assert served.http.get(f"/api/studies/{10**30}").status_code == 422


def test_kinds_are_described(served: Served) -> None:
    told = served.http.get("/api/studies/kinds").json()
    assert set(told) == {"tune", "robustness", "worst", "sweep"}
    assert told["tune"]["properties"]["trials"]["default"] == 200


def test_the_worst_is_replayed_in_3d_beside_the_nominal(served: Served) -> None:
    experiment = prepare(served)
    number = begun(served, "worst", trials=8)
    ended(served, number)
    answer = served.http.post(f"/api/studies/{number}/entries/3/replay")
    assert answer.json() == {"seconds": experiment.simulation.horizon}
    assert served.http.post(f"/api/studies/{number}/entries/8/replay").status_code == 404
    end = time.monotonic() + LONG
    while served.app_state.view.replaying and time.monotonic() < end:
        time.sleep(0.02)
    assert not served.app_state.view.replaying
