"""What a server holds when everybody has left and it runs what it ran at first."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from statistics import median
from time import perf_counter, sleep

from tests.server.scene.viser_client import ViserClient
from tests.trust.bar import Bar
from tests.trust.footprint import Footprint, footprint
from tests.trust.soak.visitors import World

IDLE = 12.0
"""Time after which the server's pool of threads lets idle ones go, and a little more, in [s]."""
DEADLINE = 30.0
"""Longest wait at the end until what visitors had is given back in [s] (*ours*)."""
POOLED = min(32, (os.cpu_count() or 1) + 4)
"""Threads that asyncio's pool keeps once it happened to need them; how many of them there are when
the soak begins is chance. A thread lost with every visitor would soon be far above that."""
SAMPLES = 5
"""Times that the memory is read (*ours*)."""


@dataclass(frozen=True)
class Census:
    """One count.

    Attributes:
        time: since the soak began in [s].
        held: what the server holds of the machine.
        nodes: nodes of the 3D scene.
        messages: messages that Viser keeps for newcomers.
        welcome: time until a newcomer had the whole scene in [s].
        factor: simulated seconds a wall second.
    """

    time: float
    held: Footprint
    nodes: int
    messages: int
    welcome: float
    factor: float


def take_census(
    world: World,
    process: int,
    begin: float,
    bar: Bar,
    like: Census | None = None,
    patience: float = DEADLINE,
) -> Census:
    """Put the server back to its first preset and count.

    Args:
        world: the server; nobody is there any more.
        process: its process id.
        begin: when the soak began in [s].
        bar: shows what is being done.
        like: wait until the server holds no more than in this count.
        patience: longest wait for that in [s].
    """
    world.ask("POST", "/api/presets/paper/load")
    world.ask("PATCH", "/api/session", {"speed": 1.0})
    world.ask("POST", "/api/session/play")
    seen = perf_counter()
    with ViserClient(world.port, "/scene/") as newcomer:
        welcome = perf_counter() - seen
        nodes, messages = len(newcomer.nodes), newcomer.replayed

    def settled() -> bool:
        # A pool of threads lets go of those that were idle for long only when it is used.
        world.ask("GET", "/api/metrics")
        return like is None or not left_behind(like.held, footprint(process))

    bar.wait("Soak: waiting until what visitors had is given back", patience, settled)
    state = world.ask("GET", "/api/session")
    factor = state.json()["real_time_factor"] if state is not None else 0.0
    held = _held(world, process)
    last = replace(held[-1], memory=median(one.memory for one in held))
    return Census(perf_counter() - begin, last, nodes, messages, welcome, factor)


def _held(world: World, process: int) -> list[Footprint]:
    """Look several times while time stands still: a new ring of telemetry fills as time goes on."""
    world.ask("POST", "/api/session/pause")
    world.ask("POST", "/api/presets/paper/load")
    held = []
    for _ in range(SAMPLES):
        sleep(0.1)
        held.append(footprint(process))
    world.ask("POST", "/api/session/play")
    return held


def let_go(world: World, bar: Bar) -> None:
    """Use the server now and then until its pool of threads has let idle ones go."""

    def use() -> bool:
        world.ask("GET", "/api/metrics")
        return False

    bar.wait("Soak: letting idle threads end", IDLE, use)


def left_behind(before: Footprint, after: Footprint) -> list[str]:
    """Return what a server holds more than before, memory and pooled threads aside, in words."""
    pairs = (
        ("threads beyond their pool", before.threads + POOLED, after.threads),
        ("open files", before.files, after.files),
        ("sockets", before.sockets, after.sockets),
        ("child processes", len(before.children), len(after.children)),
    )
    return [f"{name}: {now - then} more than before" for name, then, now in pairs if now > then]
