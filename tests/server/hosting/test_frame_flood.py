"""However a client floods a connection below its messages, the others have their turn."""

from __future__ import annotations

import asyncio
import base64
import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState
from websockets.exceptions import ConnectionClosedError
from websockets.frames import OP_CONT, OP_PING, OP_PONG, OP_TEXT, Frame
from websockets.sync.client import ClientConnection, connect

from slidetune.server.guard.limits import CLIENT_BURST
from slidetune.server.hosting.raw_websocket import BITE, RawWebSocket
from slidetune.server.serve import server_config
from tests.server.conftest import Served
from tests.server.routes.test_live import frame, text

FLOODS = {
    "pings": Frame(OP_PING, b""),
    "pongs": Frame(OP_PONG, b""),
    "pieces of a message that never ends": Frame(OP_CONT, b"", fin=False),
}
MANY = 20_000
"""Frames of a flood: the old answer to them took half a second of everybody's time."""


@contextmanager
def flooding(client: ClientConnection, kind: str) -> Iterator[None]:
    """Send frames of a kind in the background for as long as somebody takes them."""
    begin = Frame(OP_TEXT, b"", fin=False).serialize(mask=True) if "pieces" in kind else b""
    flood = begin + FLOODS[kind].serialize(mask=True) * MANY

    def run() -> None:
        while True:
            try:
                client.socket.sendall(flood)
            except OSError:
                return

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    yield
    thread.join(30.0)
    assert not thread.is_alive()


def hear_out(client: ClientConnection) -> None:
    """Listen until the server hangs up."""
    while True:
        client.recv(timeout=30.0)


@pytest.mark.parametrize("kind", FLOODS)
def test_a_flood_of_frames_is_hung_up_on_and_others_go_on(served: Served, kind: str) -> None:
    # What nobody reads any more keeps a client from hearing that it was closed: it need not wait.
    with connect(served.live, close_timeout=0.1) as other, connect(served.live) as client:
        text(other, "hello")
        text(client, "hello")
        with flooding(client, kind), pytest.raises(ConnectionClosedError) as closed:
            hear_out(client)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1008
        assert "240" in closed.value.rcvd.reason
        for _ in range(3):
            frame(other)
        text(other, "state")


def test_pings_at_an_ordinary_pace_are_all_answered(served: Served) -> None:
    with connect(served.live) as client:
        answers = [client.ping(str(number)) for number in range(CLIENT_BURST // 2)]
        assert all(answer.wait(30.0) for answer in answers)
        text(client, "state")


def test_others_have_a_turn_after_every_few_kilobytes_of_one_client() -> None:
    message = Frame(OP_TEXT, b"{}").serialize(mask=True)
    turns, last = 0, asyncio.Event()
    seen: list[int] = []

    async def listening(scope: Scope, receive: Receive, send: Send) -> None:
        await receive()
        await send({"type": "websocket.accept"})
        for _ in range(MANY):
            await receive()
            seen.append(turns)
        last.set()

    async def run() -> None:
        nonlocal turns
        config = server_config(listening)
        config.lifespan = "off"
        config.load()
        loop = asyncio.get_running_loop()
        protocol = RawWebSocket(config, ServerState(), {})
        server = await loop.create_server(lambda: protocol, "127.0.0.1", 0)
        _, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
        writer.write(handshake() + message * MANY)
        end = time.monotonic() + 60.0
        while not last.is_set():
            assert time.monotonic() < end
            turns += 1
            await asyncio.sleep(0)
        writer.close()
        await writer.wait_closed()
        server.close()
        protocol.transport.abort()
        await asyncio.sleep(0)

    asyncio.run(run())
    assert seen[-1] - seen[0] >= MANY * len(message) // BITE
    most = max(seen.count(turn) for turn in set(seen))
    assert most <= 2 * BITE // len(message)


def handshake() -> bytes:
    """Return a request to open a WebSocket."""
    key = base64.b64encode(os.urandom(16)).decode()
    lines = ("GET / HTTP/1.1", "Host: 127.0.0.1", "Upgrade: websocket", "Connection: Upgrade")
    own = (f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13", "", "")
    return "\r\n".join((*lines, *own)).encode()
