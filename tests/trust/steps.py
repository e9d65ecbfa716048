"""What a control step costs against Pinocchio alone: the benchmark's rows as a page's table."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import typer

from tests.trust.report import provenance, record, table


def _figure(value: float | None, unit: str = "") -> str:
    return "" if value is None else f"{value:.3g} {unit}".rstrip()


def _row(row: dict[str, Any]) -> list[str]:
    unit = row["unit"]
    target = []
    if row["target"] is not None:
        sign = "≥" if row["limit"] == "at least" else "≤"
        target.append(f"{sign} {_figure(row['target'], unit)}")
    if row["most"] is not None:
        target.append(f"≤ {row['most']:g} × floor")
    typical = row["typical"] if row["high"] is None else row["high"]
    name = row["name"] if row["high"] is None else f"{row['name']} (95th percentile)"
    ratio = "" if row["ratio"] is None else f"{row['ratio']:.2f}"
    met = {True: "yes", False: "**no**", None: ""}[row["met"]]
    return [name, _figure(row["best"], unit), _figure(typical, unit), ratio, ", ".join(target), met]


def main(keep: bool = typer.Option(False, "--record", help="Write docs/performance.md.")) -> None:
    """Run the benchmark and print its rows as Markdown."""
    command = [sys.executable, "-m", "slidetune", "bench", "--json", "-"]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True, encoding="utf-8")
    rows = json.loads(done.stdout)["rows"]
    headings = ["", "best", "median", "× floor", "target", "met"]
    shown = table(headings, [_row(row) for row in rows])
    body = f"{shown}\n\n{provenance('python -m tests.trust.steps --record')}"
    print(body)
    if keep:
        record("performance.md", "steps", body)


if __name__ == "__main__":
    typer.run(main)
