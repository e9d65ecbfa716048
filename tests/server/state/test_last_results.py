"""What the owner last asked for, as those who watch get it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from slidetune.robot.experiment.document import MAX_LANES, Experiment
from slidetune.server.state.last_results import LastResults
from tests.server.conftest import LANES, Served, serving

RESPONSE, LENS = "/api/results/response", "/api/results/lens"
SHORT: dict[str, Any] = {"lanes": LANES, "simulation": {"horizon": 0.2, "step": 0.002}}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server that asks for tokens; ``http`` speaks as its owner."""
    with serving(tmp_path_factory.mktemp("presets"), token=True) as server:
        yield server


@pytest.fixture
def owner(shared: Served) -> httpx.Client:
    """The owner, who has just begun an experiment with short runs."""
    shared.app_state.results = LastResults()
    shared.app_state.document.replace(Experiment.from_document(SHORT))
    return shared.http


@pytest.fixture
def watcher(shared: Served) -> Iterator[httpx.Client]:
    headers = {"authorization": f"Bearer {shared.policy.viewer_token}"}
    with httpx.Client(base_url=shared.url, headers=headers, timeout=60, trust_env=False) as client:
        yield client


def respond(owner: httpx.Client, **body: Any) -> bytes:
    return owner.post("/api/preview", json=body, timeout=120.0).raise_for_status().content


def look(owner: httpx.Client, lane: str, *lenses: str, **body: Any) -> dict[str, Any]:
    wanted = {"lane": lane, "lenses": lenses, **body}
    answer = owner.post("/api/lens", json=wanted, timeout=120.0).raise_for_status()
    return dict(answer.json())


def told(client: httpx.Client) -> dict[str, int]:
    return dict(client.get("/api/session").json()["results"])


def test_a_watcher_reads_the_owners_last_response_and_computes_nothing(
    shared: Served, owner: httpx.Client, watcher: httpx.Client
) -> None:
    assert watcher.get(RESPONSE).status_code == 204
    before = told(watcher)
    answer = respond(owner)
    assert told(watcher) == {**before, "response": before["response"] + 1}
    got = watcher.get(RESPONSE)
    assert (got.content, got.headers["content-type"]) == (answer, "application/octet-stream")
    # It stays when the experiment goes on, and says of which revision it is.
    owner.patch("/api/experiment", json={"lanes": {"NFTSM": {"nu": 3}}}).raise_for_status()
    assert watcher.get(RESPONSE).content == answer
    length = int.from_bytes(answer[:4], "little")
    head = json.loads(answer[4 : 4 + length])
    assert head["revision"] == shared.app_state.document.revision - 1
    assert watcher.post("/api/preview", json={}).status_code == 403


def test_only_an_exact_response_of_the_live_experiment_is_shared(
    owner: httpx.Client, watcher: httpx.Client
) -> None:
    respond(owner, estimate=False)
    respond(owner, patch={"lanes": {"NFTSM": {"nu": 3}}})
    respond(owner, experiment={**SHORT, "title": "Another"})
    assert watcher.get(RESPONSE).status_code == 204
    # The page sends along what it shows: that is the live experiment as well.
    answer = respond(owner, experiment=owner.get("/api/experiment").json()["experiment"])
    assert watcher.get(RESPONSE).content == answer


def test_a_watcher_reads_the_owners_last_look_at_each_lane_through_each_lens(
    owner: httpx.Client, watcher: httpx.Client
) -> None:
    wanted = {"lane": "NFTSM", "lens": "sliding"}
    assert watcher.get(LENS, params=wanted).status_code == 204
    seen = look(owner, "NFTSM", "sliding", "chattering")
    live = owner.get("/api/experiment").json()["experiment"]
    got = watcher.get(LENS, params=wanted).json()
    assert got.pop("experiment") == live
    assert got == {name: value for name, value in seen.items() if name != "chattering"}
    chattering = watcher.get(LENS, params={**wanted, "lens": "chattering"}).json()
    assert chattering["chattering"] == seen["chattering"]
    assert watcher.get(LENS, params={**wanted, "lens": "network"}).status_code == 204
    assert watcher.get(LENS, params={**wanted, "lane": "RBFNN-SMC"}).status_code == 204
    assert watcher.get(LENS, params={**wanted, "lens": "x-ray"}).status_code == 422
    look(owner, "NFTSM", "sliding", patch={"lanes": {"NFTSM": {"nu": 3}}})
    assert watcher.get(LENS, params=wanted).json() == {**got, "experiment": live}


def test_no_more_is_kept_than_one_look_at_each_lane_through_each_lens() -> None:
    results = LastResults()
    for revision in range(40):
        lanes = {f"lane {revision + place}": {"law": "smc"} for place in range(MAX_LANES)}
        experiment = Experiment.from_document({"lanes": lanes})
        for lane in lanes:
            for lens in ("sliding", "network", "chattering"):
                results.keep_looks(revision, experiment, lane, {"horizon": 1.0, lens: {}})
        results.keep_response(revision, b"response")
        assert len(results._looks) == 3 * MAX_LANES


def test_what_is_older_does_not_replace_what_is_newer() -> None:
    results, experiment = LastResults(), Experiment.from_document({"lanes": LANES})
    results.keep_response(7, b"newer")
    results.keep_response(6, b"older")
    assert results.response == b"newer"
    for revision in (7, 6):
        results.keep_looks(revision, experiment, "NFTSM", {"sliding": {"V": [revision]}})
    kept = results.look("NFTSM", "sliding")
    assert kept is not None
    assert json.loads(kept)["sliding"] == {"V": [7]}
    assert results.counts() == {"response": 1, "lens": 1}
