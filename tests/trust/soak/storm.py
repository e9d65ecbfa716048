"""Patches from several clients at once: what becomes of each, and whether all see the same."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter
from typing import Any

import httpx

from tests.trust.soak.listener import Listener
from tests.trust.soak.swarm import listeners, until

LANES = ("RBFNN-NFTSM", "RBFNN-SMC", "NFTSM")
FIELDS = ("k1", "k2", "epsilon", "nu")
"""Each client has a field of its own, so that its last word can be told from the others'."""
BAD = 10
"""Each client's first patch of so many is out of bounds and must be refused (*ours*)."""


@dataclass(frozen=True)
class Storm:
    """What is sent.

    Attributes:
        port: of the server.
        clients: how many send, up to one a field.
        rate: patches a second, all clients together.
        seconds: for how long.
    """

    port: int
    clients: int
    rate: float
    seconds: float


@dataclass(frozen=True)
class Aftermath:
    """What became of it.

    Attributes:
        sent: patches.
        wrong: those of them that were out of bounds.
        taken: patches that were echoed to their sender with a revision.
        refused: patches that were refused to their sender.
        rate: patches a second that were sent.
        answers: from a patch to its answer in [ms].
        in_order: whether every client saw revisions that only grow.
        complete: clients that were told of every revision.
        agreed: clients whose last document is the server's.
        kept: clients whose last accepted value is in the server's document.
        clients: how many there were.
    """

    sent: int
    wrong: int
    taken: int
    refused: int
    rate: float
    answers: tuple[float, ...]
    in_order: bool
    complete: int
    agreed: int
    kept: int
    clients: int


def blow(storm: Storm) -> Aftermath:
    """Send patches; for a process of its own."""
    return asyncio.run(_blow(storm))


async def _blow(storm: Storm) -> Aftermath:
    address = f"http://127.0.0.1:{storm.port}/api/experiment"
    async with listeners(storm.port, storm.clients) as clients, httpx.AsyncClient() as http:
        before = (await http.get(address)).json()["revision"]
        for client in clients:
            client.forget()
        begin = perf_counter()
        sent = await asyncio.gather(
            *(_send(client, number, storm) for number, client in enumerate(clients))
        )
        passed = perf_counter() - begin
        await until(lambda: _all_answered(clients, sent))
        after = (await http.get(address)).json()
        await until(lambda: all(_newest(client) >= after["revision"] for client in clients))
        return _aftermath(clients, sent, before, after, passed)


async def _send(client: Listener, number: int, storm: Storm) -> list[tuple[float, float]]:
    """Send one client's share; return time [s] and value of each patch."""
    lane, field = _place(number)
    pause = storm.clients / storm.rate
    begin, sent = perf_counter() + pause * number / storm.clients, []
    for index in range(round(storm.seconds / pause)):
        await asyncio.sleep(max(0.0, begin + index * pause - perf_counter()))
        value = -1.0 if index % BAD == 0 else 1.0 + 1e-3 * index
        sent.append((perf_counter(), value))
        await client.say(type="patch", patch={"lanes": {lane: {field: value}}}, id=index)
    return sent


def _place(number: int) -> tuple[str, str]:
    return LANES[number % len(LANES)], FIELDS[number // len(LANES)]


def _all_answered(clients: Sequence[Listener], sent: Sequence[Sequence[Any]]) -> bool:
    return all(len(c.answers) >= len(s) for c, s in zip(clients, sent, strict=True))


def _newest(client: Listener) -> int:
    return client.revisions[-1] if client.revisions else 0


def _aftermath(
    clients: list[Listener],
    sent: list[list[tuple[float, float]]],
    before: int,
    after: dict[str, Any],
    passed: float,
) -> Aftermath:
    told = list(range(before + 1, after["revision"] + 1))
    answers = [
        (client.answers[number] - when) * 1e3
        for client, patches in zip(clients, sent, strict=True)
        for number, (when, _) in enumerate(patches)
    ]
    kept = 0
    for number, (client, patches) in enumerate(zip(clients, sent, strict=True)):
        lane, field = _place(number)
        kept += after["experiment"]["lanes"][lane][field] == patches[max(client.own)][1]
    count = sum(map(len, sent))
    return Aftermath(
        sent=count,
        wrong=sum(value < 0.0 for patches in sent for _, value in patches),
        taken=sum(len(client.own) for client in clients),
        refused=sum(len(client.refused) for client in clients),
        rate=count / passed,
        answers=tuple(answers),
        in_order=all(a < b for client in clients for a, b in pairwise(client.revisions)),
        complete=sum(client.revisions == told for client in clients),
        agreed=sum(json.loads(c.last)["experiment"] == after["experiment"] for c in clients),
        kept=kept,
        clients=len(clients),
    )
