"""Figures that grow with every tick, against those of the same rows at once."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import find_peaks

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.metrics import DEADBAND, Metrics, measure_lane
from slidetune.server.live.running_metrics import RECENT, SPAN, RunningMetrics
from slidetune.server.live.telemetry import Channel, channels

Array = np.ndarray

PERIOD = 0.01
LANES = ["A", "B"]
TURNS = 2.0 / 3.9
"""Reversals a second by which spans of 4 s and more may differ: two of them."""


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
    return measure_lane(PERIOD * np.arange(len(rows)), data, np.ones(JOINTS), 50.0)


def assert_same(found: dict[str, object] | None, wanted: Metrics) -> None:
    assert found is not None
    for name, value in found.items():
        # Whether a span begins on the way up or down is known to who saw the rows before.
        begins = TURNS if name == "switches" else 0.0
        known = getattr(wanted, name)
        np.testing.assert_allclose(value, known, rtol=1e-9, atol=begins, err_msg=name)


@pytest.mark.parametrize("chunk", [1, 3, 100])
def test_figures_are_those_of_the_same_rows_at_once(chunk: int) -> None:
    columns = channels(LANES, 6)
    rows = rows_of(13.0, columns)
    running = RunningMetrics(columns, "B")
    for begin in range(0, len(rows), chunk):
        running.add(rows[begin : begin + chunk], PERIOD * (begin + 0.5), PERIOD)
    found = running.document()
    assert_same(found["total"], at_once(rows, columns, "B"))
    if 100 % chunk == 0:
        assert_same(found["recent"], at_once(rows[-round(RECENT / PERIOD) :], columns, "B"))


def turns(torque: Array) -> Array:
    """Return how often each joint's torque comes back from an extreme. Shape (6,)."""
    both = [
        [find_peaks(side * one, prominence=DEADBAND)[0] for side in (1, -1)] for one in torque.T
    ]
    return np.array([len(peaks) + len(valleys) for peaks, valleys in both])


def by_time(rows: Array, periods: Array, columns: list[Channel], lane: str) -> dict[str, object]:
    """Return the figures of rows, each of which stands for its own period in [s]."""

    def group(name: str, owner: str = lane) -> Array:
        return rows[:, [i for i, c in enumerate(columns) if (c.group, c.lane) == (name, owner)]]

    error, torque = np.abs(group("e")), group("tau")
    distance = np.linalg.norm(group("flange") - group("flange_d", ""), axis=1)
    return {
        "mae": np.average(error, axis=0, weights=periods),
        "max_error": error.max(axis=0),
        "max_velocity_error": np.abs(group("de")).max(axis=0),
        "chattering": np.abs(np.diff(torque, axis=0)).sum() / periods[:-1].sum(),
        "switches": turns(torque) / periods[:-1].sum(),
        "peak_torque": np.abs(torque).max(axis=0),
        "rms_torque": np.sqrt(np.average(torque**2, axis=0, weights=periods)),
        "flange_rms": np.sqrt(np.average(distance**2, weights=periods)),
        "flange_max": distance.max(),
    }


@pytest.mark.parametrize("seed", range(8))
def test_rows_count_by_the_time_that_they_stand_for(seed: int) -> None:
    random, columns = np.random.default_rng(seed), channels(LANES, 6)
    running = RunningMetrics(columns, "B")
    rows, periods, time = np.empty((0, len(columns))), np.empty(0), 0.0
    for _ in range(25):
        # Some seconds of one period, with errors of one size, in pieces as the session makes them.
        period = float(np.exp(random.uniform(np.log(0.0005), np.log(0.02))))
        scale = random.uniform(0.1, 10.0)
        for _ in range(round(random.uniform(0.2, 2.0) / (16 * period)) + 1):
            added = scale * random.normal(size=(random.integers(1, 17), len(columns)))
            running.add(added, time, period)
            time += len(added) * period
            rows = np.vstack([rows, added])
            periods = np.append(periods, np.full(len(added), period))
    begins = np.cumsum(periods) - periods
    assert time > RECENT + 1.0
    since = SPAN * np.floor((time - RECENT) / SPAN)
    last = begins >= since
    assert RECENT - periods.max() < periods[last].sum() <= RECENT + SPAN
    found = running.document()
    for span, which in (("total", begins >= 0.0), ("recent", last)):
        wanted = by_time(rows[which], periods[which], columns, "B")
        assert set(found[span]) == set(wanted)
        for name, value in wanted.items():
            begins = TURNS if name == "switches" else 0.0
            shown = found[span][name]
            np.testing.assert_allclose(shown, value, rtol=1e-9, atol=begins, err_msg=name)


def test_one_row_has_no_way_of_the_torque() -> None:
    columns = channels(LANES, 6)
    running = RunningMetrics(columns, "A")
    running.add(rows_of(PERIOD, columns), 0.0, PERIOD)
    total = running.document()["total"]
    assert total["chattering"] == 0.0
    assert total["switches"] == [0.0] * JOINTS


def test_a_total_that_counts_anew_leaves_the_last_ten_seconds_alone() -> None:
    columns = channels(LANES, 6)
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
