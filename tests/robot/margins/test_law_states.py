"""What a law integrates is part of its loop: the border of stability by trial, and as told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.margin import period_map

OBSERVED: dict[str, Any] = {"observer": "momentum", "observer_rate": 20.0}


def loop(k1: float, lane: dict[str, Any]) -> Experiment:
    base = load_preset("drive-lag")
    calm = {
        "robot": {
            "coulomb_friction": 0.0,
            "viscous_friction": 0.0,
            "payload": {"mass": 0.0},
            "torque_limit": None,
        },
        "trajectory": {"kind": "hold"},
        "disturbance": {
            "nominal_mismatch": 1.0,
            "sensor_noise": {"position": 0.0, "velocity": 0.0},
        },
        "simulation": {"horizon": 4.0, "initial_error": 1e-5, "input_delay": 0.002},
    }
    gains = {"law": "integral_smc", "k2": 0.0, "k1": k1, **lane}
    return base.patched({**calm, "lanes": {**dict.fromkeys(base.lanes), "A": gains}})


def grows(experiment: Experiment) -> bool:
    run = simulate(experiment, estimate=False).lanes["A"]
    if run.freeze is not None:
        return True
    size, quarter = np.abs(run.e), len(run.e) // 4
    return bool(size[-quarter:].max() > size[quarter : 2 * quarter].max())


@pytest.mark.parametrize(
    "lane",
    [
        {"kp": 2000.0, "kd": 20.0},
        {"kp": 5000.0, "kd": 60.0},
        {"kp": 2000.0, "kd": 60.0, **OBSERVED},
    ],
)
def test_border_of_integral_smc_is_where_its_loop_begins_to_swing(lane: dict[str, Any]) -> None:
    low, high = 0.1, 1000.0
    for _ in range(11):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if grows(loop(middle, lane)) else (middle, high)
    told = [period_map(pack(loop(share * low, lane)), "A", 0.0).stable() for share in (0.97, 1.03)]
    assert told == [True, False]
