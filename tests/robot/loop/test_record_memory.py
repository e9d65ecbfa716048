"""Records of whole runs: memory that is used again, and never while somebody looks at it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import RECORD
from slidetune.robot.loop import record_memory
from slidetune.robot.loop.record_memory import KEPT, LARGEST, record_of
from slidetune.robot.loop.simulate import simulate


@pytest.fixture(autouse=True)
def nothing_spare(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    spare: list[Any] = []
    monkeypatch.setattr(record_memory, "_spare", spare)
    return spare


def test_memory_that_nobody_looks_at_is_used_again() -> None:
    first = record_of(100, 6)
    place = first.ctypes.data
    del first
    assert record_of(60, 6).ctypes.data == place


def test_a_view_of_a_record_keeps_its_memory() -> None:
    first = record_of(100, 6)
    first[:] = 7.0
    column = first[:, 3:9].T[2]
    del first
    second = record_of(100, 6)
    second[:] = 0.0
    assert (column == 7.0).all()


def test_a_record_has_the_shape_that_was_asked_for() -> None:
    for rows in (5, 100, 3, 100, 200):
        record = record_of(rows, 6)
        assert record.shape == (rows, len(RECORD), JOINTS)
        assert record.flags.c_contiguous
        record[:] = 1.0


def test_no_more_is_kept_than_so_many_blocks_of_so_much(nothing_spare: list[Any]) -> None:
    many = [record_of(10, 6) for _ in range(KEPT + 3)]
    del many
    assert len(nothing_spare) == KEPT
    nothing_spare.clear()
    large = record_of(LARGEST // (8 * 48) + 1, 6)
    del large
    assert nothing_spare == []


def test_a_run_in_used_memory_is_the_same_run() -> None:
    lane = {"law": "rbfnn_nftsm", "k1": 400.0}
    document = {"lanes": {"A": lane}, "simulation": {"mode": "sampled", "horizon": 0.5}}
    experiment = Experiment.from_document(document)
    first = simulate(experiment)
    assert first.lanes["A"].freeze is not None
    kept = {name: getattr(first.lanes["A"], name).copy() for name in ("q", "tau", "S", "weights")}
    del first
    used = [record_of(len(kept["q"]), 6) for _ in range(KEPT)]
    for record in used:
        record[:] = 3.0
    del used, record
    again = simulate(experiment).lanes["A"]
    for name, column in kept.items():
        np.testing.assert_array_equal(getattr(again, name), column)
