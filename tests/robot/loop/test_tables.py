"""Every figure that the documentation claims to reproduce."""

from __future__ import annotations

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate

# Per lane: mean error of joints 1 to 3 [rad], greatest error [rad], greatest velocity error after
# 1 s [rad/s]; the unit of the last digit stands beside.
UNDISTURBED = {
    "RBFNN-NFTSM": ((0.0021, 0.0320, 0.0054), 1e-4, (0.049, 1e-3), (0.034, 1e-3)),
    "RBFNN-SMC": ((0.0070, 0.0433, 0.0202), 1e-4, (0.182, 1e-3), (0.155, 1e-3)),
    "NFTSM": ((0.0091, 0.0120, 0.0036), 1e-4, (0.014, 1e-3), (0.0003, 1e-4)),
}
DISTURBED = {
    "RBFNN-NFTSM": ((0.0043, 0.0261, 0.0049), 1e-4, (0.044, 1e-3), (0.034, 1e-3)),
    "RBFNN-SMC": ((0.0060, 0.0413, 0.0195), 1e-4, (0.138, 1e-3), (0.170, 1e-3)),
    "NFTSM": ((0.0340, 0.0499, 0.0302), 1e-4, (0.095, 1e-3), (0.011, 1e-3)),
}
# Greatest and effective flange error in [mm].
QUINTIC = {
    "RBFNN-NFTSM": (30.4, 19.6),
    "RBFNN-SMC": (47.5, 18.5),
    "NFTSM": (114.0, 67.3),
    "nu = 30": (5.9, 2.9),
}
ROBOT = {
    "inertials": "datasheet",
    "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15],
    "viscous_friction": [5.0, 5.0, 4.0, 0.8, 0.8, 0.8],
    "coulomb_friction": [6.0, 6.0, 4.0, 1.0, 1.0, 1.0],
    "torque_limit": [150.0, 150.0, 150.0, 28.0, 28.0, 28.0],
}
LANE = {
    "law": "rbfnn_nftsm",
    "nu": 10.0,
    "c": 1.0,
    "mu": 0.1,
    "k1": [80.0, 80.0, 40.0, 8.0, 8.0, 8.0],
    "k2": [40.0, 40.0, 25.0, 5.0, 5.0, 5.0],
    "epsilon": 0.03,
    "learning_rate": [40.0, 40.0, 20.0, 4.0, 4.0, 4.0],
}


def check(run: Run, lane: str, table: dict) -> None:
    mae, unit, (error, error_unit), (velocity, velocity_unit) = table[lane]
    found = run.lanes[lane]
    np.testing.assert_allclose(found.metrics.mae[:3], mae, rtol=0, atol=2 * unit)
    assert found.metrics.max_error.max() == pytest.approx(error, rel=0, abs=2 * error_unit)
    late = found.metrics_since(1.0).max_velocity_error.max()
    assert late == pytest.approx(velocity, rel=0, abs=2 * velocity_unit)


@pytest.mark.parametrize("lane", UNDISTURBED)
def test_table_without_a_disturbance(undisturbed: Run, lane: str) -> None:
    check(undisturbed, lane, UNDISTURBED)


@pytest.mark.parametrize("lane", DISTURBED)
def test_table_with_the_fitted_torque(disturbed: Run, lane: str) -> None:
    check(disturbed, lane, DISTURBED)


def test_last_three_joints_do_not_mirror_the_first_three(disturbed: Run) -> None:
    mae = disturbed.lanes["RBFNN-NFTSM"].metrics.mae[3:]
    np.testing.assert_allclose(mae, (7e-4, 7e-5, 5e-7), rtol=0.5)


def test_flange_errors_along_the_quintic(disturbed: Run) -> None:
    lanes = {"nu = 30": {"law": "rbfnn_nftsm", "nu": 30.0}}
    patch = {"trajectory": {"kind": "quintic"}, "lanes": lanes}
    run = simulate(disturbed.experiment.patched(patch))
    found = {
        name: (1e3 * lane.metrics.flange_max, 1e3 * lane.metrics.flange_rms)
        for name, lane in run.lanes.items()
    }
    for name, (greatest, effective) in QUINTIC.items():
        digit = 2.0 if greatest > 100.0 else 0.2
        assert found[name][0] == pytest.approx(greatest, rel=0, abs=digit), name
        assert found[name][1] == pytest.approx(effective, rel=0, abs=0.2), name


def test_lighter_arm_takes_the_error_off_joint_two(disturbed: Run) -> None:
    # What is left of the fitted torque is larger than the arm's weight: leave it out.
    patch = {"robot": {"inertials": "datasheet"}, "disturbance": {"constant": 0.0}}
    run = simulate(disturbed.experiment.patched(patch))
    assert run.lanes["RBFNN-NFTSM"].metrics.mae[1] == pytest.approx(0.008, rel=0, abs=0.001)


def chattering(rate: float, lanes: dict[str, dict]) -> Run:
    simulation = {"mode": "sampled", "control_rate": rate, "horizon": 10.0}
    document = {"robot": ROBOT, "lanes": lanes, "simulation": simulation}
    return simulate(Experiment.from_document(document))


def check_chattering(run: Run, lane: str, error: float, variation: float) -> float:
    figures = run.lanes[lane].metrics_since(1.0)
    assert 1e3 * figures.mae.mean() == pytest.approx(error, rel=0.02)
    assert figures.chattering == pytest.approx(variation, rel=0.02)
    assert figures.high_frequency_torque is not None
    return figures.high_frequency_torque


def test_chattering_at_one_kilohertz() -> None:
    switchings = ("sign", "saturation", "tanh")
    run = chattering(1000.0, {name: {**LANE, "switching": name} for name in switchings})
    assert check_chattering(run, "sign", 0.82, 165_667.0) == pytest.approx(57.0, rel=0.03)
    assert check_chattering(run, "saturation", 0.89, 78.0) < 1e-3
    assert check_chattering(run, "tanh", 0.98, 78.0) < 1e-3


def test_smoothing_is_not_free_of_the_sample_rate() -> None:
    lanes = {"sign": {**LANE, "switching": "sign"}, "tanh": LANE, "wide": {**LANE, "epsilon": 0.1}}
    run = chattering(250.0, lanes)
    assert check_chattering(run, "sign", 2.67, 50_308.0) == pytest.approx(62.5, rel=0.04)
    # The limit cycle wanders: its power above 50 Hz depends on the span that is looked at.
    assert check_chattering(run, "tanh", 2.43, 40_205.0) == pytest.approx(49.0, rel=0.15)
    assert check_chattering(run, "wide", 2.44, 78.0) < 1e-3
