"""The kinds of file that what is recorded can be written as."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

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
    # The server, which writes none itself, starts without what writes them.
    if format == "csv":
        from slidetune.server.exports.csv_file import csv_lines

        yield from (line.encode() for line in csv_lines(recorded))
    elif format == "parquet":
        from slidetune.server.exports.parquet_file import parquet_of

        yield parquet_of(recorded)
    else:
        from slidetune.server.exports.mcap_file import mcap_of

        yield mcap_of(recorded)
