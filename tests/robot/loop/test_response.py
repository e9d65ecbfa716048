"""A whole response, thinned out: nothing that sticks out may be lost."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.response import lane_response, response_channels, thinned
from slidetune.robot.loop.simulate import simulate

Array = np.ndarray


def slowly(columns: Array, buckets: int) -> Array:
    """Return the values of ``thinned``, bucket by bucket. Shape (channels, 2 * buckets + 2)."""
    edges = np.linspace(0, len(columns), buckets + 1).astype(int)
    values = [columns[0]]
    for begin, end in pairwise(edges):
        piece = columns[begin:end]
        places = np.sort([piece.argmin(axis=0), piece.argmax(axis=0)], axis=0)
        values += [np.take_along_axis(piece, row[None, :], axis=0)[0] for row in places]
    return np.array([*values, columns[-1]]).T


@given(
    rows=st.integers(1, 3000),
    buckets=st.integers(1, 400),
    channels=st.integers(1, 4),
    ended=st.floats(0.0, 2.0),
    levels=st.sampled_from([3, 10**9]),
)
def test_each_bucket_keeps_its_extremes_in_their_order(
    rows: int, buckets: int, channels: int, ended: float, levels: int
) -> None:
    columns = np.random.default_rng(rows).integers(0, levels, (rows, channels)).astype(float)
    columns[int(ended * rows) + 1 :] = np.nan
    time = 0.5 + 0.001 * np.arange(rows)
    instants, values = thinned(time, columns, buckets)
    if rows <= 2 * buckets + 2:
        np.testing.assert_array_equal(instants, time)
        np.testing.assert_array_equal(values, columns.T)
        return
    np.testing.assert_array_equal(values, slowly(columns, buckets))
    assert (instants[0], instants[-1]) == (time[0], time[-1])
    assert (np.diff(instants) >= 0.0).all()


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_a_response_holds_the_columns_that_it_names(mode: str) -> None:
    lane = {"law": "computed_torque"}
    document = {"lanes": {"A": lane}, "simulation": {"mode": mode, "horizon": 0.5}}
    experiment = Experiment.from_document(document)
    response, run = lane_response(experiment, "A"), simulate(experiment).lanes["A"]
    found = dict(zip(response_channels(6), response.columns, strict=True))
    for joint in range(JOINTS):
        for name, column in (("e", run.e), ("tau", run.tau), ("S", run.S)):
            np.testing.assert_array_equal(found[f"{name}{joint + 1}"], column[:, joint])
    distance = np.linalg.norm(run.flange - run.flange_desired, axis=1)
    np.testing.assert_array_equal(found["flange_error"], distance)
    assert response.metrics == run.metrics.document()


def test_a_response_keeps_no_memory_but_its_own_numbers() -> None:
    experiment = Experiment.from_document({"lanes": {"A": {"law": "smc"}}})
    response = lane_response(experiment, "A", estimate=False)
    for array in (response.time, response.columns, response.path):
        owner = array
        while isinstance(owner.base, np.ndarray):
            owner = owner.base
        assert owner.nbytes == array.nbytes
