"""The threshold of silence without a run is the one of the prediction lens."""

from __future__ import annotations

from typing import Any

import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.lenses import look_through
from slidetune.robot.lenses.threshold import threshold_of

LANES = [
    (preset, lane)
    for preset in ("drive-lag", "chattering-tanh", "realistic", "paper")
    for lane in load_preset(preset).lanes
]


@pytest.mark.parametrize(("preset", "lane"), LANES)
def test_it_is_that_of_the_lens(preset: str, lane: str) -> None:
    experiment = load_preset(preset)
    found = threshold_of(experiment, lane)["threshold"]
    view = look_through(experiment, lane, ["prediction"])["prediction"]
    if view is None or view["switching"] == "twisting":
        assert found is None
        return
    assert found["common"] == view["threshold"]
    assert found["joints"] == []
    epsilon = experiment.lanes[lane].epsilon
    each = experiment.patched({"lanes": {lane: {"epsilon": [epsilon] * 5 + [1.1 * epsilon]}}})
    several = threshold_of(each, lane)["threshold"]
    assert several["common"] == view["threshold"]
    assert several["joints"] == [joint["threshold"] for joint in view["joints"]]


@pytest.mark.parametrize(
    "gains", [{"switching": "sign"}, {"switching": "saturation"}, {"switching": "implicit"}]
)
def test_it_is_that_of_tanh_whatever_switches_now(gains: dict[str, Any]) -> None:
    experiment = load_preset("drive-lag")
    wanted = threshold_of(experiment, "tanh")["threshold"]["common"]
    for epsilon in (0.001, 1.0):
        other = experiment.patched({"lanes": {"tanh": {**gains, "epsilon": epsilon}}})
        assert threshold_of(other, "tanh")["threshold"]["common"] == pytest.approx(wanted)


def test_a_gain_that_only_a_run_tells_has_none() -> None:
    adaptive = {"law": "adaptive_smc", "epsilon": 0.05}
    experiment = load_preset("drive-lag").patched({"lanes": {"observer": None, "A": adaptive}})
    assert threshold_of(experiment, "A") == {"threshold": None}


def test_unknown_lanes_are_refused_and_the_known_listed() -> None:
    with pytest.raises(InvalidExperimentError, match="sign"):
        threshold_of(load_preset("drive-lag"), "nobody")
