"""Parquet as pandas and pyarrow read it."""

from __future__ import annotations

import io

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.robot.version import __version__
from slidetune.server.exports.columns import columns_of
from slidetune.server.exports.parquet_file import parquet_of
from slidetune.server.exports.recorded_run import recorded_run
from tests.server.exports.exported import short_experiment


@pytest.fixture(scope="module")
def run() -> Run:
    return simulate(short_experiment(), estimate=False)


@pytest.fixture(scope="module")
def content(run: Run) -> bytes:
    return parquet_of(recorded_run(run))


def test_every_number_reads_back_to_the_last_bit(run: Run, content: bytes) -> None:
    table = pd.read_parquet(io.BytesIO(content))
    columns = columns_of(recorded_run(run))
    assert list(table.columns) == [name for name, _ in columns]
    for name, values in columns:
        assert np.array_equal(table[name].to_numpy(), values, equal_nan=True)
    assert table["lane-1/q1 [rad]"].isna().any()


def test_units_experiment_and_version_are_in_its_metadata(run: Run, content: bytes) -> None:
    schema = pq.read_schema(io.BytesIO(content))
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    assert units["time [s]"] == "s"
    assert units["Lane 1/tau3 [N·m]"] == "N·m"
    assert experiment_from_yaml(schema.metadata[b"experiment"]) == run.experiment
    assert schema.metadata[b"edits"] == b"[]"
    assert schema.metadata[b"slidetune"].decode() == __version__
