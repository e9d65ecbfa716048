"""Provokes real faults on real processes, and says which promises were kept.

Run it with ``make faults``; ``ARGS="--quick"`` takes less than a minute, ``ARGS="--only NAME"``
takes one fault, ``ARGS="--record"`` writes the table into the documentation.
"""

from __future__ import annotations

import traceback
from time import perf_counter
from typing import Annotated

import typer
from rich.console import Console

from slidetune.server.report.run_bar import progress_bar
from tests.trust.faults import experiments as fault_experiments
from tests.trust.faults import laws as fault_laws
from tests.trust.faults import presets as fault_presets
from tests.trust.faults import process as fault_process
from tests.trust.faults import scene as fault_scene
from tests.trust.faults import studies as fault_studies
from tests.trust.faults import workers as fault_workers
from tests.trust.faults.fault import Fault, Outcome
from tests.trust.report import provenance, record, table

FAULTS: tuple[Fault, ...] = (
    *fault_presets.FAULTS,
    *fault_workers.FAULTS,
    *fault_laws.FAULTS,
    *fault_scene.FAULTS,
    *fault_process.FAULTS,
    *fault_studies.FAULTS,
    *fault_experiments.FAULTS,
)
"""All faults, in the order of the table."""
HEADINGS = ("fault", "how often", "promised", "measured", "kept")

console = Console(stderr=True, highlight=False)


def provoked(fault: Fault, quick: bool) -> Outcome:
    """Provoke a fault; one that stumbles itself counts as broken."""
    try:
        return fault.provoke(quick)
    except Exception as error:
        console.print(traceback.format_exc(), markup=False)
        return Outcome("once", "stopped short", (f"{type(error).__name__}: {error}",))


def row(fault: Fault, outcome: Outcome) -> list[str]:
    """Return a fault's line of the table."""
    measured = "; ".join((outcome.measured, *(f"BROKEN: {text}" for text in outcome.broken)))
    kept = "no" if outcome.broken else "yes"
    cells = [fault.title, outcome.often, fault.promised, measured, kept]
    return [" ".join(cell.split()).replace("|", "\\|") for cell in cells]


def main(
    quick: Annotated[bool, typer.Option("--quick", help="Each fault a few times only.")] = False,
    keep: Annotated[bool, typer.Option("--record", help="Write the table into the page.")] = False,
    only: Annotated[str, typer.Option(metavar="NAME", help="One fault.")] = "",
) -> None:
    """Provoke every fault and print what was promised and what was measured."""
    names = [fault.name for fault in FAULTS]
    if only and only not in names:
        raise typer.BadParameter(f"no fault {only}; there are: {', '.join(names)}")
    chosen = [fault for fault in FAULTS if only in ("", fault.name)]
    rows, broken = [], False
    with progress_bar(console, "Breaking things") as show:
        for done, fault in enumerate(chosen):
            begin = perf_counter()
            outcome = provoked(fault, quick)
            rows.append(row(fault, outcome))
            broken |= bool(outcome.broken)
            verdict = "BROKEN" if outcome.broken else "kept"
            text = f"{fault.name}: {verdict}, {perf_counter() - begin:.0f} s"
            console.print(text, markup=False)
            show((done + 1) / len(chosen))
    command = "make faults" + (' ARGS="--quick"' if quick else "")
    body = f"{provenance(command)}\n\n{table(HEADINGS, rows)}"
    print(body)
    if keep:
        record("trust.md", "faults", body)
    raise typer.Exit(1 if broken else 0)


if __name__ == "__main__":
    typer.run(main)
