"""What a law or its observer integrates is in its loop: the border by trial, and as told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.laws.terms.switching import HELD
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.margin import period_map
from slidetune.robot.margins.period_map import MARGINAL

ROUGHLY = 2.0
"""A margin takes the slope of a swing of HELD, not what a swing of few samples feels: of 120 drawn
loops 117 lie within 1.2, the worst at 1.78."""
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
        {"kp": 400.0, "kd": 20.0, **OBSERVED},
        {"law": "adaptive_smc", "lambda_": 20.0, "k2_min": 0.0, **OBSERVED},
        {"law": "adaptive_smc", "lambda_": 5.0, "k2_min": 0.0, **OBSERVED, "observer_rate": 60.0},
    ],
)
def test_border_is_where_the_loop_begins_to_swing(lane: dict[str, Any]) -> None:
    low, high = 0.1, 1000.0
    for _ in range(11):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if grows(loop(middle, lane)) else (middle, high)
    told = [period_map(pack(loop(share * low, lane)), "A", 0.0).stable() for share in (0.97, 1.03)]
    assert told == [True, False]


def twisting(dice: np.random.Generator) -> dict[str, Any]:
    """Return a super-twisting loop on an arm that nothing else moves."""
    k1 = float(np.exp(dice.uniform(np.log(2), np.log(60))))
    lane = {
        "law": "super_twisting",
        "lambda_": float(dice.uniform(2, 20)),
        "k1": k1,
        "k2": k1 * k1 * float(np.exp(dice.uniform(np.log(0.05), np.log(2)))),
        "z_max": 10000.0,
        "observer": str(dice.choice(["none", "momentum", "time_delay"])),
        "observer_rate": float(np.exp(dice.uniform(np.log(5), np.log(500)))),
    }
    return {
        "robot": {"inertials": "datasheet", "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15]},
        "lanes": {"A": lane},
        "trajectory": {"kind": "hold"},
        "simulation": {
            "mode": "sampled",
            "control_rate": float(dice.choice([250.0, 1000.0])),
            "input_delay": float(dice.choice([0.0, 0.001, 0.002, 0.004])),
            "horizon": 4.0,
            "initial_error": 1e-5,
            "initial_velocity": "desired",
        },
    }


@pytest.mark.parametrize("seed", range(4))
def test_super_twisting_is_told_to_hold_where_it_swings_by_less_than_counts_as_held(
    seed: int,
) -> None:
    dice, told = np.random.default_rng(seed), set()
    for _ in range(10):
        experiment = Experiment.from_document(twisting(dice))
        radius = period_map(pack(experiment), "A", 0.0).radius()
        run = simulate(experiment, estimate=False).lanes["A"]
        swing = np.inf if run.freeze else np.abs(run.S[-len(run.S) // 4 :]).max()
        if radius <= 1.0 + MARGINAL:
            assert swing < ROUGHLY * HELD
        else:
            assert swing > HELD / ROUGHLY
        told.add(radius > 1.0 + MARGINAL)
    assert told == {True, False}
