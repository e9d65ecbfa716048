"""Where along a motion a loop is looked at: no pose of it is far from all of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.instants import POSES, instants, way_times
from slidetune.robot.margins.margin import loop_margin, worst_margin
from slidetune.robot.motion.along import desired_motion

STRAIGHT, BENT = [0.0, 0.0], [0.0, 1.57]
LANE = {"law": "smc", "lambda_": 5.0, "k2": 0.0}
MOTIONS: dict[str, dict[str, Any]] = {
    "a short move in a long horizon": {"kind": "quintic", "start": [0.0, -1.57], "end": BENT},
    "a sine whose period is the spacing": {
        "kind": "sine",
        "amplitude": [0.0, 1.57],
        "angular_frequency": 2.0 * np.pi * 1.1,
    },
}


def packed(motion: dict[str, Any], horizon: float, k1: float = 0.1) -> Packed:
    document = {
        "robot": {"model": "two_links"},
        "trajectory": motion,
        "lanes": {"SMC": {**LANE, "k1": k1}},
        "simulation": {"mode": "sampled", "control_rate": 1000.0, "horizon": horizon},
    }
    return pack(Experiment.from_document(document))


def dense(case: Packed, times: int = 20_001) -> np.ndarray:
    horizon = case.experiment.simulation.horizon
    grid = np.linspace(0.0, horizon, times)
    return desired_motion(case.trajectory, grid, case.joints)[0]


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("horizon", [5.0, 10.0, 60.0])
def test_gamma_is_that_of_the_worst_pose_of_the_whole_motion(name: str, horizon: float) -> None:
    case = packed(MOTIONS[name], horizon)
    data = case.model.createData()
    inertias = [pin.crba(case.model, data, q) for q in dense(case, 4001)]
    whole = [np.triu(M) + np.triu(M, 1).T for M in inertias]
    worst = max(
        float(np.abs(np.linalg.eigvals(1e-3 * 0.1 * np.linalg.inv(M))).max()) for M in whole
    )
    assert worst_margin(case, "SMC") == pytest.approx(worst, rel=1e-3)


def test_a_loop_that_is_unstable_in_the_middle_of_a_short_move_is_told_so() -> None:
    motion = MOTIONS["a short move in a long horizon"]
    weak = loop_margin(packed(motion, 60.0), "SMC")
    assert weak.holds
    assert weak.gamma is not None
    assert weak.limit is not None
    # By so much that the ends of the move alone would still be stable.
    strong = packed(motion, 60.0, 0.1 * 1.2 * weak.limit / weak.gamma)
    margin = loop_margin(strong, "SMC")
    assert not margin.holds
    assert simulate(strong.experiment).lanes["SMC"].freeze is not None


@pytest.mark.parametrize("seed", range(12))
def test_no_pose_of_a_drawn_motion_is_far_from_all_that_are_looked_at(seed: int) -> None:
    dice = np.random.default_rng(seed)
    one = dice.integers(2)
    motion = (
        {
            "kind": "sine",
            "amplitude": dice.uniform(0.0, 1.5, 2).tolist(),
            "angular_frequency": float(dice.uniform(0.2, 15.0)),
            "phase": float(dice.uniform(-3.0, 3.0)),
        }
        if one
        else {
            "kind": "quintic",
            "start": dice.uniform(-2.0, 2.0, 2).tolist(),
            "end": dice.uniform(-2.0, 2.0, 2).tolist(),
            "duration": float(dice.uniform(0.3, 5.0)),
        }
    )
    case = packed(motion, float(dice.uniform(5.0, 60.0)))
    poses = dense(case)
    seen = desired_motion(case.trajectory, instants(case), 2)[0]
    way = float(np.ptp(poses, axis=0).max())
    apart = np.abs(poses[:, None] - seen).max(axis=2).min(axis=1).max()
    assert apart <= 1.2 * way / (POSES - 1) + 1e-6
    assert instants(case)[0] == way_times(case)[0] == 0.0


def test_what_stands_still_is_looked_at_once() -> None:
    assert instants(packed({"kind": "hold", "position": BENT}, 10.0)).tolist() == [0.0]
    still = {"kind": "sine", "amplitude": 0.0}
    assert instants(packed(still, 10.0)).tolist() == [0.0]
