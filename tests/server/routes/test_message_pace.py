"""However a client floods the live session, the others have their turn."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

import pytest
from starlette.websockets import WebSocket
from websockets.sync.client import connect

from slidetune.server.guard.access_policy import Role
from slidetune.server.guard.limits import CLIENT_BURST, CLIENT_RATE, MAX_LIVE_MESSAGE
from slidetune.server.guard.message_size import SHORT, message_cost
from slidetune.server.guard.token_bucket import TokenBucket
from slidetune.server.routes.live import Conversation
from slidetune.server.state.hub import Client, Hub
from tests.server.conftest import Served
from tests.server.routes.test_live import text

MANY = {"type": "patch", "id": 7, "patch": {f"key{number}": 1 for number in range(1001)}}
FLOODS: dict[str, str | None] = {
    "a good message": '{"type": "view"}',
    "bad JSON": "{",
    "no object": "[]",
    "an unknown type": '{"type": "fly"}',
    "many keys": json.dumps(MANY),
    "a long text": "x" * (MAX_LIVE_MESSAGE + 1),
    "binary": None,
}


class Mouth(Client):
    """A client that keeps what it is told."""

    def __init__(self, served: Served, role: Role) -> None:
        super().__init__(
            "flood", WebSocket({"type": "websocket"}, None, None), served.app_state, role
        )  # type: ignore[arg-type]
        self.told: list[dict[str, Any]] = []

    def tell(self, text: str) -> None:
        self.told.append(json.loads(text))


def flood(
    served: Served, role: Role, message: str | None, count: int, burst: float = CLIENT_BURST
) -> tuple[Mouth, int]:
    """Let a client say a message often, and count the turns that others have meanwhile."""
    mouth = Mouth(served, role)
    conversation = Conversation(mouth, served.app_state, Hub(served.app_state))
    conversation._bucket = TokenBucket(1.0, burst, clock=lambda: 0.0)  # no time refills it
    hear: Callable[[], Awaitable[None]] = conversation.hear_binary
    if message is not None:
        hear = lambda: conversation.hear(message)  # noqa: E731

    async def run() -> int:
        turns, over = 0, False

        async def other() -> None:
            nonlocal turns
            while not over:
                turns += 1
                await asyncio.sleep(0)

        beside = asyncio.create_task(other())
        for _ in range(count):
            await hear()
        over = True
        await beside
        return turns

    return mouth, asyncio.run(run())


@pytest.mark.parametrize("role", ["owner", "viewer"])
@pytest.mark.parametrize("kind", FLOODS)
def test_others_have_a_turn_between_any_two_messages(served: Served, role: Role, kind: str) -> None:
    _, turns = flood(served, role, FLOODS[kind], 30)
    assert turns >= 30


@pytest.mark.parametrize("role", ["owner", "viewer"])
@pytest.mark.parametrize("kind", FLOODS)
def test_what_comes_too_fast_is_refused_whatever_it_is(
    served: Served, role: Role, kind: str
) -> None:
    message = FLOODS[kind]
    mouth, _ = flood(served, role, message, 6, burst=3 * message_cost(message or ""))
    codes = [said["error"]["code"] for said in mouth.told]
    assert codes[-3:] == ["too_many_patches"] * 3
    assert "too_many_patches" not in codes[:-3]


def test_a_message_of_many_keys_is_refused_before_anybody_looks_at_them(served: Served) -> None:
    wide = {"type": "select", "id": 8, **{f"key{number}": 1 for number in range(1001)}}
    before = served.app_state.document.revision
    with connect(served.live) as socket:
        text(socket, "hello")
        for message in (MANY, wide):
            socket.send(json.dumps(message))
            refusal = text(socket, "error")
            assert refusal["id"] == message["id"]
            assert refusal["error"]["code"] == "too_large"
            assert "1000 keys" in refusal["error"]["message"]
        socket.send("x" * (MAX_LIVE_MESSAGE + 1))
        assert "64 KiB" in text(socket, "error")["error"]["message"]
    assert served.app_state.document.revision == before


def test_a_long_message_counts_for_several_and_a_drag_for_one() -> None:
    assert message_cost("x" * (SHORT - 1)) == 1
    assert message_cost("x" * MAX_LIVE_MESSAGE) == 1 + MAX_LIVE_MESSAGE // SHORT
    assert message_cost("x" * 10 * MAX_LIVE_MESSAGE) <= CLIENT_BURST < CLIENT_RATE * 3
