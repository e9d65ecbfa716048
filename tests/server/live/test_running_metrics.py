"""Figures that grow with every tick, against those of the same rows at once."""

from __future__ import annotations

import numpy as np
import pytest

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.metrics import Metrics, measure_lane
from slidetune.server.live.running_metrics import RECENT, RunningMetrics
from slidetune.server.live.telemetry import Channel, channels

Array = np.ndarray

PERIOD = 0.01
LANES = ["A", "B"]


def rows_of(seconds: float, columns: list[Channel]) -> Array:
    """Return telemetry of all columns. Shape (n, columns)."""
    random = np.random.default_rng(5)
    return random.normal(size=(round(seconds / PERIOD), len(columns)))


def at_once(rows: Array, columns: list[Channel], lane: str) -> Metrics:
    """Return the figures of all rows together."""

    def group(name: str, owner: str = lane) -> Array:
        return rows[:, [i for i, c in enumerate(columns) if (c.group, c.lane) == (name, owner)]]

    data = {name: group(name) for name in ("e", "de", "tau", "S", "flange")}
    data["flange_desired"] = group("flange_d", "")
    return measure_lane(PERIOD * np.arange(len(rows)), data, np.ones(JOINTS))


def assert_same(found: dict[str, object] | None, wanted: Metrics) -> None:
    assert found is not None
    for name, value in found.items():
        np.testing.assert_allclose(value, getattr(wanted, name), rtol=1e-9, err_msg=name)


@pytest.mark.parametrize("chunk", [1, 3, 100])
def test_figures_are_those_of_the_same_rows_at_once(chunk: int) -> None:
    columns = channels(LANES)
    rows = rows_of(13.0, columns)
    running = RunningMetrics(columns, "B")
    for begin in range(0, len(rows), chunk):
        running.add(rows[begin : begin + chunk], PERIOD * (begin + 0.5), PERIOD)
    found = running.document()
    assert_same(found["total"], at_once(rows, columns, "B"))
    if 100 % chunk == 0:
        # The last of the thirteen seconds and the nine before it.
        assert_same(found["recent"], at_once(rows[-round(RECENT / PERIOD) :], columns, "B"))


def test_one_row_has_no_way_of_the_torque() -> None:
    columns = channels(LANES)
    running = RunningMetrics(columns, "A")
    running.add(rows_of(PERIOD, columns), 0.0, PERIOD)
    assert running.document()["total"]["chattering"] == 0.0


def test_a_total_that_counts_anew_leaves_the_last_ten_seconds_alone() -> None:
    columns = channels(LANES)
    rows = rows_of(6.0, columns)
    running = RunningMetrics(columns, "A")
    for begin in range(0, len(rows), 50):
        if begin == 200:
            running.restart_total(2.0, "change")
        running.add(rows[begin : begin + 50], PERIOD * begin, PERIOD)
    found = running.document()
    assert found["since"] == {"time": 2.0, "reason": "change"}
    assert_same(found["total"], at_once(rows[200:], columns, "A"))
    assert_same(found["recent"], at_once(rows, columns, "A"))
