"""The HTTP contract, through a real server."""

from __future__ import annotations

import asyncio
import json
import time
from dataclasses import replace
from typing import Any

import jsonschema_rs
import pytest
import ruamel.yaml

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.loop.figures import FIGURES, figures_of
from slidetune.server.contract.live_messages import Figures, SamplingMargin
from slidetune.server.contract.schema import SchemaAnswer
from slidetune.server.state.published import published_schema
from tests.server.conftest import Served

YAML = {"content-type": "application/yaml"}
ERROR_KEYS = {"code", "message", "fields"}


def refusal(response: Any, status: int) -> dict[str, Any]:
    """Check the one shape of an error and return it."""
    assert response.status_code == status, response.text
    body = response.json()
    assert set(body) == {"error"}
    assert set(body["error"]) == ERROR_KEYS
    error: dict[str, Any] = body["error"]
    return error


def test_health_and_session_answer(served: Served) -> None:
    health = served.http.get("/api/health").json()
    assert health["state"] == "running"
    state = served.http.get("/api/session").json()
    assert state["playing"]
    assert set(state["lanes"]) == {"RBFNN-NFTSM", "RBFNN-SMC", "NFTSM"}


def test_health_tells_whether_whole_runs_are_compiled(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    def compiled() -> bool:
        return bool(served.http.get("/api/health").raise_for_status().json()["compiled"])

    assert compiled()
    document = served.app_state.document
    wrong_nominal = pack(document.experiment.patched({"disturbance": {"nominal_mismatch": 0.8}}))
    for packed in (
        replace(document.packed, chain=None),
        replace(wrong_nominal, nominal_chain=None),
    ):
        monkeypatch.setattr(document, "packed", packed)
        assert not compiled()
    monkeypatch.undo()
    assert compiled()


def test_schema_describes_every_law(served: Served) -> None:
    schema = served.http.get("/api/schema").json()
    assert {law["name"] for law in schema["x-laws"]} >= {"rbfnn_nftsm", "rbfnn_smc", "nftsm"}
    nu = schema["$defs"]["Nftsm"]["properties"]["nu"]
    assert (nu["minimum"], nu["maximum"], nu["unit"], nu["equation"]) == (0.01, 100, "1/s", "Eq. 5")


def test_schema_publishes_the_table_of_figures_beside_a_valid_schema(served: Served) -> None:
    schema = served.http.get("/api/schema").json()
    assert schema["x-figures"] == [figure.document() for figure in FIGURES.values()]
    jsonschema_rs.meta.validate(schema)
    beside = {
        key: value
        for key, value in schema.items()
        if key not in ("x-laws", "x-figures", "x-arm", "x-bounds")
    }
    assert beside == fitted_to(Experiment.model_json_schema(), 6)
    SchemaAnswer.model_validate(schema)


def fitted_to(node: Any, joints: int) -> Any:
    """Return a schema whose lists by joint are as long as an arm has joints."""
    if isinstance(node, list):
        return [fitted_to(one, joints) for one in node]
    if not isinstance(node, dict):
        return node
    length = {"minItems": joints, "maxItems": joints} if node.get("per_joint") else {}
    return {key: fitted_to(value, joints) for key, value in node.items()} | length


def test_the_schema_is_that_of_the_live_arm() -> None:
    for name, count in (("pendulum", 1), ("two_links", 2)):
        schema = published_schema(name)
        assert [len(one) for one in schema["x-arm"]["joints"]] == [2] * count
        start = schema["$defs"]["QuinticTrajectory"]["properties"]["start"]
        assert (start["minItems"], start["maxItems"], len(start["default"])) == (count,) * 3


def test_live_figures_are_those_that_the_table_says(served: Served) -> None:
    live = [figure for figure in figures_of("run") if figure.live]
    assert list(Figures.model_fields) == [figure.name for figure in live]
    told = Figures.model_json_schema()["properties"]
    for figure in live:
        assert (told[figure.name]["type"] == "array") == figure.per_joint
        assert told[figure.name]["description"] == figure.description
    margin = {figure.name for figure in figures_of("margin") if figure.live}
    assert margin <= SamplingMargin.model_fields.keys()


def test_a_patch_changes_the_document_and_counts_up(served: Served) -> None:
    before = served.app_state.document.revision
    answer = served.http.patch("/api/experiment", json={"lanes": {"NFTSM": {"nu": 30}}}).json()
    assert answer["revision"] == before + 1
    assert answer["experiment"]["lanes"]["NFTSM"]["nu"] == 30
    assert served.http.get("/api/experiment").json() == answer


def test_a_bad_patch_is_refused_and_loses_nothing(served: Served) -> None:
    before = served.http.get("/api/experiment").json()
    bad = {"lanes": {"NFTSM": {"nu": -3, "c": "ten"}}, "robot": {"wings": 2}}
    error = refusal(served.http.patch("/api/experiment", json=bad), 422)
    assert {field["path"] for field in error["fields"]} == {
        "lanes.NFTSM.nu",
        "lanes.NFTSM.c",
        "robot.wings",
    }
    assert served.http.get("/api/experiment").json() == before


@pytest.mark.parametrize("body", ["", "{", "[1]", "3", '"x"'])
def test_a_patch_that_is_no_object_is_refused(served: Served, body: str) -> None:
    headers = {"content-type": "application/json"}
    refusal(served.http.patch("/api/experiment", content=body, headers=headers), 422)


def test_exported_yaml_reads_back_to_the_live_experiment(served: Served) -> None:
    served.http.patch("/api/experiment", json={"lanes": {"NFTSM": {"nu": [1, 2, 3, 4, 5, 6]}}})
    answer = served.http.get("/api/experiment", params={"format": "yaml"})
    assert answer.headers["content-type"].startswith("application/yaml")
    assert "attachment" in answer.headers["content-disposition"]
    assert experiment_from_yaml(answer.text) == served.app_state.document.experiment


def test_yaml_and_json_replace_the_document_and_start_anew(served: Served) -> None:
    other = Experiment.from_document({"title": "Solo", "lanes": {"Solo": {"law": "smc"}}})
    yaml = experiment_to_yaml(other)
    answer = served.http.put("/api/experiment", content=yaml.encode(), headers=YAML)
    assert answer.status_code == 200
    assert served.app_state.document.experiment == other
    end = time.monotonic() + 10.0
    while list(served.http.get("/api/session").json()["lanes"]) != ["Solo"]:
        assert time.monotonic() < end
    document = other.patched({"title": "Again"}).document()
    assert served.http.put("/api/experiment", json=document).status_code == 200
    assert served.app_state.document.experiment.title == "Again"


def test_bad_yaml_names_line_and_field(served: Served) -> None:
    text = "slidetune: 1\nlanes:\n  A:\n    law: nftsm\n    nu: -3\n"
    error = refusal(served.http.put("/api/experiment", content=text.encode(), headers=YAML), 422)
    assert (error["fields"][0]["path"], error["fields"][0]["line"]) == ("lanes.A.nu", 5)


def test_yaml_is_parsed_beside_the_event_loop(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    parse, loops = ruamel.yaml.YAML.parse, []

    def watched(self: ruamel.yaml.YAML, stream: Any) -> Any:
        loops.append(asyncio._get_running_loop())
        return parse(self, stream)

    monkeypatch.setattr(ruamel.yaml.YAML, "parse", watched)
    text = b"title: parsed\n"
    for path in ("/api/experiment", "/api/presets/parsed"):
        assert served.http.put(path, content=text, headers=YAML).status_code == 200
    assert served.http.delete("/api/presets/parsed").status_code == 204
    assert len(loops) >= 2
    assert set(loops) == {None}


def test_an_oversized_body_is_refused(served: Served) -> None:
    body = b"# " + b"x" * 400_000
    refusal(served.http.put("/api/experiment", content=body, headers=YAML), 413)


def test_presets_are_saved_loaded_listed_and_deleted(served: Served) -> None:
    http = served.http
    listed = http.get("/api/presets").json()["presets"]
    assert {"paper", "realistic"} <= {preset["name"] for preset in listed}
    assert all(preset["description"] and not preset["problem"] for preset in listed)
    assert http.put("/api/presets/mine").status_code == 200
    refusal(http.put("/api/presets/mine"), 409)
    assert http.put("/api/presets/mine", params={"overwrite": True}).status_code == 200
    mine = http.get("/api/presets/mine").json()
    assert mine["experiment"] == served.app_state.document.experiment.document()
    assert mine["shipped"] is False
    loaded = http.post("/api/presets/paper/load").json()
    assert loaded["experiment"] == http.get("/api/presets/paper").json()["experiment"]
    assert http.delete("/api/presets/mine").status_code == 204
    refusal(http.get("/api/presets/mine"), 404)


@pytest.mark.parametrize("name", ["nobody", "..%2f..%2fetc%2fpasswd", "paper.yaml", "%00", "A B"])
def test_unknown_presets_are_not_found_and_list_the_known(served: Served, name: str) -> None:
    error = refusal(served.http.get(f"/api/presets/{name}"), 404)
    if "%2f" not in name:
        assert "paper" in error["message"]


def test_shipped_presets_are_read_only(served: Served) -> None:
    refusal(served.http.put("/api/presets/paper", params={"overwrite": True}), 409)
    refusal(served.http.delete("/api/presets/paper"), 409)


def test_commands_over_http_act(served: Served) -> None:
    http = served.http
    for command in ("pause", "reset", "step", "kick", "play"):
        answer = http.post(f"/api/session/{command}")
        assert answer.status_code == 202
        assert set(answer.json()) == {"accepted", "waiting_steps"}
    assert http.patch("/api/session", json={"speed": 2.0}).json()["speed"] == 2.0
    refusal(http.patch("/api/session", json={"speed": 0}), 422)
    refusal(http.post("/api/session/kick", json={"torque": [1, 2, 3]}), 422)
    refusal(http.post("/api/session/step", json={"count": 0}), 422)
    refusal(http.post("/api/session/fly"), 404)


def test_metrics_answer_for_every_lane(served: Served) -> None:
    lanes = served.http.get("/api/metrics").json()["lanes"]
    assert set(lanes) == {"RBFNN-NFTSM", "RBFNN-SMC", "NFTSM"}


def test_the_page_and_its_parts_come_from_this_server_alone(served: Served) -> None:
    page = served.http.get("/")
    assert page.status_code == 200
    assert "https://" not in page.text
    assert served.http.get("/static/plotly.min.js").status_code == 200
    for path in ("/docs", "/docs/swagger-ui.css", "/docs/swagger-ui-bundle.js", "/openapi.json"):
        assert served.http.get(path).status_code == 200, path
    refusal(served.http.get("/docs/../../pyproject.toml"), 404)


def test_openapi_describes_every_route_with_answers(served: Served) -> None:
    paths = served.http.get("/openapi.json").json()["paths"]
    assert len(paths) >= 12
    for path, methods in paths.items():
        for method, operation in methods.items():
            assert operation.get("summary"), (method, path)
            assert operation.get("description"), (method, path)
            assert operation["responses"], (method, path)


def test_answers_are_strict_json(served: Served) -> None:
    def refuse(name: str) -> float:
        raise AssertionError(name)

    for path in ("/api/metrics", "/api/session", "/api/experiment", "/api/schema"):
        json.loads(served.http.get(path).text, parse_constant=refuse)


def test_one_lane_is_reset_alone_and_an_unknown_one_refused(served: Served) -> None:
    served.http.post("/api/session/step", json={"count": 20}).raise_for_status()
    wrong = served.http.post("/api/session/reset", json={"lane": "NFTMS"})
    assert "there are: RBFNN-NFTSM" in refusal(wrong, 422)["fields"][0]["message"]
    assert served.http.post("/api/session/reset", json={"lane": "NFTSM"}).status_code == 202
    end = time.monotonic() + 20.0
    while (state := served.http.get("/api/session").json())["lanes"]["NFTSM"]["began"] == 0.0:
        assert time.monotonic() < end, "the lane was not reset"
        time.sleep(0.02)
    assert state["time"] >= state["lanes"]["NFTSM"]["began"]
    assert state["lanes"]["RBFNN-SMC"]["began"] == 0.0
    assert served.http.get("/api/metrics").json()["lanes"]["NFTSM"]["since"]["reason"] == "reset"
