"""Looking back, and branching off."""

from __future__ import annotations

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.workspace import Q
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.recorder import INTERVAL, LENGTH, Recorder

LANES = {"A": {"law": "rbfnn_nftsm"}, "B": {"law": "nftsm"}}
EXPERIMENT = Experiment.from_document({"lanes": LANES, "simulation": {"step": 0.005}})


def recorded(seconds: float) -> tuple[ClosedLoop, Recorder]:
    loop, recorder = ClosedLoop(pack(EXPERIMENT), 64), Recorder()
    while loop.time < seconds:
        recorder.look(loop)
        loop.step()
    return loop, recorder


def test_moments_lie_a_tenth_of_a_second_apart() -> None:
    _, recorder = recorded(2.0)
    assert recorder.span() == pytest.approx((0.0, 2.0 - INTERVAL), abs=0.006)
    moment = recorder.at(1.23)
    assert moment is not None
    assert moment.time == pytest.approx(1.2, abs=0.006)


def test_nothing_recorded_is_said_so() -> None:
    recorder = Recorder()
    assert recorder.span() is None
    assert recorder.at(1.0) is None


def test_a_minute_is_kept_and_no_more() -> None:
    _, recorder = recorded(LENGTH + 3.0)
    span = recorder.span()
    assert span is not None
    assert span[1] - span[0] == pytest.approx(LENGTH - INTERVAL, abs=0.1)


def test_a_restored_moment_repeats_what_followed_to_the_last_bit() -> None:
    loop, recorder = recorded(1.0)
    wanted = {name: lane.work[Q].copy() for name, lane in loop.lanes.items()}
    moment = recorder.at(0.5)
    assert moment is not None
    steps = round((loop.time - moment.time) / loop.period)
    recorder.restore(loop, 0.5)
    assert loop.time == pytest.approx(moment.time)
    for _ in range(steps):
        recorder.look(loop)
        loop.step()
    for name, lane in loop.lanes.items():
        assert np.allclose(lane.work[Q], wanted[name], rtol=0, atol=1e-12)


def test_what_came_after_a_restored_moment_is_forgotten() -> None:
    loop, recorder = recorded(1.0)
    recorder.restore(loop, 0.4)
    span = recorder.span()
    assert span is not None
    assert span[1] < 0.4
