"""From which gain on an adaptive law oscillates: what is said, against what its loop does."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.advice.adapted_gain import adapted_gain
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate

LANE: dict[str, Any] = {
    "law": "adaptive_smc",
    "lambda_": 10.0,
    "k1": 20.0,
    "k2": 100.0,
    "epsilon": 0.02,
}


def loop(lane: dict[str, Any], **simulation: Any) -> Experiment:
    base = load_preset("drive-lag")
    calm = {
        "robot": {"coulomb_friction": 0.0, "payload": {"mass": 0.0}},
        "trajectory": {"kind": "hold"},
        "disturbance": {
            "nominal_mismatch": 1.0,
            "sensor_noise": {"position": 0.0, "velocity": 0.0},
        },
        "simulation": {"horizon": 3.0, "initial_error": 1e-4, **simulation},
    }
    return base.patched({**calm, "lanes": {**dict.fromkeys(base.lanes), "A": {**LANE, **lane}}})


@pytest.mark.parametrize("switching", ["tanh", "saturation"])
def test_the_gain_runs_off_above_the_border_and_not_below(switching: str) -> None:
    (said,) = adapted_gain(pack(loop({"switching": switching})), "A")
    assert said.patch is not None
    border = said.patch["lanes"]["A"]["k2"]
    assert 1.0 < border < 100.0
    for share, grows in ((0.85, False), (1.2, True)):
        lane = {"switching": switching, "k2_min": share * border, "adaptation_rate": 1e-6}
        S = simulate(loop(lane), estimate=False).lanes["A"].S
        assert bool(np.abs(S[-500:]).max() > 0.5 * LANE["epsilon"]) is grows


@pytest.mark.parametrize(
    "lane",
    [
        {"k2": 5.0},  # never so far
        {"k2_min": 100.0},  # from the beginning
        {"adaptation_rate": 0.0},
        {"switching": "sign"},  # chatters anyway
        {"reaching": "power"},
        {"law": "smc", "k1": 80.0, "k2": 40.0},
    ],
)
def test_where_it_can_not_run_off_nothing_is_said(lane: dict[str, Any]) -> None:
    assert list(adapted_gain(pack(loop(lane)), "A")) == []


def test_a_bound_per_joint_is_proposed_per_joint() -> None:
    most = [100.0, 90.0, 80.0, 70.0, 60.0, 50.0]
    (said,) = adapted_gain(pack(loop({"k2": most})), "A")
    assert said.patch is not None
    bounds = said.patch["lanes"]["A"]["k2"]
    assert len(bounds) == 6
    assert np.all(np.array(bounds) < most)


def test_continuous_mode_oscillates_by_its_drives_alone() -> None:
    free = loop({}, mode="continuous")
    assert list(adapted_gain(pack(free.patched({"robot": {"lag": 0.0}})), "A")) == []
    second = free.patched({"robot": {"lag_order": "second"}})
    assert len(list(adapted_gain(pack(second), "A"))) == 1
