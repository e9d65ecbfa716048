"""Lenses tell what sensor noise does from what the loop itself does."""

from __future__ import annotations

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.lenses import look_through

LANE = "sign"


@pytest.fixture(scope="module")
def restless() -> Experiment:
    """A sampled lane that switches by sign(S)."""
    return load_preset("chattering-sign").patched({"simulation": {"horizon": 2.0}})


def noisy(one: Experiment) -> Experiment:
    sensors = {"position": 1e-5, "velocity": 1e-3}
    return one.patched({"disturbance": {"sensor_noise": sensors}})


def test_a_run_without_sensor_noise_stands_beside_a_noisy_one(restless: Experiment) -> None:
    smooth = restless.patched({"lanes": {LANE: {"switching": "tanh"}}})
    seen = look_through(noisy(smooth), LANE)
    alone = look_through(smooth, LANE)
    assert seen["chattering"]["above"] > 0.5
    assert seen["chattering"]["quiet"] == alone["chattering"]
    assert seen["sliding"]["quiet_turns"] == alone["sliding"]["turns"]
    assert seen["sliding"]["turns"] > 10.0 * alone["sliding"]["turns"]
    assert alone["chattering"]["quiet"] is None
    assert alone["sliding"]["quiet_turns"] is None


def test_what_switches_is_left_when_the_noise_is_gone(restless: Experiment) -> None:
    seen = look_through(noisy(restless), LANE, ["chattering"])["chattering"]
    assert seen["quiet"]["above"] == pytest.approx(seen["above"], rel=0.2)
