"""A viewer sees everything and changes nothing, whichever way it is tried."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import httpx
import msgspec
import pytest
import viser
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.server.guard.access_policy import AccessPolicy, Role, policy_for
from slidetune.server.scene.lock import KEY_HEADER
from slidetune.server.scene.relay import VIEWERS_MESSAGES, viewer_may_say
from tests.server.conftest import Served, serving

EVERYTHING_THAT_READS = [
    "/",
    "/static/main.js",
    "/static/plotly.min.js",
    "/docs",
    "/docs/live",
    "/openapi.json",
    "/asyncapi.json",
    "/api/health",
    "/api/schema",
    "/api/experiment",
    "/api/experiment?format=yaml",
    "/api/session",
    "/api/session/past",
    "/api/metrics",
    "/api/presets",
    "/api/presets/paper",
    "/api/arms",
    "/api/arms/lane?law=smc",
    "/api/logs",
    "/api/history",
    "/api/link",
    "/api/lessons",
    "/api/studies",
    "/api/studies/kinds",
    "/scene/",
]
OF_A_STUDY = ("", "/entries", "/bands", "/events", "/download", "/entries/{place}/experiment")
"""That of an entry comes after what waits for the study's end."""
NOTHING_YET = ["/api/results/response", "/api/results/lens?lane=NFTSM&lens=sliding"]
"""What the owner has to ask for first."""
CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (1.0, 1.0, 1.0),
    "fov": 0.7,
    "near": 0.1,
    "far": 10.0,
    "image_height": 700,
    "image_width": 900,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server that asks for tokens."""
    with serving(tmp_path_factory.mktemp("presets"), token=True) as server:
        yield server


def token_of(server: Served, role: Role) -> str:
    token = server.policy.token if role == "owner" else server.policy.viewer_token
    assert token is not None
    return token


@pytest.fixture
def viewer(shared: Served) -> Iterator[httpx.Client]:
    headers = {"authorization": f"Bearer {token_of(shared, 'viewer')}"}
    with httpx.Client(
        base_url=shared.url, headers=headers, timeout=60.0, trust_env=False
    ) as client:
        yield client


def line(server: Served, role: Role, path: str = "/api/live") -> ClientConnection:
    address = f"ws://127.0.0.1:{server.policy.port}{path}?token={token_of(server, role)}"
    protocol = [Subprotocol(f"viser-v{viser.__version__}")] if path == "/scene" else None
    return connect(
        address, subprotocols=protocol, compression=None, max_size=None, max_queue=None, proxy=None
    )


def hear(client: ClientConnection, *kinds: str) -> dict[str, Any]:
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        raw = client.recv(timeout=20.0)
        if isinstance(raw, str) and (message := json.loads(raw))["type"] in kinds:
            return dict(message)
    pytest.fail(f"no {kinds} message came")


def test_two_secrets_are_drawn_and_neither_is_shown_by_accident() -> None:
    policies = [policy_for("0.0.0.0", 8000) for _ in range(3)]
    secrets = {secret for p in policies for secret in (p.token, p.viewer_token)}
    assert len(secrets) == 6
    for policy in policies:
        assert policy.token is not None
        assert policy.viewer_token is not None
        assert policy.token not in repr(policy)
        assert policy.viewer_token not in repr(policy)
        assert policy.role_of(policy.token) == "owner"
        assert policy.role_of(policy.viewer_token) == "viewer"
        assert policy.role_of(policy.token + "x") is policy.role_of("") is policy.role_of(None)
        assert policy.role_of(None) is None


def test_on_loopback_everybody_is_the_owner_unless_a_token_is_wanted() -> None:
    open_policy = policy_for("127.0.0.1", 8000)
    assert (open_policy.token, open_policy.viewer_token) == (None, None)
    assert open_policy.role_of(None) == "owner"
    assert open_policy.addresses("viewer") == []
    closed = policy_for("127.0.0.1", 8000, token=True)
    assert closed.role_of(None) is None
    assert closed.allows_host("dashboard.example", "https")  # behind a proxy of that name
    assert not open_policy.allows_host("dashboard.example", "https")


def test_each_role_has_addresses_of_its_own() -> None:
    policy = AccessPolicy("192.168.1.5", 8000, "mine", "theirs")
    assert policy.addresses("owner") == ["http://192.168.1.5:8000/?token=mine"]
    assert policy.addresses("viewer") == ["http://192.168.1.5:8000/?token=theirs"]


@pytest.mark.parametrize("path", EVERYTHING_THAT_READS)
def test_a_viewer_reads_everything(viewer: httpx.Client, path: str) -> None:
    assert viewer.get(path).status_code == 200


@pytest.mark.parametrize("path", NOTHING_YET)
def test_a_viewer_is_told_that_there_is_no_result_yet(viewer: httpx.Client, path: str) -> None:
    assert viewer.get(path).status_code == 204


def test_the_list_of_what_reads_is_complete(shared: Served) -> None:
    paths = shared.http.get("/openapi.json").json()["paths"]
    reading = {path for path, methods in paths.items() if "get" in methods}
    tried = [*EVERYTHING_THAT_READS, *NOTHING_YET]
    missing = reading - {path.partition("?")[0] for path in tried}
    of_one_study = {f"/api/studies/{{number}}{rest}" for rest in OF_A_STUDY}
    of_one_log = "/api/logs/{number}/curves"
    assert missing == {"/api/presets/{name}", "/api/lessons/{name}", of_one_log, *of_one_study}


def test_a_viewer_reads_and_follows_studies(shared: Served, viewer: httpx.Client) -> None:
    experiment = {
        "lanes": {"A": {"law": "nftsm"}},
        "simulation": {"horizon": 0.1},
        "uncertainty": {"payload": [0.0, 1.0]},
    }
    body = {"kind": "robustness", "wanted": {"draws": 1}, "experiment": experiment}
    number = shared.http.post("/api/studies", json=body).json()["id"]
    for rest in OF_A_STUDY:
        query = "?format=csv" if rest == "/download" else ""
        address = f"/api/studies/{number}{rest.format(place=0)}{query}"
        assert viewer.get(address).status_code == 200
    assert viewer.post(f"/api/studies/{number}/stop").status_code == 403
    assert viewer.delete(f"/api/studies/{number}").status_code == 403


def changing(server: Served) -> list[tuple[str, str]]:
    paths = server.http.get("/openapi.json").json()["paths"]
    return [
        (method.upper(), path.replace("{name}", "paper").replace("{number}", "1"))
        for path, methods in paths.items()
        for method in methods
        if method != "get"
    ]


def test_no_route_changes_anything_for_a_viewer(shared: Served, viewer: httpx.Client) -> None:
    routes = changing(shared)
    assert len(routes) > 15
    before = shared.http.get("/api/experiment").json()
    body = {"lanes": {"NFTSM": {"nu": 3}}}
    for method, path in [*routes, ("POST", "/"), ("PUT", "/static/main.js"), ("LOCK", "/api/x")]:
        answer = viewer.request(method, path, json=body)
        assert answer.status_code == 403, (method, path)
        error = answer.json()["error"]
        assert (error["code"], error["fields"]) == ("watch_only", [])
        assert "not change anything" in error["message"]
    assert shared.http.get("/api/experiment").json() == before


def test_the_owner_may_do_what_a_viewer_may_not(shared: Served) -> None:
    changed = shared.http.patch("/api/experiment", json={"lanes": {"NFTSM": {"nu": 12}}})
    assert changed.json()["experiment"]["lanes"]["NFTSM"]["nu"] == 12
    text = experiment_to_yaml(shared.app_state.document.experiment)
    assert shared.http.put("/api/presets/mine", content=text).status_code == 200
    assert shared.http.delete("/api/presets/mine").status_code == 204


def test_each_is_told_its_role(shared: Served, viewer: httpx.Client) -> None:
    assert viewer.get("/api/health").json()["role"] == "viewer"
    assert shared.http.get("/api/health").json()["role"] == "owner"
    for role in ("viewer", "owner"):
        with line(shared, role) as client:
            assert hear(client, "hello")["role"] == role


@pytest.mark.parametrize(
    "message",
    [
        {"type": "patch", "patch": {"lanes": {"NFTSM": {"nu": 3}}}},
        {"type": "play"},
        {"type": "pause"},
        {"type": "reset"},
        {"type": "step", "count": 3},
        {"type": "kick"},
        {"type": "speed", "speed": 2},
        {"type": "select", "lane": "NFTSM"},
        {"type": "view", "exaggeration": 9},
        {"type": "lane", "origin": "NFTSM", "name": "B"},
        {"type": "dance"},
    ],
)
def test_a_viewer_is_told_that_its_messages_do_nothing(
    shared: Served, message: dict[str, Any]
) -> None:
    def standing() -> tuple[object, ...]:
        document, view, state = (
            shared.app_state.document,
            shared.app_state.view,
            shared.app_state.state(),
        )
        seen = (view.selected, view.exaggeration, view.ghosts)
        return document.revision, *seen, state["playing"], state["speed"], state["epoch"]

    before = standing()
    with line(shared, "viewer") as client:
        hear(client, "hello")
        client.send(json.dumps({**message, "id": "mine"}))
        refusal = hear(client, "error", "patch")
        assert (refusal["type"], refusal["id"]) == ("error", "mine")
        assert refusal["error"]["code"] == "watch_only"
        assert "not change anything" in refusal["error"]["message"]
        hear(client, "state")  # the line stays open
    assert standing() == before


def test_a_viewer_follows_what_the_owner_does(shared: Served) -> None:
    with line(shared, "viewer") as watcher, line(shared, "owner") as hand:
        hear(watcher, "hello")
        hand.send(json.dumps({"type": "patch", "id": 1, "patch": {"lanes": {"NFTSM": {"nu": 21}}}}))
        assert hear(watcher, "patch")["experiment"]["lanes"]["NFTSM"]["nu"] == 21
        while isinstance(watcher.recv(timeout=20.0), str):
            pass  # until a frame comes


@pytest.mark.parametrize("role", ["owner", "viewer"])
def test_only_the_owner_pulls_the_arm_through_the_scene(shared: Served, role: Role) -> None:
    scene = shared.app_state.view.scene
    place = {"wxyz": (1.0, 0.0, 0.0, 0.0), "position": (0.5, 0.5, 0.9), "name": "/pull"}
    there = (0.0, float(len(role)), 5.0)
    with line(shared, role, "/scene") as browser:
        # Viser hears in order: once it knows the last camera it has heard of the pull, or never.
        for message in (
            CAMERA,
            {"type": "TransformControlsDragStartMessage", "name": "/pull"},
            {"type": "TransformControlsUpdateMessage", **place},
            {**CAMERA, "position": there},
        ):
            browser.send(msgspec.msgpack.encode(message))
        end = time.monotonic() + 20.0
        while there not in [tuple(c.camera.position) for c in scene._viewer.get_clients().values()]:
            assert time.monotonic() < end, "Viser never heard where the camera is"
            browser.recv(timeout=20.0)
        assert (scene.pull() is not None) is (role == "owner")


@pytest.mark.parametrize(
    "data",
    [
        "ViewerCameraMessage",
        b"",
        b"\xc1",
        b"\x00" * 40,
        b"\x81" * 5000,
        msgspec.msgpack.encode(["ViewerCameraMessage"]),
        msgspec.msgpack.encode({"type": ["ViewerCameraMessage"]}),
        msgspec.msgpack.encode({"type": b"ViewerCameraMessage"}),
        msgspec.msgpack.encode({"kind": "ViewerCameraMessage"}),
        msgspec.msgpack.encode(CAMERA) + b"\xc0",
        # Twice the same key: the last one counts, for Viser as for us.
        b"\x82\xa4type\xb3ViewerCameraMessage\xa4type\xafShareUrlRequest",
    ],
)
def test_nothing_but_a_camera_passes_for_one(data: str | bytes) -> None:
    assert not viewer_may_say(data)
    assert viewer_may_say(msgspec.msgpack.encode(CAMERA))


def test_a_viewer_may_say_nothing_else_that_viser_listens_to() -> None:
    known = viser._messages.Message._subclass_from_type_string()
    assert len(known) > 50
    allowed = {name for name in known if viewer_may_say(msgspec.msgpack.encode({"type": name}))}
    assert allowed == set(VIEWERS_MESSAGES)


@pytest.mark.parametrize("key", ["", "wrong"])
def test_visers_own_port_is_locked(shared: Served, key: str) -> None:
    address = f"ws://127.0.0.1:{shared.app_state.view.scene.port}/"
    protocol = [Subprotocol(f"viser-v{viser.__version__}")]
    before = len(shared.app_state.view.scene._viewer.get_clients())
    headers = {KEY_HEADER: key} if key else {}
    with connect(
        address, subprotocols=protocol, additional_headers=headers, max_size=None, proxy=None
    ) as stranger:
        with suppress(ConnectionClosed):
            stranger.send(msgspec.msgpack.encode(CAMERA))
        with pytest.raises(ConnectionClosed) as closed:
            stranger.recv(timeout=20.0)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1008
    assert len(shared.app_state.view.scene._viewer.get_clients()) <= before
    with line(shared, "owner", "/scene") as browser:
        assert isinstance(browser.recv(timeout=20.0), bytes)


def test_a_viewers_link_gives_a_viewers_cookie_and_the_owners_link_gives_it_back(
    shared: Served,
) -> None:
    browser = {"accept": "text/html"}
    with httpx.Client(base_url=shared.url, trust_env=False, headers=browser) as client:
        roles = []
        for role in ("viewer", "owner", "viewer"):
            answer = client.get(f"/?token={token_of(shared, role)}")
            assert (answer.status_code, answer.headers["location"]) == (303, "/")
            roles.append(client.get("/api/health").json()["role"])
        assert roles == ["viewer", "owner", "viewer"]
        assert client.post("/api/session/pause", headers={"accept": "*/*"}).status_code == 403


@pytest.mark.parametrize("path", ["/api/live", "/scene"])
@pytest.mark.parametrize("token", ["", "wrong"])
def test_no_websocket_opens_without_a_token(shared: Served, path: str, token: str) -> None:
    address = f"ws://127.0.0.1:{shared.policy.port}{path}?token={token}"
    with pytest.raises(InvalidStatus) as refused:
        connect(address, proxy=None)
    assert refused.value.response.status_code == 403
