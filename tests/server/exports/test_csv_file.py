"""A run as comma-separated values."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.exports.columns import columns_of
from slidetune.server.exports.csv_file import csv_lines
from slidetune.server.exports.recorded_run import recorded_run


def experiment(mode: str) -> Experiment:
    lanes = {"A": {"law": "nftsm"}, 'B "b"': {"law": "rbfnn_nftsm"}}
    return Experiment.from_document({"lanes": lanes, "simulation": {"mode": mode, "horizon": 0.2}})


@pytest.fixture(scope="module")
def calm() -> Run:
    return simulate(experiment("continuous"))


@pytest.fixture(scope="module")
def wild() -> Run:
    return simulate(experiment("sampled"))


def read(run: Run) -> tuple[list[str], np.ndarray]:
    header, *rows = csv.reader("".join(csv_lines(recorded_run(run))).splitlines())
    return header, np.array([[float(cell or "nan") for cell in row] for row in rows])


def test_every_number_reads_back_to_the_last_bit(calm: Run) -> None:
    header, values = read(calm)
    names = [name for name, _ in columns_of(recorded_run(calm))]
    assert header == names
    assert np.array_equal(
        values, np.column_stack([column for _, column in columns_of(recorded_run(calm))])
    )


def test_columns_hold_the_whole_run(calm: Run) -> None:
    header, values = read(calm)
    column = dict(zip(header, values.T, strict=True))
    lane = calm.lanes['B "b"']
    assert np.array_equal(column["time [s]"], calm.time)
    assert np.array_equal(column["v_d3 [rad/s]"], calm.v_d[:, 2])
    for group, unit in {
        "q": "rad",
        "v": "rad/s",
        "tau": "N·m",
        "S": "rad/s",
        "e": "rad",
        "de": "rad/s",
        "f": "N·m",
    }.items():
        for joint in range(6):
            expected = getattr(lane, group)[:, joint]
            assert np.array_equal(column[f'B "b"/{group}{joint + 1} [{unit}]'], expected)
    assert np.array_equal(column["A/flange_z [m]"], calm.lanes["A"].flange[:, 2])
    assert np.array_equal(column["flange_d_x [m]"], lane.flange_desired[:, 0])


def test_a_lane_that_diverged_leaves_empty_cells_and_never_nan(wild: Run) -> None:
    assert wild.lanes["A"].freeze is not None
    text = "".join(csv_lines(recorded_run(wild)))
    assert "nan" not in text
    header, values = read(wild)
    stopped = np.isnan(values[:, header.index("A/q1 [rad]")])
    assert stopped.any()
    assert np.array_equal(stopped, ~np.isfinite(wild.lanes["A"].q[:, 0]))


def test_no_name_of_a_lane_becomes_a_formula() -> None:
    names = ["=1+1", "+1", "-1", "@A1", "a=1"]
    document = {"lanes": {name: {"law": "nftsm"} for name in names}}
    short = Experiment.from_document({**document, "simulation": {"horizon": 0.1}})
    header, _ = read(simulate(short))
    assert not [cell for cell in header if cell[0] in "=+-@"]
    assert "'=1+1/q1 [rad]" in header
    assert "a=1/q1 [rad]" in header
