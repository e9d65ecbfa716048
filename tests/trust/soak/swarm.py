"""Many clients in one process of their own, and what they and the server's account tell."""

from __future__ import annotations

import asyncio
import os
import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from time import perf_counter, process_time

from websockets.asyncio.client import ClientConnection

from slidetune.server.bench.served import thread_times
from tests.trust.footprint import footprint
from tests.trust.soak.listener import Listener, opened, woken

LANE = "NFTSM"
PATIENCE = 30.0
"""Longest wait for a first message in [s] (*ours*)."""
PERIOD = 0.25
"""Time between two patches whose effect is awaited in [s] (*ours*)."""


@dataclass(frozen=True)
class Crowd:
    """Who comes, and for how long.

    Attributes:
        port: of the server.
        process: its process id.
        readers: clients that read.
        silent: clients that never read after the first message.
        settle: how long they are left alone first in [s].
        quiet: how long they only listen in [s].
        moves: patches whose effect they await.
    """

    port: int
    process: int
    readers: int
    silent: int
    settle: float
    quiet: float
    moves: int


@dataclass(frozen=True)
class Heard:
    """What a crowd heard.

    Attributes:
        factor: simulated seconds a wall second.
        rate: frames a second that the reading client with the fewest got.
        dropped: rows that all reading clients together missed.
        skipped: rows that each silent client turned out to have missed when it woke.
        latencies: from a patch until each reading client had a frame under it in [ms].
        share: what all threads of the server took, of one core.
        own: what the clients took themselves, of one core.
        memory: resident memory of the server in [MB].
        lost: reading clients that the server hung up on.
    """

    factor: float
    rate: float
    dropped: int
    skipped: tuple[int, ...]
    latencies: tuple[float, ...]
    share: float
    own: float
    memory: float
    lost: int


def attend(crowd: Crowd) -> Heard:
    """Let a crowd come, listen and go; for a process of its own."""
    if hasattr(os, "nice"):
        os.nice(2)  # the server is what is measured: the clients wait
    return asyncio.run(_attend(crowd))


@asynccontextmanager
async def listeners(port: int, count: int) -> AsyncIterator[list[Listener]]:
    """Connect clients that read until the block ends."""
    found: list[Listener] = []
    async with asyncio.TaskGroup() as group:
        for _ in range(count):
            found.append(Listener(await opened(port)))
            group.create_task(found[-1].listen())
        await until(lambda: all(listener.name for listener in found))
        try:
            yield found
        finally:
            for listener in found:
                await listener.connection.close()


async def until(condition: object) -> None:
    """Wait for a condition.

    Raises:
        TimeoutError: after half a minute.
    """
    assert callable(condition)
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.02)


async def _attend(crowd: Crowd) -> Heard:
    silent: list[ClientConnection] = []
    async with listeners(crowd.port, crowd.readers) as readers:
        for _ in range(crowd.silent):
            silent.append(await opened(crowd.port, silent=True))
            await silent[-1].recv()
        await asyncio.sleep(crowd.settle)
        heard = await _listened(crowd, readers)
        latencies = await _moved(readers, crowd.moves)
        skipped = await asyncio.gather(*(woken(one, 3.0) for one in silent))
        dropped = sum(reader.dropped for reader in readers)
        lost = sum(reader.ended for reader in readers)
    for connection in silent:
        connection.transport.abort()
    factor, rate, share, own, memory = heard
    latency = tuple(latencies)
    return Heard(factor, rate, dropped, tuple(skipped), latency, share, own, memory, lost)


async def _listened(
    crowd: Crowd, readers: list[Listener]
) -> tuple[float, float, float, float, float]:
    """Only listen; return factor, least rate, both shares of a core and memory."""
    for reader in readers:
        reader.forget()
    before, own, begin = thread_times(crowd.process), process_time(), perf_counter()
    await asyncio.sleep(crowd.quiet)
    after, passed = thread_times(crowd.process), perf_counter() - begin
    share = sum(after[thread] - before.get(thread, 0.0) for thread in after) / passed
    own = (process_time() - own) / passed
    (first, time), (last, end) = readers[0].span
    rate = min(reader.frames for reader in readers) / passed
    return (end - time) / (last - first), rate, share, own, footprint(crowd.process).memory


async def _moved(readers: list[Listener], count: int) -> list[float]:
    """Patch again and again; return how long each effect took to each client in [ms]."""
    dice, author, sent = random.Random(1), readers[0], {}
    for number in range(count):
        sent[number] = perf_counter()
        patch = {"lanes": {LANE: {"nu": 10.0 ** dice.uniform(-0.5, 1.5)}}}
        await author.say(type="patch", patch=patch, id=number)
        await asyncio.sleep(dice.uniform(0.5, 1.5) * PERIOD)
    await until(lambda: len(author.own) == count)
    last = author.own[count - 1]
    await until(lambda: all(reader.effect(last) for reader in readers))
    return [
        ((reader.effect(revision) or 0.0) - sent[number]) * 1e3
        for number, revision in author.own.items()
        for reader in readers
    ]
