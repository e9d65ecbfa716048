"""Columns as a Parquet file."""

from __future__ import annotations

import io
import json
import re

import numpy as np
from arro3.core import Array, Field, Schema, Table
from arro3.io import write_parquet

from slidetune.robot.version import __version__
from slidetune.server.exports.columns import columns_of
from slidetune.server.exports.recorded import Recorded

_NAMED = re.compile(r"(.*) \[(.*)\]")
_COMPRESSION = "zstd(3)"


def parquet_of(recorded: Recorded) -> bytes:
    """Return what is recorded as Parquet; NaN where a lane stood still.

    Each column has its ``unit`` in its metadata, the file ``experiment`` (YAML, at the first row),
    ``edits`` (JSON) and ``slidetune``, the version that made it.
    """
    fields, arrays = [], []
    for name, values in columns_of(recorded):
        found = _NAMED.fullmatch(name)
        array = Array.from_numpy(np.ascontiguousarray(values))
        arrays.append(array)
        metadata = {"unit": found[2] if found else ""}
        fields.append(Field(name, array.type, nullable=True, metadata=metadata))
    edits = [{"time": edit.time, **edit.content} for edit in recorded.edits]
    said = {
        "experiment": recorded.yaml,
        "edits": json.dumps(edits, ensure_ascii=False),
        "slidetune": __version__,
    }
    table = Table.from_arrays(arrays, schema=Schema(fields, metadata=said))
    file = io.BytesIO()
    write_parquet(table, file, compression=_COMPRESSION)
    return file.getvalue()
