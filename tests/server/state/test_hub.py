"""What clients are told: slow ones get a fresh start, and no failure is the end of the news."""

from __future__ import annotations

import asyncio
import json
import time
from typing import Any

import pytest
from starlette.websockets import WebSocket

from slidetune.server.routes import live
from slidetune.server.state import hub
from tests.server.conftest import Served
from tests.server.guard.test_limits import hear, joined


def test_a_client_too_slow_for_its_messages_gets_a_fresh_start_instead(served: Served) -> None:
    sent: list[str] = []

    async def receive() -> dict[str, Any]:
        return {"type": "websocket.connect"}

    async def send(message: Any) -> None:
        sent.append(message.get("text") or "")

    async def run() -> None:
        socket = WebSocket({"type": "websocket"}, receive, send)
        await socket.accept()
        client = hub.Client("slow", socket, served.app_state)
        for number in range(hub.OUTBOX + 3):
            client.tell(str(number))
        sending = asyncio.create_task(client.send())
        async with asyncio.timeout(20.0):
            while str(hub.OUTBOX + 2) not in sent:
                await asyncio.sleep(0.01)
        sending.cancel()

    asyncio.run(run())
    texts = [text for text in sent if text]
    assert json.loads(texts[0])["type"] == "hello"
    assert texts[1:4] == [str(hub.OUTBOX + number) for number in range(3)]


def test_a_client_that_stood_still_in_the_middle_of_a_message_gets_one_as_well(
    served: Served,
) -> None:
    sent: list[str] = []

    async def run() -> None:
        ready = asyncio.Event()

        async def receive() -> dict[str, Any]:
            return {"type": "websocket.connect"}

        async def send(message: Any) -> None:
            sent.append(message.get("text") or "")
            if sent[-1] == "stuck":
                await ready.wait()

        socket = WebSocket({"type": "websocket"}, receive, send)
        await socket.accept()
        client = hub.Client("slow", socket, served.app_state)
        client.tell("stuck")
        sending = asyncio.create_task(client.send())
        async with asyncio.timeout(20.0):
            while "stuck" not in sent:
                await asyncio.sleep(0.01)
            for number in range(hub.OUTBOX + 3):
                client.tell(str(number))
            ready.set()
            while str(hub.OUTBOX + 2) not in sent:
                assert not sending.done(), "it sends no more"
                await asyncio.sleep(0.01)
        sending.cancel()

    asyncio.run(run())
    texts = [text for text in sent if text]
    begun = texts.index("stuck") + 1
    assert json.loads(texts[begun])["type"] == "hello"
    assert texts[begun + 1 : begun + 4] == [str(hub.OUTBOX + number) for number in range(3)]


def test_a_connection_ends_as_soon_as_nothing_can_be_sent_any_more(served: Served) -> None:
    async def run() -> None:
        async def receive() -> dict[str, Any]:
            if not accepted:
                accepted.append(True)
                return {"type": "websocket.connect"}
            await asyncio.Event().wait()  # a client that says nothing
            raise AssertionError

        async def send(message: Any) -> None:
            if message["type"] == "websocket.send":
                raise OSError("the cable is out")

        accepted: list[bool] = []
        socket = WebSocket({"type": "websocket"}, receive, send)
        await socket.accept()
        app_state = served.app_state
        client = hub.Client("gone", socket, app_state)
        conversation = live.Conversation(client, app_state, hub.Hub(app_state))
        async with asyncio.timeout(20.0):
            await live._talk(socket, client, conversation)

    asyncio.run(run())


def test_one_failure_to_tell_is_not_the_last_news(
    served: Served, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    with joined(served) as client:
        hear(client, "state")
        with monkeypatch.context() as patched:
            patched.setattr(served.app_state, "state", lambda: 1 / 0)
            end = time.monotonic() + 20.0
            while "could not send" not in caplog.text and time.monotonic() < end:
                time.sleep(0.01)
        assert "could not send" in caplog.text
        hear(client, "state")
        hear(client, "metrics")
