"""How the live session serves many clients, and what happens to many patches at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from slidetune.server.bench.served import RunningServer
from tests.trust.bar import Bar
from tests.trust.report import table
from tests.trust.soak.storm import Aftermath, Storm, blow
from tests.trust.soak.swarm import PERIOD, Crowd, Heard, attend
from tests.trust.soak.verdict import Verdict

COUNTS = (1, 10, 50, 100)
SHARE = 0.5
"""Most processor time that one client more may take, in percent of a core (*ours*)."""
FACTOR = 0.99
"""Least real-time factor (*ours*)."""
LATENCY = 50.0
"""Longest time from a patch to a frame under it at the 95th percentile, one client, in [ms]
(*ours*)."""
RATE = 200.0
"""Patches a second (*ours*)."""


def measure_load(server: RunningServer, quick: bool, bar: Bar) -> Verdict:
    """Let crowds come one after the other, then send patches from many clients at once.

    Args:
        server: a server with the paper's three lanes.
        quick: short, for a look instead of a verdict.
        bar: shows what is being done.
    """
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        heard = {}
        for count in COUNTS:
            crowd = _crowd(server, count, quick)
            text = f"Load: {count} clients, {crowd.silent} of them silent"
            seconds = 4.0 + crowd.settle + crowd.quiet + crowd.moves * PERIOD
            heard[count] = bar.follow(text, seconds, pool.submit(attend, crowd))
        storm = Storm(server.port, 10, RATE, 2.0 if quick else 10.0)
        text = f"Load: {RATE:g} patches a second from {storm.clients} clients"
        aftermath = bar.follow(text, storm.seconds + 3.0, pool.submit(blow, storm))
    return _verdict(heard, aftermath)


def _crowd(server: RunningServer, count: int, quick: bool) -> Crowd:
    silent = count // 10
    settle, quiet, moves = (0.5, 1.5, 5) if quick else (2.0, 12.0, 40)
    return Crowd(server.port, server.process, count - silent, silent, settle, quiet, moves)


def _verdict(heard: dict[int, Heard], storm: Aftermath) -> Verdict:
    broken = [
        f"{count} clients: {text}" for count, one in heard.items() for text in _broken(one)
    ] + _unsettled(storm)
    missed = [
        f"{count} clients: real-time factor {one.factor:.3f}, at least {FACTOR} is wanted"
        for count, one in heard.items()
        if one.factor < FACTOR
    ]
    missed += [
        f"{count} clients: {share:.2f} % of a core for each client more, at most {SHARE} is wanted"
        for count, share in _shares(heard).items()
        if share > SHARE
    ]
    first = float(np.quantile(heard[COUNTS[0]].latencies, 0.95))
    if first > LATENCY:
        missed.append(f"1 client: a patch shows after {first:.0f} ms, {LATENCY:g} are wanted")
    return Verdict(_body(heard, storm), tuple(broken), tuple(missed))


def _broken(heard: Heard) -> list[str]:
    found = []
    if heard.dropped:
        found.append(f"clients that read missed {heard.dropped} rows")
    if heard.lost:
        found.append(f"the server hung up on {heard.lost} clients that read")
    return found


def _unsettled(storm: Aftermath) -> list[str]:
    found = []
    if storm.taken != storm.sent - storm.wrong or storm.refused != storm.wrong:
        found.append(
            f"of {storm.sent} patches, {storm.wrong} of them wrong, "
            f"{storm.taken} were taken and {storm.refused} refused"
        )
    if not storm.in_order:
        found.append("a client saw revisions that don't grow")
    for name, count in (
        ("saw every revision", storm.complete),
        ("agree with the server at the end", storm.agreed),
        ("find their last value in force", storm.kept),
    ):
        if count != storm.clients:
            found.append(f"{count} of {storm.clients} clients {name}")
    return found


def _shares(heard: dict[int, Heard]) -> dict[int, float]:
    """Return what each client more than the first takes, in percent of a core."""
    alone = heard[COUNTS[0]].share
    return {n: (heard[n].share - alone) / (n - 1) * 100.0 for n in heard if n > 1}


def _body(heard: dict[int, Heard], storm: Aftermath) -> str:
    shares = _shares(heard)
    crowd = list(heard.items())

    def row(name: str, cell: Callable[[int, Heard], str]) -> list[str]:
        return [name, *(cell(count, one) for count, one in crowd)]

    def latency(share: float) -> Callable[[int, Heard], str]:
        return lambda _, one: f"{np.quantile(one.latencies, share):.1f}"

    rows = [
        row("of them never reading", lambda _, one: str(len(one.skipped))),
        row(f"real-time factor (target ≥ {FACTOR})", lambda _, one: f"{one.factor:.3f}"),
        row("frames per second, slowest reading client", lambda _, one: f"{one.rate:.1f}"),
        row("patch → frame, median [ms]", latency(0.5)),
        row("patch → frame, 95th percentile [ms]", latency(0.95)),
        row("patch → frame, 99th percentile [ms]", latency(0.99)),
        row("rows missed by all reading clients (promise 0)", lambda _, one: str(one.dropped)),
        row("rows skipped for a client that never read", lambda _, one: _span(one.skipped)),
        row("server, % of a core", lambda _, one: f"{100 * one.share:.1f}"),
        row(
            f"CPU per extra client, % of a core (target ≤ {SHARE})",
            lambda n, _: f"{shares[n]:.2f}" if n in shares else "–",
        ),
        row("server, resident memory [MB]", lambda _, one: f"{one.memory:.0f}"),
        row("all clients, % of a core", lambda _, one: f"{100 * one.own:.1f}"),
    ]
    headings = ["clients", *(str(count) for count in heard)]
    return f"{_DEFINITION}\n\n{table(headings, rows)}\n\n{_storm_text(storm)}"


_DEFINITION = (
    "One server with the paper's three lanes at 1 kHz, all clients in one other process on the "
    "same machine. A tenth of them never read after the first message. *Patch → frame* is the "
    "time from the moment at which one client sends a patch until another reading client has the "
    "first telemetry frame computed under it, over all reading clients and patches; it includes "
    "the time that the clients themselves wait for the processor. *CPU per extra client* is the "
    "server's CPU use above that for one client, divided by the number of extra clients."
)


def _span(skipped: Sequence[int]) -> str:
    return f"{min(skipped)}–{max(skipped)}" if skipped else "–"


def _storm_text(storm: Aftermath) -> str:
    median, high = np.quantile(storm.answers, [0.5, 0.95])
    rows = [
        ["sent, per second", f"{storm.rate:.0f}"],
        ["sent", str(storm.sent)],
        ["of them out of bounds", str(storm.wrong)],
        ["accepted (promise: all others)", str(storm.taken)],
        ["refused (promise: those)", str(storm.refused)],
        ["patch → answer, median [ms]", f"{median:.1f}"],
        ["patch → answer, 95th percentile [ms]", f"{high:.1f}"],
        ["clients that saw every revision, in order", f"{storm.complete} of {storm.clients}"],
        ["clients whose document is the server's at the end", f"{storm.agreed} of {storm.clients}"],
        ["clients whose last value is in force", f"{storm.kept} of {storm.clients}"],
    ]
    return (
        f"Patches from {storm.clients} clients at the same time, each to its own field:\n\n"
        f"{table(['patches', 'figure'], rows)}"
    )
