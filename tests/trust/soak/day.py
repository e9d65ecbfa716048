"""A long day: visitors for a while, then a count of what is left, again and again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from random import Random
from threading import Thread
from time import perf_counter

from slidetune.server.bench.served import RunningServer
from tests.trust.bar import Bar
from tests.trust.footprint import Footprint, footprint
from tests.trust.soak import visitors
from tests.trust.soak.census import Census, let_go, take_census
from tests.trust.soak.fill import fill
from tests.trust.soak.visitors import Visit, World

VISITS: tuple[tuple[Visit, float], ...] = (
    (visitors.edit, 0.5),
    (visitors.edit, 0.5),
    (visitors.come_and_go, 0.3),
    (visitors.come_and_go, 0.3),
    (visitors.watch, 0.7),
    (visitors.browse, 1.0),
    (visitors.preview, 1.0),
    (visitors.travel, 4.0),
    (visitors.change_preset, 5.0),
    (visitors.keep_preset, 7.0),
    (visitors.study, 8.0),
)
"""Visits, each by a visitor of its own, and the mean pause after one in [s] (*ours*)."""
ROUNDS = 30
"""Counts that a long soak makes (*ours*)."""
SHORTEST = 5.0
"""Least time between two counts in [s] (*ours*)."""
PATIENCE = 90.0
"""Longest time that a visitor takes to leave in [s] (*ours*): more than any answer may take."""
WARM_UP = 60.0
"""Time in [s] whose counts say nothing of growth, or a fifth if that is more (*ours*)."""


@dataclass(frozen=True)
class Day:
    """What was counted.

    Attributes:
        world: what visitors did, and what failed.
        counts: all counts, the first before the day began.
        warm: those after the warm-up.
        most: the most memory [MB], threads, files, sockets that were held at any time.
        seconds: how long it went on.
    """

    world: World
    counts: Sequence[Census]
    warm: Sequence[Census]
    most: Footprint
    seconds: float


def spend(server: RunningServer, seconds: float, bar: Bar) -> Day:
    """Let visitors come and go for so long."""
    world = World(server.port)
    fill(world, bar)
    let_go(world, bar)
    begin = perf_counter()
    counts = [take_census(world, server.process, begin, bar)]
    most = counts[0].held
    length = max(SHORTEST, seconds / ROUNDS)
    while (passed := perf_counter() - begin) < seconds:
        text = f"Soak: {passed / 60:.1f} of {seconds / 60:g} min, "
        most = _round(world, server.process, len(counts), length, bar, text, most)
        last = perf_counter() - begin >= seconds
        patience = {} if last else {"patience": 3.0}
        counts.append(take_census(world, server.process, begin, bar, counts[0], **patience))
    warm_up = min(max(WARM_UP, seconds / 5), seconds / 2)
    warm = [count for count in counts if count.time >= warm_up]
    return Day(world, counts, warm, most, perf_counter() - begin)


def _round(
    world: World, process: int, seed: int, length: float, bar: Bar, text: str, most: Footprint
) -> Footprint:
    """Let everybody in, and out again; return the most that was held at any time."""
    world.stop.clear()
    threads = [
        Thread(target=_keep_visiting, args=(world, visit, pause, Random(f"{seed} {number}")))
        for number, (visit, pause) in enumerate(VISITS)
    ]
    for thread in threads:
        thread.start()
    end = perf_counter() + length
    while (left := end - perf_counter()) > 0.0:
        bar.wait(f"{text}{world.done['HTTP requests']} requests", min(1.0, left))
        most = _most(most, footprint(process))
    world.stop.set()
    for thread in threads:
        thread.join(PATIENCE)
        if thread.is_alive():
            world.fail(f"a visitor didn't get away within {PATIENCE:g} s")
    return most


def _keep_visiting(world: World, visit: Visit, pause: float, dice: Random) -> None:
    while not world.stop.is_set():
        try:
            visit(world, dice)
        except Exception as error:
            world.fail(f"{visit.__name__}: {type(error).__name__}: {error}")
        world.stop.wait(dice.uniform(0.0, 2.0 * pause))


def _most(one: Footprint, other: Footprint) -> Footprint:
    return Footprint(
        max(one.memory, other.memory),
        max(one.threads, other.threads),
        max(one.files, other.files),
        max(one.sockets, other.sockets),
        one.children | other.children,
    )
