"""What isn't HTTP, or opens no WebSocket, is answered as well as anything else."""

from __future__ import annotations

import json
import logging
import socket
import threading
import time
from collections.abc import Iterator

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from slidetune.server.guard.access import Access
from slidetune.server.guard.access_policy import AccessPolicy
from slidetune.server.hosting.raw_websocket import leave_foreign_text_out_of_the_log
from slidetune.server.serve import free_socket, server_config

HEADERS = ("content-security-policy", "referrer-policy", "x-content-type-options")


async def listening(scope: Scope, receive: Receive, send: Send) -> None:
    """Accept WebSockets at one path, and hear all that they say."""
    if scope["type"] != "websocket":
        return
    await receive()
    if scope["path"] != "/live":
        await send({"type": "websocket.close"})
        return
    await send({"type": "websocket.accept"})
    while (await receive())["type"] != "websocket.disconnect":
        pass


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """Serve what ``serve`` would, around a small application."""
    bound = free_socket("127.0.0.1", 0)
    number = bound.getsockname()[1]
    app = Access(listening, AccessPolicy("127.0.0.1", number))
    config = server_config(app)
    config.lifespan = "off"
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [bound]}, daemon=True)
    thread.start()
    end = time.monotonic() + 60.0
    while not server.started:
        assert time.monotonic() < end, "the server did not start"
        time.sleep(0.01)
    yield number
    server.should_exit = True
    thread.join(30.0)


def answer(port: int, request: bytes) -> tuple[bytes, bytes]:
    """Send some bytes and return head and body of what comes back."""
    with socket.create_connection(("127.0.0.1", port), timeout=20.0) as line:
        line.sendall(request)
        head, _, body = b"".join(iter(lambda: line.recv(65536), b"")).partition(b"\r\n\r\n")
    return head.lower().replace(b"http/", b"HTTP/"), body


def test_what_is_not_http_is_answered_in_the_one_shape_and_with_the_headers(port: int) -> None:
    head, body = answer(port, b"\x16\x03\x01 no such thing\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 400 ")
    assert all(f"\r\n{name}: ".encode() in head for name in HEADERS)
    assert json.loads(body)["error"]["code"] == "bad_request"


def test_a_handshake_that_is_none_is_refused_with_the_headers(port: int) -> None:
    lines = ("GET /live HTTP/1.1", f"Host: 127.0.0.1:{port}", "Connection: upgrade")
    head, _ = answer(port, "\r\n".join([*lines, "Upgrade: websocket", "", ""]).encode())
    assert head.startswith(b"HTTP/1.1 400 ")
    assert all(f"\r\n{name}: ".encode() in head for name in HEADERS)


@pytest.mark.parametrize(
    ("path", "origin"), [("/live", "http://elsewhere.example"), ("/nowhere", None)]
)
def test_a_refused_websocket_is_answered_with_the_headers(
    port: int, path: str, origin: str | None
) -> None:
    with pytest.raises(InvalidStatus) as refused:
        connect(f"ws://127.0.0.1:{port}{path}", origin=origin).__enter__()  # type: ignore[arg-type]
    response = refused.value.response
    assert response.status_code == 403
    assert all(name in response.headers for name in HEADERS)


def test_text_that_is_not_utf_8_closes_its_connection_without_a_traceback(
    port: int, caplog: pytest.LogCaptureFixture
) -> None:
    leave_foreign_text_out_of_the_log()
    with caplog.at_level(logging.WARNING), connect(f"ws://127.0.0.1:{port}/live") as client:
        client.protocol.send_text(b"\xff\xfe")
        client.socket.sendall(b"".join(client.protocol.data_to_send()))
        with pytest.raises(ConnectionClosed) as closed:
            client.recv(timeout=20.0)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1007
    assert caplog.records == []
