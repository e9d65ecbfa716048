"""Since when the live figures of a lane count, on the session's real thread."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.workspace import R_Q, R_QD
from slidetune.server.live.session import Session

LANES = {"A": {"law": "rbfnn_nftsm"}, "B": {"law": "nftsm"}}
FIRST = 60
"""Steps before a change."""
THEN = 45
"""Steps after it."""


class Tuning:
    """A paused session, its experiment, and every row that it has written."""

    def __init__(self) -> None:
        self.experiment = Experiment.from_document({"lanes": LANES})
        self.session = Session(pack(self.experiment))
        self.session.playing = False
        self.session.start()

    def settle(self) -> None:
        done = threading.Event()
        self.session.ask(done.set)
        assert done.wait(30.0)

    def step(self, count: int) -> None:
        self.session.step(count)
        self.settle()

    def change(self, patch: dict[str, Any], origins: dict[str, str] | None = None) -> None:
        self.experiment = self.experiment.patched(patch)
        self.session.adopt(pack(self.experiment), self.session.revision + 1, origins)
        self.settle()

    def since(self, lane: str) -> tuple[int, str]:
        """Return the number of the first step that counts, and why it is the first."""
        since = self.session.figures.document()[lane]["since"]
        return round(since["time"] / self.session.loop.period), since["reason"]

    def mean_error(self, lane: str) -> Any:
        total = self.session.figures.document()[lane]["total"]
        return total and total["mae"]

    def recorded(self, lane: str, first: int) -> Any:
        """Return the mean error of the recorded rows from that step on, by hand."""
        record = self.session.loop.lanes[lane].record[first : self.session.loop.number]
        return np.abs(record[:, R_QD] - record[:, R_Q]).mean(axis=0)


@pytest.fixture
def tuning() -> Iterator[Tuning]:
    tuning = Tuning()
    yield tuning
    tuning.session.stop()


def test_the_figures_count_since_the_last_change_of_the_lanes_own_loop(tuning: Tuning) -> None:
    tuning.step(FIRST)
    tuning.change({"lanes": {"A": {"nu": 30.0}}})
    assert tuning.mean_error("A") is None
    tuning.step(THEN)
    assert tuning.since("A") == (FIRST, "change")
    assert tuning.since("B") == (0, "reset")
    np.testing.assert_allclose(tuning.mean_error("A"), tuning.recorded("A", FIRST))
    np.testing.assert_allclose(tuning.mean_error("B"), tuning.recorded("B", 0))


@pytest.mark.parametrize(
    "patch",
    [
        {"robot": {"payload": {"mass": 3.0}}},
        {"trajectory": {"amplitude": 0.5}},
        {"disturbance": {"constant": 4.0}},
        {"simulation": {"step": 0.002}},
    ],
    ids=["robot", "trajectory", "disturbance", "simulation"],
)
def test_a_change_of_what_all_share_lets_every_lane_count_anew(
    tuning: Tuning, patch: dict[str, Any]
) -> None:
    tuning.step(10)
    time = tuning.session.loop.time
    tuning.change(patch)
    for figures in tuning.session.figures.document().values():
        assert figures["since"] == {"time": time, "reason": "change"}


def test_names_words_and_the_horizon_change_no_figure(tuning: Tuning) -> None:
    tuning.step(FIRST)
    before = tuning.session.figures.document()
    gains = tuning.experiment.lanes["A"].model_dump()
    tuning.change({"title": "Other words", "simulation": {"horizon": 5.0, "high_frequency": 20.0}})
    tuning.change({"lanes": {"A": None, "C": gains}})
    assert tuning.session.figures.document() == {"B": before["B"], "C": before["A"]}
    tuning.step(THEN)
    assert tuning.since("C") == (0, "reset")
    np.testing.assert_allclose(tuning.mean_error("C"), tuning.recorded("C", 0))


def test_a_copy_counts_from_now_and_its_origin_goes_on(tuning: Tuning) -> None:
    tuning.step(FIRST)
    tuning.change({"lanes": {"C": tuning.experiment.lanes["A"].model_dump()}}, {"C": "A"})
    tuning.step(THEN)
    assert tuning.since("A") == (0, "reset")
    assert tuning.since("C") == (FIRST, "added")
    np.testing.assert_allclose(tuning.mean_error("C"), tuning.recorded("C", FIRST))
    np.testing.assert_allclose(tuning.mean_error("A"), tuning.recorded("A", 0))


def test_a_branch_lets_every_lane_count_from_where_it_begins(tuning: Tuning) -> None:
    tuning.step(350)
    gains = tuning.experiment.lanes["A"].model_dump()
    branched = pack(tuning.experiment.patched({"lanes": {"C": {**gains, "nu": 3.0}}}))
    tuning.session.fork(branched, 2, 0.2, {"C": "A"})
    tuning.session.pause()
    tuning.settle()
    for figures in tuning.session.figures.document().values():
        assert figures["since"] == {"time": pytest.approx(0.2), "reason": "branch"}


def test_a_lane_that_stands_still_keeps_its_figures_until_a_reset(tuning: Tuning) -> None:
    tuning.change({"lanes": {"A": {"k1": 400.0}}, "simulation": {"mode": "sampled"}})
    tuning.session.reset()
    tuning.step(500)
    frozen = tuning.session.figures.document()["A"]
    assert tuning.session.loop.lanes["A"].freeze is not None
    tuning.change({"lanes": {"A": {"k1": 5.0}}})
    tuning.step(THEN)
    assert tuning.session.figures.document()["A"] == frozen
    tuning.session.reset()
    tuning.settle()
    assert tuning.since("A") == (0, "reset")


def test_longer_steps_right_after_a_stop_change_none_of_its_figures(tuning: Tuning) -> None:
    tuning.change({"simulation": {"mode": "sampled", "control_rate": 2000.0}})
    while tuning.session.loop.lanes["A"].freeze is None:
        tuning.step(1)
    before = tuning.session.figures.document()["A"]["total"]
    tuning.change({"simulation": {"control_rate": 50.0}})
    tuning.step(1)
    assert tuning.session.figures.document()["A"]["total"] == before


def test_one_lane_is_reset_where_the_trajectory_is_and_the_others_go_on(tuning: Tuning) -> None:
    patch = {
        "lanes": {"A": {"k1": 400.0}},
        "simulation": {"mode": "sampled", "initial_error": 0.01},
    }
    tuning.change(patch)
    tuning.session.reset()
    tuning.step(500)
    loop = tuning.session.loop
    assert loop.lanes["A"].freeze is not None
    other = loop.lanes["B"].work.copy()
    tuning.session.reset_lane("A")
    tuning.settle()
    np.testing.assert_array_equal(loop.lanes["B"].work, other)
    assert loop.time == pytest.approx(0.5)
    state = tuning.session.state()["lanes"]
    assert (state["A"]["status"], state["A"]["began"]) == ("running", loop.time)
    assert state["B"]["began"] == 0.0
    assert tuning.since("A") == (500, "reset")
    tuning.step(1)
    # It begins with the error that the simulation asks for, at the desired velocity, unlearnt.
    row = loop.lanes["A"].record[500]
    np.testing.assert_allclose(row[6] - row[0], 0.01)
    np.testing.assert_allclose(row[1], row[7])
    assert not row[4].any()
    np.testing.assert_allclose(tuning.mean_error("A"), tuning.recorded("A", 500))
    tuning.session.reset_lane("gone")
    tuning.settle()
    assert tuning.session.playing is False
