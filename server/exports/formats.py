"""The kinds of file that what is recorded can be written as."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from slidetune.server.exports.csv_file import csv_lines
from slidetune.server.exports.mcap_file import mcap_of
from slidetune.server.exports.parquet_file import parquet_of
from slidetune.server.exports.recorded import Recorded

Format = Literal["csv", "parquet", "mcap"]
MEDIA: dict[Format, str] = {
    "csv": "text/csv",
    "parquet": "application/vnd.apache.parquet",
    "mcap": "application/octet-stream",
}
"""Media types; MCAP has none of its own."""


def written_as(recorded: Recorded, format: Format) -> Iterator[bytes]:
    """Yield the content of a file, piece by piece."""
    if format == "csv":
        yield from (line.encode() for line in csv_lines(recorded))
    elif format == "parquet":
        yield parquet_of(recorded)
    else:
        yield mcap_of(recorded)
