"""A run as a table of numbers: every column that it holds, each with its unit."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

import numpy as np

from slidetune.robot.arm.known import arm_named
from slidetune.robot.fields.units import unit_of_joints
from slidetune.robot.loop.simulate import Run

Array = np.ndarray

AXES = ("x", "y", "z")
LANE_COLUMNS = (
    ("q", "rad"),
    ("v", "rad/s"),
    ("tau", "N·m"),
    ("S", "rad/s"),
    ("e", "rad"),
    ("de", "rad/s"),
    ("f", "N·m"),
    ("weights", "N·m"),
)
"""Name and unit of a lane's groups of columns, where a joint turns."""

_FORMULAS = ("=", "+", "-", "@")
"""How a cell begins that a spreadsheet computes when it opens a file."""
_CHUNK = 2000
"""Rows turned into text at a time (*ours*)."""


def run_columns(run: Run) -> list[tuple[str, Array]]:
    """Return name with unit and values of every column, such as ``("NFTSM/q1 [rad]", …)``.

    Rows after a lane left its bounds are NaN there.
    """
    slides = arm_named(run.experiment.robot.model).slides
    columns = [("time [s]", run.time)]
    columns += _joints("q_d", "rad", run.q_d, slides) + _joints("v_d", "rad/s", run.v_d, slides)
    lanes = run.lanes.items()
    columns += _axes("flange_d", next(iter(run.lanes.values())).flange_desired)
    for name, lane in lanes:
        for group, unit in LANE_COLUMNS:
            columns += _joints(f"{name}/{group}", unit, getattr(lane, group), slides)
        columns += _axes(f"{name}/flange", lane.flange)
    return columns


def _joints(name: str, unit: str, block: Array, slides: Sequence[bool]) -> list[tuple[str, Array]]:
    return [
        (f"{name}{joint + 1} [{unit_of_joints(unit, [slide])}]", block[:, joint])
        for joint, slide in enumerate(slides)
    ]


def _axes(name: str, block: Array) -> list[tuple[str, Array]]:
    return [(f"{name}_{axis} [m]", block[:, index]) for index, axis in enumerate(AXES)]


def _harmless(cell: str) -> str:
    return f"'{cell}" if cell.startswith(_FORMULAS) else cell


def csv_lines(run: Run) -> Iterator[str]:
    """Yield a run as comma-separated values, header first; what isn't a number is left empty.

    A lane's name that a spreadsheet would take for a formula has an apostrophe before it. Every
    number has all its digits: read back, it is the same to the last bit.
    """
    columns = run_columns(run)
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow([_harmless(name) for name, _ in columns])
    yield header.getvalue()
    for begin in range(0, len(run.time), _CHUNK):
        block = np.column_stack([values[begin : begin + _CHUNK] for _, values in columns])
        for row in block.tolist():
            yield ",".join(["" if value != value else repr(value) for value in row]) + "\n"
