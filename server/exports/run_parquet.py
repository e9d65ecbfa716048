"""A run as a Parquet file."""

from __future__ import annotations

import io
import re

import numpy as np
from arro3.core import Array, DataType, Field, Schema, Table
from arro3.io import write_parquet

from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.loop.simulate import Run
from slidetune.robot.version import __version__
from slidetune.server.exports.run_columns import run_columns

_NAMED = re.compile(r"(.*) \[(.*)\]")


def run_parquet(run: Run) -> bytes:
    """Return a run as Parquet: the columns of its CSV, and in the metadata of each its unit.

    The file's metadata hold the experiment as YAML, and the version that made it.
    """
    fields, columns = [], []
    for name, values in run_columns(run):
        found = _NAMED.fullmatch(name)
        unit = found[2] if found else ""
        fields.append(Field(name, DataType.float64(), metadata={"unit": unit}))
        columns.append(Array.from_numpy(np.ascontiguousarray(values)))
    said = {"experiment": experiment_to_yaml(run.experiment), "slidetune": __version__}
    file = io.BytesIO()
    write_parquet(Table.from_arrays(columns, schema=Schema(fields, metadata=said)), file)
    return file.getvalue()
