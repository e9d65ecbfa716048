"""Every limit is reached on purpose: it is refused in words, and nothing is lost by it."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from slidetune.robot.experiment.presets import preset_store, save_preset
from slidetune.server.compute import workers
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.limits import (
    MAX_ARM,
    MAX_BODY,
    MAX_LOG,
    MAX_MESSAGE,
    MAX_PRESETS,
    MAX_STUDIES,
    TooManyPresetsError,
    limits_document,
)
from slidetune.server.guard.token_bucket import TokenBucket
from slidetune.server.routes import live
from slidetune.server.state import hub
from slidetune.server.state.preset_quota import save_within_quota
from tests.server.conftest import Served, serving

BODY_ROUTES = [
    ("PATCH", "/api/experiment"),
    ("PUT", "/api/experiment"),
    ("PUT", "/api/presets/too-large"),
    ("POST", "/api/presets/paper/load"),
    ("POST", "/api/link"),
    ("POST", "/api/arms/pendulum/begin"),
    ("DELETE", "/api/arms/nothing"),
    ("PATCH", "/api/session"),
    ("POST", "/api/session/play"),
    ("POST", "/api/session/step"),
    ("POST", "/api/session/reset"),
    ("POST", "/api/session/kick"),
    ("POST", "/api/session/look"),
    ("POST", "/api/session/fork"),
    ("POST", "/api/history/1/restore"),
    ("POST", "/api/preview"),
    ("POST", "/api/lens"),
    ("POST", "/api/threshold"),
    ("POST", "/api/hand-over"),
    ("POST", "/api/exports/window"),
    ("POST", "/api/exports/run"),
    ("POST", "/api/report"),
    ("POST", "/api/studies"),
    ("POST", "/api/studies/accept"),
    ("POST", "/api/studies/strip"),
    ("POST", "/api/studies/sensitivity"),
    ("POST", "/api/studies/switching"),
    ("PATCH", "/api/logs/1"),
    ("DELETE", "/api/logs/1"),
    ("POST", "/api/logs/1/curves"),
    ("POST", "/api/logs/1/trajectory"),
    ("POST", "/api/logs/1/identify"),
    ("DELETE", "/api/presets/nothing"),
    ("POST", "/api/nowhere"),
]
ACTS_WITHOUT = ("/api/session/play", "/api/arms/pendulum/begin", "/api/nowhere")
"""Routes that act without a body and never read one."""
TAKING_FILES = {("POST", "/api/arms"): MAX_ARM, ("POST", "/api/logs"): MAX_LOG}
"""Routes that take more."""


def refusal(answer: httpx.Response, status: int, code: str) -> str:
    assert answer.status_code == status, answer.text
    error = answer.json()["error"]
    assert set(error) == {"code", "message", "fields"}
    assert error["code"] == code
    return str(error["message"])


def joined(served: Served) -> ClientConnection:
    # Unlimited: a client that was too busy to listen gets all that it missed in one frame.
    return connect(served.live, compression=None, max_size=None, max_queue=None)


def hear(client: ClientConnection, kind: str) -> dict[str, Any]:
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        raw = client.recv(timeout=20.0)
        if isinstance(raw, str) and (message := json.loads(raw))["type"] == kind:
            return dict(message)
    pytest.fail(f"no {kind} message came")


def patch(client: ClientConnection, number: int | str, value: float) -> None:
    message = {"type": "patch", "id": number, "patch": {"lanes": {"NFTSM": {"nu": value}}}}
    client.send(json.dumps(message))


def answer_to(client: ClientConnection, number: int) -> dict[str, Any]:
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        raw = client.recv(timeout=20.0)
        message = json.loads(raw) if isinstance(raw, str) else {}
        if message.get("type") in ("patch", "error") and message["id"] == number:
            return dict(message)
    pytest.fail(f"message {number} was not answered")


def test_every_route_that_takes_a_body_is_in_the_table(served: Served) -> None:
    paths = served.http.get("/openapi.json").json()["paths"]
    taking = {
        (method.upper(), path)
        for path, methods in paths.items()
        for method, route in methods.items()
        if "requestBody" in route
    }
    known = {(method, path) for method, path in BODY_ROUTES}
    named = {
        (method, path.replace("{name}", "too-large").replace("/{number}", "/1"))
        for method, path in taking
    }
    assert named <= {*known, *TAKING_FILES}


@pytest.mark.parametrize(("method", "path"), [*BODY_ROUTES, *TAKING_FILES])
def test_a_body_that_announces_its_size_is_refused_unread(
    served: Served, method: str, path: str
) -> None:
    most = TAKING_FILES.get((method, path), MAX_BODY)
    # Nothing but the header is sent: an answer shows that nobody waits for the rest.
    head = f"{method} {path} HTTP/1.1\r\nHost: {served.url[7:]}\r\n"
    with socket.create_connection(("127.0.0.1", served.policy.port), timeout=20.0) as line:
        line.sendall(f"{head}Content-Length: {most + 1}\r\n\r\n".encode())
        answer = b"".join(iter(lambda: line.recv(65536), b""))
    start, _, body = answer.partition(b"\r\n\r\n")
    assert start.startswith(b"HTTP/1.1 413")
    assert b"content-security-policy" in start
    error = json.loads(body)["error"]
    assert (error["code"], error["fields"]) == ("too_large", [])
    assert f"{most // 1024} KiB" in error["message"]


@pytest.mark.parametrize(
    ("method", "path"), [route for route in BODY_ROUTES if route[1] not in ACTS_WITHOUT]
)
def test_a_body_of_unknown_size_is_refused_where_it_gets_too_large(
    served: Served, method: str, path: str
) -> None:
    def growing() -> Iterator[bytes]:
        for _ in range(2 * MAX_BODY // 4096):
            yield b" " * 4096

    before = served.app_state.document.revision
    headers = {"content-type": "application/json"}
    try:
        answer = served.http.request(method, path, content=growing(), headers=headers)
    except httpx.TransportError:
        return  # the server hung up while we were still sending: refused as well
    # Routes that take no body never read one: they act or refuse for their own reasons.
    if answer.status_code in (413, 400):
        assert refusal(answer, 413, "too_large")
    else:
        assert path in ("/api/presets/paper/load", "/api/history/1/restore") or method == "DELETE"
        return
    assert served.app_state.document.revision == before


def test_the_largest_body_is_still_read(served: Served) -> None:
    patch = json.dumps({"lanes": {"NFTSM": {"nu": 31}}})
    headers = {"content-type": "application/json"}
    full = patch.ljust(MAX_BODY)
    answer = served.http.patch("/api/experiment", content=full, headers=headers)
    assert answer.json()["experiment"]["lanes"]["NFTSM"]["nu"] == 31


def test_a_client_that_floods_is_told_so_and_may_send_again(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Slow enough that the speed of this machine decides nothing.
    monkeypatch.setattr(live, "CLIENT_RATE", 2.0)
    monkeypatch.setattr(live, "CLIENT_BURST", 4)
    before = served.app_state.document.revision
    with joined(served) as client, joined(served) as other:
        hear(client, "hello")
        for number in range(10):
            patch(client, number, 1 + number)
        answers = [answer_to(client, number) for number in range(10)]
        refused = [answer["error"] for answer in answers if answer["type"] == "error"]
        assert 0 < len(refused) <= 6
        assert {error["code"] for error in refused} == {"too_many_patches"}
        assert all("2 messages per second from one client" in error["message"] for error in refused)
        # What was taken, and nothing else, was done; the connection stays and may send again.
        assert served.app_state.document.revision == before + 10 - len(refused)
        number, answer = 10, answers[-1]
        while answer["type"] == "error" or number == 10:
            patch(client, number, 77)
            answer, number = answer_to(client, number), number + 1
        assert answer["experiment"]["lanes"]["NFTSM"]["nu"] == 77
        assert hear(other, "state")["playing"]


def test_a_drag_at_sixty_patches_a_second_is_never_refused() -> None:
    now = 0.0
    bucket = TokenBucket(240.0, 480, clock=lambda: now)
    for _ in range(60 * 60):
        now += 1.0 / 60.0
        assert bucket.take()


def test_an_allowance_gives_its_burst_and_then_its_rate() -> None:
    now = 0.0
    bucket = TokenBucket(10.0, 5, clock=lambda: now)
    assert [bucket.take() for _ in range(6)] == [True] * 5 + [False]
    now = 1.0
    assert sum(bucket.take() for _ in range(20)) == 5  # a second refills ten, five are kept
    now = 1.25
    assert sum(bucket.take() for _ in range(20)) == 2
    assert bucket.wait() == pytest.approx(0.05)
    assert bucket.wait() == pytest.approx(0.15)


def test_all_clients_together_have_a_limit_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub, "TOTAL_RATE", 0.01)
    monkeypatch.setattr(hub, "TOTAL_BURST", 3)
    with serving(tmp_path) as server, ExitStack() as stack:
        clients = [stack.enter_context(joined(server)) for _ in range(4)]
        kinds = []
        for number, client in enumerate(clients):
            patch(client, number, 5)
            kinds.append((answer := answer_to(client, number))["type"])
        assert kinds == ["patch"] * 3 + ["error"]
        assert "patches per second from all clients together" in answer["error"]["message"]
        clients[3].send('{"type": "pause"}')  # only patches are counted
        while hear(clients[3], "state")["playing"]:
            pass


def test_one_client_more_than_there_is_room_for_is_asked_to_try_later(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "MAX_CLIENTS", 3)
    with ExitStack() as stack:
        clients = [stack.enter_context(joined(served)) for _ in range(3)]
        for client in clients:
            hear(client, "hello")
        with joined(served) as late, pytest.raises(ConnectionClosed) as closed:
            late.recv(timeout=20.0)
        assert closed.value.rcvd is not None
        assert (closed.value.rcvd.code, closed.value.rcvd.reason[:2]) == (1013, "3 ")
        clients[0].close()
        until_joined(served)


def until_joined(served: Served) -> None:
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        with suppress(ConnectionClosed), joined(served) as client:
            hear(client, "hello")
            return
    pytest.fail("no room came free")


def test_a_message_that_is_too_large_ends_its_own_connection(served: Served) -> None:
    with joined(served) as client:
        hear(client, "hello")
        client.send("x" * (MAX_MESSAGE + 1))
        with pytest.raises(ConnectionClosed):
            hear(client, "no such message")
        assert client.protocol.close_code == 1009


def test_one_study_more_than_may_be_is_refused_and_a_seat_comes_free(served: Served) -> None:
    body = {"lane": "NFTSM", "field": "nu", "count": 60}
    # Long runs: none of them ends before the last one is refused.
    patch = {"simulation": {"horizon": 60.0}}
    served.http.patch("/api/experiment", json=patch).raise_for_status()
    with ExitStack() as stack:
        for _ in range(MAX_STUDIES):
            study = served.http.stream("POST", "/api/studies/strip", json=body)
            answer = stack.enter_context(closing(stack.enter_context(study)))
            assert answer.status_code == 200
        text = refusal(
            served.http.post("/api/studies/switching", json={"lane": "NFTSM"}),
            429,
            "too_many_studies",
        )
        assert f"{MAX_STUDIES} studies" in text
    # All of them were given up: others may follow.
    short = {"lane": "NFTSM", "field": "nu", "count": 2}
    for _ in range(200):
        if served.http.post("/api/studies/strip", json=short).status_code == 200:
            break
    else:
        pytest.fail("none of them ended")


def test_a_task_that_finds_no_place_in_the_queue_is_refused(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "MOST", 0)
    text = refusal(served.http.post("/api/lens", json={"lane": "NFTSM"}), 503, "busy")
    assert "0 tasks" in text


def test_a_seat_comes_free_however_its_holder_ends() -> None:
    running = ConcurrencyLimit(1, lambda: RuntimeError("full"))
    with running.one(), pytest.raises(RuntimeError, match="full"):
        running.one().__enter__()
    with suppress(KeyError), running.one():
        raise KeyError
    assert running.under_way == 0


def test_a_full_folder_takes_no_other_preset_but_the_same_again(
    served: Served, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("SLIDETUNE_PRESETS", str(tmp_path))
    experiment = served.app_state.document.experiment
    save_preset("mine-0", experiment)
    text = (tmp_path / "mine-0.yaml").read_text(encoding="utf-8")
    for number in range(1, MAX_PRESETS):
        (tmp_path / f"mine-{number}.yaml").write_text(text, encoding="utf-8")
    message = refusal(served.http.put("/api/presets/one-more"), 507, "too_many_presets")
    assert f"{MAX_PRESETS} are allowed" in message
    assert not (tmp_path / "one-more.yaml").exists()
    assert served.http.put("/api/presets/mine-7?overwrite=true").status_code == 200
    assert served.http.delete("/api/presets/mine-8").status_code == 204
    assert served.http.put("/api/presets/one-more").status_code == 200
    with pytest.raises(TooManyPresetsError):
        save_within_quota(preset_store(), "another", experiment)


def test_health_tells_the_limits(served: Served) -> None:
    health = served.http.get("/api/health").json()
    assert health["limits"] == limits_document()
    assert health["role"] == "owner"
