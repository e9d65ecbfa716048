"""Table 2 of the paper beside ours: what is published, what comes out, what does not.

Source: Liu et al., Symmetry 2025, 17(8), 1319.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isnan
from typing import Literal

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from slidetune.robot.loop.figures import FIGURES
from slidetune.robot.loop.simulate import LaneRun, Run
from slidetune.server.report.run_report import NONE, heading

UNDISTURBED, DISTURBED, QUINTIC = "paper-undisturbed", "paper", "experiment-quintic"
PRESETS = (UNDISTURBED, DISTURBED, QUINTIC)
"""Presets of the comparison: at rest and undisturbed; with the inferred torque; the experiment."""
LAWS = ("RBFNN-NFTSM", "RBFNN-SMC", "NFTSM")
"""Lanes of all three, in the paper's order."""
FITTED = "NFTSM"
"""The lane to whose three mean errors the torque of ``paper`` was fitted."""
SETTLED = 1.0
"""Time from which on velocity errors count in [s] (*inferred*: the start is all arm and no law)."""
CLOSE = 0.25
"""Share of the published figure within which ours counts as the same (*ours*)."""

Verdict = Literal["published", "same", "different", "fitted"]
MARKS: dict[Verdict, str] = {"published": "", "same": " ≈", "different": " ≠", "fitted": " f"}
STYLES: dict[Verdict, str] = {
    "published": "bold",
    "same": "green",
    "different": "red",
    "fitted": "yellow",
}
_GREATEST = (FIGURES["max_error"], FIGURES["max_velocity_error"])
_FLANGE = (FIGURES["flange_max"], FIGURES["flange_rms"])
HEADINGS = (
    "law",
    "where from",
    *(f"joint {joint} [{FIGURES['mae'].unit}]" for joint in (1, 2, 3)),
    *(f"{figure.heading} [{figure.unit}]" for figure in _GREATEST),
)
FLANGE_HEADINGS = ("law", "preset", *(heading(figure) for figure in _FLANGE))
SOURCES = {UNDISTURBED: "S0: at rest, F = 0", DISTURBED: "S1: F inferred"}


@dataclass(frozen=True)
class Cell:
    """One figure of the table.

    Attributes:
        value: in [rad] or [rad/s]; NaN where the lane stopped before there was one.
        verdict: how it stands to the published one.
    """

    value: float
    verdict: Verdict

    def text(self) -> str:
        """Return the figure and its mark; a published one as it was printed."""
        if isnan(self.value):
            return NONE
        number = f"{self.value:g}" if self.verdict == "published" else f"{self.value:.4f}"
        return f"{number}{MARKS[self.verdict]}"


@dataclass(frozen=True)
class Row:
    """One row of the table.

    Attributes:
        law: name of the law.
        source: where its figures come from.
        cells: mean absolute error of joints 1 to 3 in [rad], greatest error of these in [rad],
            greatest velocity error in [rad/s].
    """

    law: str
    source: str
    cells: tuple[Cell, ...]


PUBLISHED: Mapping[str, tuple[float, ...]] = {
    "RBFNN-NFTSM": (0.004, 0.03, 0.004, 0.05, 0.03),
    "RBFNN-SMC": (0.02, 0.04, 0.014, 0.1, 0.5),
    "NFTSM": (0.034, 0.05, 0.03, 0.15, 0.18),
}
"""Table 2 and the greatest errors in the text beside it (*published*)."""


def figures(lane: LaneRun) -> tuple[float, ...]:
    """Return a lane's five figures as the paper counts them: joints 1 to 3, de for t > 1 s."""
    whole, settled = lane.metrics, lane.metrics_since(SETTLED)
    return (
        *(float(value) for value in whole.mae[:3]),
        float(whole.max_error[:3].max()),
        float(settled.max_velocity_error[:3].max()),
    )


def _cell(value: float, published: float, fitted: bool) -> Cell:
    if fitted:
        return Cell(value, "fitted")
    return Cell(value, "same" if abs(value - published) <= CLOSE * published else "different")


def _row(law: str, preset: str, lane: LaneRun) -> Row:
    fitted = law == FITTED and preset == DISTURBED
    cells = (
        _cell(value, published, fitted and column < 3)
        for column, (value, published) in enumerate(zip(figures(lane), PUBLISHED[law], strict=True))
    )
    return Row(law, SOURCES[preset], tuple(cells))


def comparison(runs: Mapping[str, Run]) -> list[Row]:
    """Return the table: for each law the published row, then ours without and with a torque.

    Args:
        runs: the runs of ``paper-undisturbed`` and ``paper``, by name.
    """
    rows = []
    for law in LAWS:
        cells = tuple(Cell(value, "published") for value in PUBLISHED[law])
        rows.append(Row(law, "published", cells))
        rows += [_row(law, name, runs[name].lanes[law]) for name in SOURCES]
    return rows


def flange_rows(runs: Mapping[str, Run]) -> list[tuple[str, ...]]:
    """Return law, preset, greatest and effective flange error in [mm] of the experiment."""
    rows = []
    for law in LAWS:
        metrics = runs[QUINTIC].lanes[law].metrics
        errors = (f"{getattr(metrics, each.name) * each.factor:.1f}" for each in _FLANGE)
        rows.append((law, QUINTIC, *errors))
    return rows


def legend() -> str:
    """Say what the marks mean."""
    return (
        f"Mean |e| of joints 1 to 3 and the maximum errors of these; |de| for t > {SETTLED:g} s. ≈ "
        f"within {CLOSE:.0%} of the published value. ≠ further off: not reproduced. f: the torque "
        "of S1 was fitted to these three values, so their agreement proves nothing."
    )


def remarks(runs: Mapping[str, Run]) -> Iterator[str]:
    """Say in words what comes out, what does not, and what had to be guessed."""
    wrists = runs[DISTURBED].lanes[LAWS[0]].metrics.mae[3:]
    listed = ", ".join(f"{value:.1g}" for value in wrists)
    yield (
        "Assumed, because the paper does not give them: the disturbance (one constant torque for "
        "all laws), the initial velocity, λ of RBFNN-SMC, and 10 s for the experiment. The arm is "
        "the manufacturer's description, 96.4 kg of solid steel; the real one weighs 23 kg. Its "
        "weight causes the error of joint 2."
    )
    yield (
        "Reproduced under S1: the proposed law's mean errors, its maximum error and its maximum "
        "velocity error; the mean error of joint 2 under RBFNN-SMC; the order of the laws' mean "
        "errors, in which NFTSM's place is fitted."
    )
    yield (
        "Not reproduced: no constant torque gives RBFNN-SMC a larger error on joint 1 than on "
        "joint 3; none gives all three maximum velocity errors at the same time; and joints 4 to 6 "
        f"do not behave like joints 1 to 3 under the proposed law: their mean errors are {listed} "
        "rad."
    )
    yield (
        "Without a disturbance (S0) NFTSM, whose model is then exact, is the most accurate of the "
        "three: the published order depends on the disturbance."
    )


def _styled(row: Row) -> list[Text]:
    cells = [Text(cell.text(), style=STYLES[cell.verdict]) for cell in row.cells]
    return [Text(row.law), Text(row.source), *cells]


def _table(headings: tuple[str, ...], words: int) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, title in enumerate(headings):
        table.add_column(Text(title), justify="left" if index < words else "right")
    return table


def print_comparison(runs: Mapping[str, Run], console: Console) -> None:
    """Print the table, the flange errors and the remarks.

    Args:
        runs: the runs of all ``PRESETS``, by name.
        console: where to.
    """
    console.print(Text("Table 2 of Liu et al. 2025 beside ours", style="bold"))
    table = _table(HEADINGS, 2)
    for row in comparison(runs):
        if row.source == "published" and table.rows:
            table.add_section()
        table.add_row(*_styled(row))
    console.print(table)
    console.print(Text(legend()))
    console.print()
    console.print(Text("Flange error of the experiment (the paper shows curves, no values)"))
    flange = _table(FLANGE_HEADINGS, 2)
    for cells in flange_rows(runs):
        flange.add_row(*(Text(cell) for cell in cells))
    console.print(flange)
    for remark in remarks(runs):
        console.print(Text(remark))
        console.print()
