"""`make soak`: many clients at once, then a long day of visitors; nothing may be left of them."""

from __future__ import annotations

import logging
import tempfile
from contextlib import AbstractContextManager
from typing import Annotated

import typer
from rich.console import Console

from slidetune.server.bench.served import RunningServer, running_server
from tests.trust.bar import Bar, progress
from tests.trust.footprint import PROC, can_look, children
from tests.trust.report import provenance, record
from tests.trust.soak.day import Day, spend
from tests.trust.soak.load import measure_load
from tests.trust.soak.report import judge
from tests.trust.soak.verdict import Verdict

PAGE = "trust.md"
QUICK = 20.0
"""Length of a quick soak in [s] (*ours*)."""
NEEDED = 2
"""Exit code where the system can't tell what a process holds."""

console = Console(highlight=False)


def main(
    minutes: Annotated[float, typer.Option(min=0.0, help="Length of the soak; 0: none.")] = 30.0,
    quick: Annotated[bool, typer.Option("--quick", help="A short look at everything.")] = False,
    load: Annotated[bool, typer.Option(help="Whether to measure many clients first.")] = True,
    write: Annotated[
        bool, typer.Option("--record", help="Write the figures into docs/trust.md.")
    ] = False,
) -> None:
    """Serve many clients, then soak; exit with 1 where a promise is broken."""
    if not can_look():
        console.print("The soak reads /proc to see what a process holds: it needs Linux.")
        raise typer.Exit(NEEDED)
    # Visitors that break off on purpose are no news.
    logging.getLogger("websockets").setLevel(logging.CRITICAL)
    verdicts = {}
    with tempfile.TemporaryDirectory() as presets, progress(console) as bar:
        if load:
            bar.show("Load: starting a server", 0.0)
            with _server(presets) as server:
                verdicts["load"] = measure_load(server, quick, bar)
        seconds = QUICK if quick else 60.0 * minutes
        if seconds:
            verdicts["soak"] = _soak(presets, seconds, bar)
    command = "make soak" + (f' ARGS="--minutes {minutes:g}"' if minutes != 30.0 else "")
    for name, verdict in verdicts.items():
        body = f"{verdict.body}\n\n{provenance(command)}"
        console.print(f"\n{name.upper()}\n\n{body}\n", markup=False, soft_wrap=True)
        if write:
            record(PAGE, name, body)
    _conclude(list(verdicts.values()))


def _server(presets: str) -> AbstractContextManager[RunningServer]:
    return running_server(
        (), {"SLIDETUNE_PRESETS": presets, "SLIDETUNE_STUDIES": f"{presets}/studies"}
    )


def _soak(presets: str, seconds: float, bar: Bar) -> Verdict:
    bar.show("Soak: starting a server", 0.0)
    with _server(presets) as server:
        day = spend(server, seconds, bar)
        offspring = children(server.process)
    for line in server.said:
        if "Traceback" in line or "tick of the session failed" in line:
            day.world.fail(f"the server's log: {line}")
    return judge(day, _orphans(server, day, offspring, bar))


def _orphans(server: RunningServer, day: Day, offspring: frozenset[int], bar: Bar) -> int:
    """Return how many of the server's processes are still there a while after its end."""
    family = {server.process} | offspring | day.most.children

    def left() -> list[int]:
        return [process for process in family if (PROC / str(process)).exists()]

    bar.wait("Soak: the server has ended; are its processes gone?", 10.0, lambda: not left())
    return len(left())


def _conclude(verdicts: list[Verdict]) -> None:
    for verdict in verdicts:
        for text in verdict.missed:
            console.print(f"Target missed: {text}", markup=False, soft_wrap=True)
        for text in verdict.broken:
            console.print(f"PROMISE BROKEN: {text}", markup=False, soft_wrap=True)
    if any(verdict.broken for verdict in verdicts):
        raise typer.Exit(1)
    console.print("All promises are kept.")


if __name__ == "__main__":
    typer.run(main)
