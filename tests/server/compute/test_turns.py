"""Turns go round, whoever gives up."""

from __future__ import annotations

import asyncio

import pytest

from slidetune.server.compute.turns import Turns


def served(order: list[str], count: int = 1, leaving: tuple[int, ...] = ()) -> list[str]:
    """Return in which order clients are served that came in ``order``; some leave before."""
    done: list[str] = []

    async def run() -> None:
        turns = Turns(count)

        async def ask(client: str) -> None:
            async with turns.turn(client):
                done.append(client)
                await asyncio.sleep(0)

        tasks = [asyncio.create_task(ask(client)) for client in order]
        await asyncio.sleep(0)
        for number in leaving:
            tasks[number].cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        for _ in range(count):  # none was lost
            async with asyncio.timeout(20.0), turns.turn("last"):
                pass
        async with asyncio.timeout(20.0), turns.turn("last"):
            assert turns._left == count - 1
        assert not turns._waiting

    asyncio.run(run())
    return done


def test_each_client_has_its_turn_in_between() -> None:
    assert "".join(served(list("aaaaabbc"))) == "aabcabaa"


def test_who_is_alone_is_served_in_order() -> None:
    assert served(["a"] * 5) == ["a"] * 5


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("leaving", [(0,), (1,), (3, 4), (0, 1, 2, 3, 4, 5)])
def test_who_leaves_takes_no_turn_along(count: int, leaving: tuple[int, ...]) -> None:
    done = served(list("aabbcc"), count, leaving)
    assert 6 - len(leaving) <= len(done) <= 6
