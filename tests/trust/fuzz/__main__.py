"""Feeds wrong input to everything that takes input, and says which of it was not met clearly.

Run it with ``make fuzz``; ``ARGS="--quick"`` takes a minute or two, ``ARGS="--record"`` writes the
table into the documentation. Every input has its own dice: same seed, same inputs.
"""

from __future__ import annotations

import tempfile
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import closing, contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated

import httpx
import typer
from rich.console import Console

from slidetune.server.bench.served import RunningServer, running_server
from slidetune.server.report.run_bar import progress_bar
from tests.trust.fuzz.http import HttpFuzz, http_input
from tests.trust.fuzz.live import BATCH, LiveFuzz, live_input
from tests.trust.fuzz.openapi import SHORT, run_schemathesis
from tests.trust.fuzz.run import dice, run_part
from tests.trust.fuzz.verdict import Fault, Tally
from tests.trust.report import provenance, record, table

INPUTS = 104_000
SHARES = {"yaml": 0.58, "patch": 0.30, "live": 0.08, "http": 0.04}
"""How the inputs are dealt out (*ours*): most to what is quickest."""
TITLES = {
    "yaml": "presets in YAML, through the loader",
    "patch": "merge patches, through `Experiment.patched`",
    "openapi": "HTTP requests by Schemathesis, to a server",
    "live": "messages to the live WebSocket of a server",
    "http": "bodies to every HTTP route of a server",
}
HEADINGS = (
    "what", "inputs", "accepted", "clearly refused", "faults", "slower than 1 s", "slowest",
    "memory grew by",
)  # fmt: skip
MOST_MEMORY = 400.0
"""Growth of the server's greatest memory in [MB] from which on it is a fault (*ours*)."""
_CHUNK = 400
_PROCESSES = 2

console = Console(stderr=True, highlight=False)
Show = Callable[[float], None]


def in_process(part: str, seed: int, count: int, show: Show) -> Tally:
    """Judge presets or patches, on two processes."""
    tally = Tally()
    starts = range(0, count, _CHUNK)
    with ProcessPoolExecutor(_PROCESSES, get_context("spawn")) as pool:
        tasks = [pool.submit(run_part, part, seed, i, min(count, i + _CHUNK)) for i in starts]
        for done, task in enumerate(as_completed(tasks), 1):
            tally.merge(task.result())
            show(done / len(tasks))
    return tally


def to_socket(server: RunningServer, seed: int, count: int, show: Show) -> Tally:
    """Judge messages to the live WebSocket; then a fresh client must hear all there is to hear."""
    with closing(LiveFuzz(server.port)) as fuzz:
        for start in range(0, count, BATCH):
            numbers = range(start, min(count, start + BATCH))
            fuzz.judge([live_input(dice(seed, "live", number)) for number in numbers])
            show(start / count)
        if missing := fuzz.alive():
            fuzz.tally.add(Fault("the server has fallen silent", missing, "after all messages"))
        return fuzz.tally


def to_routes(server: RunningServer, seed: int, count: int, show: Show) -> Tally:
    """Judge bodies of requests."""
    with closing(HttpFuzz(server.port)) as fuzz:
        for number in range(count):
            fuzz.judge(http_input(dice(seed, "http", number), fuzz.operations))
            show(number / count)
        return fuzz.tally


@contextmanager
def fresh_server() -> Iterator[RunningServer]:
    """Start a server with a folder of presets of its own."""
    with (
        tempfile.TemporaryDirectory() as folder,
        running_server(
            (), {"SLIDETUNE_PRESETS": folder, "SLIDETUNE_STUDIES": f"{folder}/studies"}
        ) as server,
    ):
        yield server


def served_parts(seed: int, counts: dict[str, int], bar: Callable[[str], Show]) -> dict[str, Tally]:
    """Judge everything that needs a server, all on one and the same."""
    tallies: dict[str, Tally] = {}
    with fresh_server() as server:
        address = f"http://127.0.0.1:{server.port}"
        httpx.put(f"{address}/api/experiment", json=SHORT, trust_env=False).raise_for_status()
        parts: dict[str, Callable[[], Tally]] = {
            "openapi": lambda: run_schemathesis(server.port, seed, counts["openapi"]),
            "http": lambda: to_routes(server, seed, counts["http"], bar("http")),
            "live": lambda: to_socket(server, seed, counts["live"], bar("live")),
        }
        for name, judge in parts.items():
            bar(name)(0.0)
            before = greatest_memory(server.process)
            tallies[name] = judge()
            tallies[name].memory = greatest_memory(server.process) - before
            if tallies[name].memory > MOST_MEMORY:
                text = f"{tallies[name].memory:.0f} MB"
                tallies[name].add(Fault("the server's memory grows", text, name))
            httpx.get(f"{address}/api/health", trust_env=False).raise_for_status()
    return tallies


def greatest_memory(process: int) -> float:
    """Return the greatest memory that a process has had in [MB]; 0 where only Linux would know."""
    status = Path(f"/proc/{process}/status")
    lines = status.read_text().splitlines() if status.is_file() else ()
    return next((int(line.split()[1]) / 1e3 for line in lines if line.startswith("VmHWM")), 0.0)


def row(name: str, tally: Tally) -> list[str]:
    """Return one line of the table."""
    faults = sum(fault.count for fault in tally.faults.values())
    refused = "–" if name == "openapi" else f"{tally.refused:,}"
    slow = ("–", "–") if name == "openapi" else (str(tally.slow), f"{tally.slowest:.2f} s")
    counts = (f"{tally.inputs:,}", f"{tally.accepted:,}", refused, str(faults))
    return [TITLES[name], *counts, *slow, f"{max(0.0, tally.memory):.0f} MB"]


def tell(tallies: dict[str, Tally]) -> None:
    """Print every kind of fault with the smallest input that shows it, and the slowest inputs."""
    for name, tally in tallies.items():
        for fault in tally.faults.values():
            console.print(f"\n{name}: {fault.cause}, {fault.count} times", style="bold red")
            console.print(f"  {fault.detail}\n  input: {fault.example}", markup=False)
        if tally.slow:
            text = f"{name}: slowest, {tally.slowest:.1f} s: {tally.slowest_input[:300]}"
            console.print(text, markup=False)


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A twentieth of it.")] = False,
    keep: Annotated[bool, typer.Option("--record", help="Write the table into the page.")] = False,
    seed: Annotated[int, typer.Option(help="Same seed, same inputs.")] = 1,
    inputs: Annotated[int, typer.Option(min=1000, help="In all, without Schemathesis.")] = INPUTS,
) -> None:
    """Feed wrong input to everything that takes input."""
    total = inputs // 20 if quick else inputs
    counts = {name: round(total * share) for name, share in SHARES.items()}
    counts["openapi"] = 10 if quick else 50
    tallies: dict[str, Tally] = {}

    def bar(name: str) -> Show:
        done = sum(SHARES.get(other, 0.0) for other in tallies)
        return lambda share: show(done + SHARES.get(name, 0.0) * share)

    with progress_bar(console, "Feeding wrong input") as show:
        for name in ("yaml", "patch"):
            tallies[name] = in_process(name, seed, counts[name], bar(name))
        try:
            tallies |= served_parts(seed, counts, bar)
        except (httpx.HTTPError, OSError, RuntimeError):
            end = Tally()
            end.add(Fault("the server does not answer", traceback.format_exc()[-600:], ""))
            tallies["live"] = end
    tell(tallies)
    arguments = f"--seed {seed}" + (" --quick" if quick else "")
    arguments += f" --inputs {inputs}" if inputs != INPUTS else ""
    said = f'make fuzz ARGS="{arguments}"'
    body = f"{provenance(said)}\n\n{table(HEADINGS, [row(*item) for item in tallies.items()])}"
    print(body)
    if keep:
        record("trust.md", "fuzz", body)
    raise typer.Exit(1 if any(tally.faults for tally in tallies.values()) else 0)


if __name__ == "__main__":
    typer.run(main)
