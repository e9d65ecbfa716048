"""The benchmark: machine, control step, whole runs and live session, held against targets."""

from __future__ import annotations

import json
import os
import platform
import sys
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from slidetune.robot.version import __version__
from slidetune.server.bench.compiling import measure_compiling
from slidetune.server.bench.live import measure_live
from slidetune.server.bench.result import Measurement
from slidetune.server.bench.searches import measure_searches
from slidetune.server.bench.served import machine_load
from slidetune.server.bench.steps import measure_steps
from slidetune.server.report.run_bar import progress_bar

Results = dict[str, Any]

PACKAGES = ("pin", "numba", "numpy", "uvicorn", "websockets", "viser")
HEADINGS = ("", "best", "median", "× floor", "target", "met")


def _processor() -> str:
    """Return the name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def machine() -> dict[str, Any]:
    """Return what the figures depend on: processor, cores, load, versions."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load": machine_load(),
        "system": platform.platform(),
        "python": sys.version.split()[0],
        "slidetune": __version__,
        **{name: version(name) for name in PACKAGES},
    }


def measure(quick: bool, live: bool, console: Console) -> Results:
    """Measure everything, with a progress bar.

    Args:
        quick: short and few, for a look instead of a verdict.
        live: whether to start a real server too.
        console: where the bar is shown.

    Returns:
        ``machine``, ``quick`` and ``rows``, as plain JSON values.
    """
    about = machine()
    with progress_bar(console, "Control steps and runs") as show:
        rows = measure_steps(quick, show)
    with progress_bar(console, "Searches and draws") as show:
        rows += measure_searches(quick, show)
    if not quick:
        with progress_bar(console, "Compilation") as show:
            rows += measure_compiling(show)
    if live:
        with progress_bar(console, "Live session") as show:
            rows += measure_live(quick, show)
    if quick:  # too short to be judged
        rows = [replace(row, target=None, most=None) for row in rows]
    return {"machine": about, "quick": quick, "rows": [row.document() for row in rows]}


def bench_text(results: Results) -> str:
    """Return the results as strict JSON."""
    return json.dumps(results, allow_nan=False, ensure_ascii=False, indent=1)


def _figure(value: float | None, unit: str = "") -> str:
    return "—" if value is None else f"{value:.3g} {unit}".rstrip()


def _cells(row: dict[str, Any]) -> list[Text]:
    measured = Measurement(**{key: value for key, value in row.items() if key != "met"})
    unit = measured.unit
    target = "" if measured.target is None else f"{measured.limit} {_figure(measured.target, unit)}"
    if measured.high is not None:
        target += f"; 95th percentile {_figure(measured.high, unit)}"
    if measured.most is not None:
        target += f"; {measured.most:g} × floor"
    verdict = {True: "yes", False: "NO", None: ""}[measured.met]
    return [
        Text(f"{measured.name} ({measured.note})" if measured.note else measured.name),
        Text(_figure(measured.best, unit)),
        Text(_figure(measured.typical, unit)),
        Text("" if measured.ratio is None else f"{measured.ratio:.2f}"),
        Text(target.removeprefix("; ")),
        Text(verdict, style="red" if measured.met is False else "green"),
    ]


def print_bench(results: Results, console: Console) -> None:
    """Print what ``measure`` returned."""
    about = dict(results["machine"])
    load = "unknown" if about["load"] is None else f"{about['load']:.1f}"
    console.print(Text(f"{about['processor']}, {about['cores']} cores, load {load}", style="bold"))
    versions = ", ".join(f"{name} {about[name]}" for name in ("python", "slidetune", *PACKAGES))
    console.print(Text(f"{about['system']}; {versions}"))
    if results["quick"]:
        console.print(Text("Quick run: short, few repeats, no verdict.", style="yellow"))
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in HEADINGS:
        numeric = heading in ("best", "median", "× floor")
        table.add_column(Text(heading), justify="right" if numeric else "left")
    for row in results["rows"]:
        table.add_row(*_cells(row))
    console.print(table)
    console.print(
        Text(
            "Steps: processor time of one step of one lane through simulate(), all of it counted; "
            "runs: time on the wall. simulate() has M and h from the compiled recursion, the live "
            "session from Pinocchio. × floor: median ratio in the same rounds, which a busy "
            "machine hardly moves, to what Pinocchio needs from Python: M and h twice for an "
            "extrapolated step, once else."
        )
    )
