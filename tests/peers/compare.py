"""``make peers``: the same closed loop here and in other simulators, in speed and in truth.

The loop is RBFNN-NFTSM of the paper with the published gains. Its error is measured undisturbed
against the reference in ``tests/data``; its time with the disturbance of the preset ``paper``.
"""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console

from slidetune.server.report.run_bar import progress_bar
from tests.peers.contest import (
    PROBE,
    Entry,
    Worker,
    distance,
    entries,
    follow_reference,
    ratio,
    run_rounds,
)
from tests.peers.environments import PEERS, UnavailablePeerError, is_ready
from tests.peers.preset_problem import preset_problem
from tests.peers.problem import SAMPLE
from tests.peers.responses import HEADINGS as RESPONSE_HEADINGS
from tests.peers.responses import Responder, responders, row, run_responses, strays
from tests.trust.report import provenance, record, table

REFERENCE = Path(__file__).resolve().parents[1] / "data" / "rbfnn-nftsm.csv"
AGREEMENT = 1e-6
"""Greatest difference in angle [rad] that two runs of one scheme may have (*ours*)."""
PATIENCE = (20.0, 3.0)
"""Processor time [s] for a comparison with the reference and for one timed run (*ours*)."""
HEADINGS = (
    "closed loop",
    "scheme",
    "M and h alone [µs]",
    "whole step [µs]",
    "× real time",
    "time / ours",
    "error [rad]",
)
SCHEMES = {
    "plain": "plain",
    "extrapolated": "extrapolated",
    "own": "its own",
    "held": "1 ms hold",
    "open": "open loop",
}


def _start(console: Console, stack: ExitStack) -> tuple[list[Worker], list[str]]:
    """Return what runs here, ours first, and why the others don't."""
    workers, skipped = [], []
    for peer in PEERS:
        if not is_ready(peer):
            console.print(f"Installing {peer.title} into build/peers/{peer.name} …")
        try:
            worker = Worker(peer)
        except UnavailablePeerError as error:
            if not peer.requirement:
                raise
            skipped.append(f"{peer.title} is skipped: {error}.")
            continue
        stack.callback(worker.close)
        workers.append(worker)
    return workers, skipped


def _warm_up(
    console: Console, workers: list[Worker], steps: int, patience: tuple[float, float]
) -> tuple[list[Entry], list[str]]:
    """Return the contest, each loop compared with the reference, and who fell out and why."""
    problem = preset_problem("paper-undisturbed")
    truth = np.loadtxt(REFERENCE, delimiter=",", skiprows=1)[:, 1:7]
    contest, skipped = [], []
    with progress_bar(console, "Comparing with the reference") as show:
        for number, worker in enumerate(workers):
            own = entries(worker)
            try:
                for entry in own:
                    follow_reference(entry, problem, truth, steps, patience)
                contest += own
            except UnavailablePeerError as error:
                if not worker.peer.requirement:
                    raise
                skipped.append(f"{worker.version} fell out: {error}.")
            show((number + 1) / len(workers))
    return contest, skipped


def _base(entry: Entry, contest: list[Entry]) -> Entry:
    """Return our own run of the same scheme, or the extrapolated one for a scheme not ours."""
    own = {other.scheme: other for other in contest if other.worker is contest[0].worker}
    return own.get(entry.scheme, own["extrapolated"])


def _figure(value: float) -> str:
    return f"{value:.0f}" if value >= 99.5 else f"{value:.2g}"


def _row(entry: Entry, contest: list[Entry], period: float, seconds: float) -> list[str]:
    title = [f"{entry.worker.version}: {entry.name}", SCHEMES[entry.scheme]]
    if entry.diverged is not None:
        return [*title, "", "", "", "", f"diverges at {1000 * entry.diverged:g} ms"]
    alone = ""
    if entry.number == 0:
        dynamics = next(e for e in contest if e.worker is entry.worker and e.number is None)
        alone = _figure(1e6 * float(np.median(dynamics.times)))
    time, base = float(np.median(entry.times)), _base(entry, contest)
    relative = "1" if entry is base else _figure(ratio(entry, base))
    error = f"{entry.error:.1e}"
    if entry.compared < seconds - 0.5 * period:
        error += f" ({entry.compared:.2g} s)"
    return [*title, alone, _figure(1e6 * time), _figure(period / time), relative, error]


def _table(contest: list[Entry], period: float, seconds: float) -> str:
    loops = [entry for entry in contest if entry.number is not None]
    return table(HEADINGS, [_row(entry, contest, period, seconds) for entry in loops])


def _broken(contest: list[Entry], responses: list[Responder], sample: float) -> list[str]:
    """Return what contradicts that one scheme gives one motion, whoever computes it."""
    lost = [
        f"{way.workers[0].version}, {way.name}: {off:.1e} rad from ours"
        for way, off in strays(responses, sample, AGREEMENT)
    ]
    return lost + [
        f"{entry.worker.version}, {entry.name}, {entry.scheme}: "
        + (f"{distance(entry, base):.1e} rad from ours" if entry.times else "diverges")
        for entry in contest
        if entry.scheme in ("plain", "extrapolated")
        and (base := _base(entry, contest)) is not entry
        and not (entry.times and distance(entry, base) <= AGREEMENT)
    ]


def main(
    quick: Annotated[bool, typer.Option(help="A look instead of figures: 1 s, 1 round.")] = False,
    write: Annotated[
        bool, typer.Option("--record", help="Write the table into docs/performance.md.")
    ] = False,
    seconds: Annotated[float, typer.Option(min=0.1, max=10.0, help="Length of the loop.")] = 10.0,
    rounds: Annotated[int, typer.Option(min=1, help="Timed runs of each.")] = 7,
) -> None:
    """Time the same closed loop here and in other simulators."""
    console = Console()
    if quick:
        seconds, rounds = min(seconds, 1.0), 1
    patience = (PATIENCE[0] / 10, PATIENCE[1] / 10) if quick else PATIENCE
    problem = preset_problem("paper")
    steps = max(round(seconds / problem.h), PROBE)
    with ExitStack() as stack:
        workers, skipped = _start(console, stack)
        contest, fallen = _warm_up(console, workers, steps, patience)
        with progress_bar(console, f"Timing, {rounds} rounds") as show:
            run_rounds(contest, problem, rounds, show)
        responses = responders(workers, contest, problem, steps, stack)
        with progress_bar(console, f"Whole responses, {rounds} rounds") as show:
            run_responses(responses, problem, steps, rounds, show)
    whole = f"Whole responses of {steps * problem.h:g} s a second:"
    rows = [row(one, responses, SCHEMES, _figure) for one in responses]
    about = f"Medians of {rounds} rounds; of whole responses the best."
    command = f'make peers ARGS="--seconds {seconds:g} --rounds {rounds}"'
    tables = [_table(contest, problem.h, seconds), whole, table(RESPONSE_HEADINGS, rows)]
    body = "\n\n".join([*tables, *skipped, *fallen, about, provenance(command)])
    console.print(body, markup=False, soft_wrap=True)
    if write:
        record("performance.md", "peers", body)
    broken = _broken(contest, responses, SAMPLE * problem.h)
    for line in broken:
        console.print(f"Not the same motion: {line}", markup=False, style="red")
    raise typer.Exit(1 if broken else 0)


if __name__ == "__main__":
    typer.run(main)
