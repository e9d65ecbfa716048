"""How long a kick pushes: as long as asked, however many steps are made at once."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from math import ceil

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.workspace import R_V
from slidetune.server.live.session import Session

TORQUE = (5.0, 0.0, 0.0, 0.0, 0.0, 0.0)
STEPS = 200
BEGIN = 7
"""Steps before the kick."""


def damped(rate: float) -> Experiment:
    """An arm that the controller leaves alone, so that its speed tells of the kick."""
    return Experiment.from_document(
        {
            "lanes": {"A": {"law": "computed_torque", "kp": 0.0, "kd": 0.1}},
            "robot": {"armature": 5.0},
            "trajectory": {"kind": "hold"},
            "simulation": {"mode": "sampled", "control_rate": rate, "plant_substeps": 1},
        }
    )


@contextmanager
def paused(experiment: Experiment) -> Iterator[Session]:
    session = Session(pack(experiment))
    session.playing = False
    session.start()
    try:
        yield session
    finally:
        session.stop()


def settle(session: Session) -> None:
    done = threading.Event()
    session.ask(done.set)
    assert done.wait(300.0)


def kicked(rate: float, duration: float, batches: list[int]) -> np.ndarray:
    """Return the velocity of joint 1 in every step. Shape (n,)."""
    with paused(damped(rate)) as session:
        session.step(BEGIN)
        settle(session)
        session.kick(TORQUE, duration)
        for count in batches:
            session.step(count)
        settle(session)
        velocity: np.ndarray = session.loop.lanes["A"].record[: session.loop.number, R_V, 0].copy()
        return velocity


@pytest.mark.parametrize("duration", [0.005, 0.1, 0.137])
@pytest.mark.parametrize("rate", [50.0, 100.0, 730.0, 1000.0])
def test_a_kick_lasts_as_long_as_asked_in_whole_steps(rate: float, duration: float) -> None:
    at_once = kicked(rate, duration, [STEPS])
    speeding = np.flatnonzero(np.diff(at_once) > 1e-9)
    assert speeding[0] == BEGIN
    assert len(speeding) == ceil(duration * rate - 1e-6)
    np.testing.assert_array_equal(kicked(rate, duration, [1] * STEPS), at_once)


def test_a_branch_from_within_a_kick_repeats_it() -> None:
    experiment = damped(1000.0)
    with paused(experiment) as session:
        session.step(200)
        session.kick(TORQUE, 0.137)
        session.step(300)
        settle(session)
        first = session.loop.lanes["A"].record[:500].copy()
        both = experiment.patched({"lanes": {"Copy": experiment.lanes["A"].model_dump()}})
        session.fork(pack(both), 2, 0.3, {"Copy": "A"})
        session.pause()
        session.step(200)
        settle(session)
        again = slice(300, min(500, session.loop.number))
        assert again.stop - again.start >= 190
        for lane in session.loop.lanes.values():
            np.testing.assert_array_equal(lane.record[again], first[again])
