"""What is recorded as comma-separated values."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from slidetune.server.exports.columns import columns_of
from slidetune.server.exports.recorded import Recorded

_FORMULAS = ("=", "+", "-", "@")
"""How a cell begins that a spreadsheet computes when it opens a file."""
_CHUNK = 2000
"""Rows turned into text at a time (*ours*)."""


def csv_lines(recorded: Recorded) -> Iterator[str]:
    """Yield its columns line by line, their names first; what isn't a number is left empty.

    A name that a spreadsheet would take for a formula has an apostrophe before it. Every number has
    all its digits: read back, it is the same to the last bit.
    """
    columns, header = columns_of(recorded), io.StringIO()
    csv.writer(header, lineterminator="\n").writerow([_harmless(name) for name, _ in columns])
    yield header.getvalue()
    for begin in range(0, len(columns[0][1]), _CHUNK):
        parts = [values[begin : begin + _CHUNK].tolist() for _, values in columns]
        for row in zip(*parts, strict=True):
            yield ",".join(["" if value != value else repr(value) for value in row]) + "\n"


def _harmless(cell: str) -> str:
    return f"'{cell}" if cell.startswith(_FORMULAS) else cell
