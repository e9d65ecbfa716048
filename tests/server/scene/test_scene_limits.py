"""The relay's own limits: how many browsers, and how fast each may speak to the scene."""

from __future__ import annotations

import asyncio

import pytest
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from slidetune.server.scene import relay as scene_relay
from tests.server.scene.test_relay import browser, echo, relayed


def test_one_browser_more_than_may_see_the_scene_is_asked_to_try_later(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(scene_relay, "MAX_CLIENTS", 2)

    async def run() -> None:
        async with relayed(echo) as (_, address), browser(address), browser(address) as second:
            async with browser(address) as late:
                with pytest.raises(ConnectionClosed) as closed:
                    await late.recv()
                assert closed.value.rcvd is not None
                assert closed.value.rcvd.code == 1013
                assert "are showing the 3D scene already" in closed.value.rcvd.reason
            await second.close()
            async with asyncio.timeout(20.0):
                while not await answers(address):
                    await asyncio.sleep(0.01)

    async def answers(address: str) -> bool:
        async with browser(address) as again:
            await again.send("here")
            try:
                return bool(await again.recv() == "here")
            except ConnectionClosed:
                return False

    asyncio.run(run())


def test_messages_that_come_too_fast_wait_and_none_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene_relay, "SCENE_RATE", 40.0)
    monkeypatch.setattr(scene_relay, "SCENE_BURST", 5)
    heard: list[float] = []

    async def listen(connection: ServerConnection) -> None:
        async for message in connection:
            heard.append(asyncio.get_running_loop().time())
            await connection.send(message)

    async def run() -> None:
        async with relayed(listen) as (_, address), browser(address) as socket:
            for number in range(45):
                await socket.send(str(number))
            assert [await socket.recv() for _ in range(45)] == [str(n) for n in range(45)]

    asyncio.run(run())
    # Never sooner than the rate lets them, on however slow a machine.
    assert heard[-1] - heard[0] > 0.9
