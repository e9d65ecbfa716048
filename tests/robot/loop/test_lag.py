"""A loop behind drives with a lag, against a solution that shares no code with it."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.cutting import cutting_of
from slidetune.robot.kernels.workspace import BETWEEN, DELIVERED, RECORD, TAU
from slidetune.robot.loop.accuracy import damped_growth, difference
from slidetune.robot.loop.lane import Lane
from slidetune.robot.loop.simulate import LaneRun, simulate
from slidetune.robot.margins.unsampled import fastest_growth
from tests.reference.draw import by_hand, in_its_world
from tests.reference.sampled import solve_sampled
from tests.reference.solve import GaveUpError, solve

Array = np.ndarray
Document = dict[str, Any]
TRUE = 5e-5
"""Greatest error of an angle in [rad]."""
LAWS: Document = {
    "rbfnn_nftsm": {"nu": 2.0, "c": 1.0, "k1": 40.0, "k2": 20.0, "epsilon": 0.5},
    "rbfnn_smc": {"k1": 40.0, "k2": 20.0, "epsilon": 0.5},
    "nftsm": {"nu": 2.0, "c": 1.0, "k1": 5.0, "k2": 5.0, "epsilon": 0.5},
    "shaped": {"law": "nftsm", "inertia_shaped": True, "nu": 2.0, "c": 1.0, "k1": 5.0, "k2": 5.0},
    "smc": {"k1": 5.0, "k2": 5.0, "epsilon": 0.5},
    "computed_torque": {"kp": 100.0, "kd": 20.0},
}
DRIVES: Document = {
    "torque loop": {"lag": 0.004},
    "two": {"lag": 0.004, "lag_order": "second"},
    "six": {"lag": [0.001, 0.002, 0.003, 0.004, 0.005, 0.0005], "lag_order": "second"},
}


def experiment_of(law: str, drive: Document, **simulation: Any) -> Experiment:
    return Experiment.from_document(
        {
            "robot": {"armature": 0.3, "viscous_friction": 2.0, **drive},
            "lanes": {"A": {"law": law, **LAWS[law]}},
            "simulation": {"horizon": 1.0, "initial_error": 0.02, **simulation},
        }
    )


def only_lane(experiment: Experiment) -> LaneRun:
    (lane,) = simulate(experiment).lanes.values()
    return lane


# Drives know of no law, and no law of them: each law behind one, each drive behind two laws.
@pytest.mark.parametrize(("law", "drive"), [*zip(LAWS, [*DRIVES, *DRIVES], strict=True)])
def test_the_continuous_loop_is_that_of_the_reference(law: str, drive: str) -> None:
    experiment = experiment_of(law, DRIVES[drive], step=0.0005)
    run = only_lane(experiment)
    truth = solve(experiment.document(), run.time[::50], 1e-9)
    assert run.freeze is None
    assert difference(run.q[::50], truth.q) < TRUE


# Every pair of two of them: law and drive, law and delay, drive and delay.
@pytest.mark.parametrize(
    ("law", "drive", "delay"),
    [
        (law, drive, (0.0, 0.0013)[(row + column) % 2])
        for row, law in enumerate(["nftsm", "shaped", "smc", "computed_torque"])
        for column, drive in enumerate(DRIVES)
    ],
)
def test_the_sampled_loop_is_that_of_the_reference(law: str, drive: str, delay: float) -> None:
    # The arm's own steps are of first order: so fine that only the drives are left.
    sampled = {"mode": "sampled", "plant_substeps": 40, "input_delay": delay, "horizon": 0.4}
    experiment = experiment_of(law, DRIVES[drive], **sampled)
    run = only_lane(experiment)
    truth = solve_sampled(experiment.document())
    assert run.freeze is None
    assert difference(run.q, truth) < TRUE


# Draws that the reference gets through in a few seconds; every lag is among them.
@pytest.mark.parametrize("seed", [0, 9, 10, 11, 13, 17, 24, 25, 33, 38, 41, 50, 54, 75])
def test_the_estimate_holds_behind_a_lag(seed: int) -> None:
    dice = random.Random(seed)
    document = (by_hand if seed % 2 else in_its_world)(seed)
    lags = [0.0005, 0.002, 0.004, 0.01, 0.05, [dice.uniform(0.0005, 0.02) for _ in range(6)]]
    document["robot"] |= {"lag": dice.choice(lags), "lag_order": dice.choice(["first", "second"])}
    document["simulation"]["horizon"] = 0.3
    experiment = Experiment.from_document(document)
    run = only_lane(experiment)
    try:
        truth = solve(document, run.time[::20], 1e-8, most=12_000)
    except GaveUpError as stiff:
        pytest.skip(f"the reference gave up {stiff}")
    rows = min(len(truth.q), len(run.q[::20]))
    error = difference(run.q[::20][:rows], truth.q[:rows])
    assert run.accuracy.error_estimate is not None
    assert error <= max(1e-6, 3.0 * run.accuracy.error_estimate)
    if run.freeze is not None:
        assert run.freeze.time == pytest.approx(truth.end, abs=0.004)


MODES = [300 + 0j, 3 + 20j, 300 + 3000j, 2000 + 9000j, 10 + 4000j, -5 + 9j, 0.1 + 3000j]


@pytest.mark.parametrize("scheme", ["plain", "extrapolated"])
@pytest.mark.parametrize("mode", MODES)
def test_growth_that_a_step_hides_is_told(scheme: str, mode: complex) -> None:
    simulation = experiment_of("smc", {}, scheme=scheme, horizon=10.0).simulation
    swing = np.array([[mode.real, -mode.imag], [mode.imag, mode.real]])
    start = np.array([1.0, 0.0])

    def implicit(y: Array, h: float) -> Array:
        return np.linalg.solve(np.eye(2) - h * swing, y)

    h = simulation.step
    after = implicit(start, h)
    if scheme == "extrapolated":
        after = 2.0 * implicit(implicit(start, 0.5 * h), 0.5 * h) - after
    grows = np.log(np.linalg.norm(after)) / h
    hidden = 10.0 * mode.real > 3.0 and grows < 0.5 * mode.real
    assert damped_growth(simulation, mode) == (mode.real if hidden else 0.0)


def test_the_fastest_growth_is_that_of_the_differential_equation() -> None:
    # A damper behind two lags on every joint's own inertia: s (τ s + 1)² + k = 0.
    lag = 0.004
    robot = {"lag": lag, "lag_order": "second", "inertials": "datasheet"}
    lane = {"law": "nftsm", "inertia_shaped": True, "nu": 0.01, "c": 1.0, "mu": 0.0, "k2": 0.0}
    for gain in (600.0, 900.0):
        document = {
            "robot": robot,
            "lanes": {"A": {**lane, "k1": gain}},
            "trajectory": {"kind": "hold"},
        }
        found = fastest_growth(pack(Experiment.from_document(document)), "A")
        roots = np.roots([lag**2, 2.0 * lag, 1.0, gain])
        expected = roots[np.argmax(roots.real)]
        assert found.real == pytest.approx(expected.real, abs=0.1)
        assert abs(found.imag) == pytest.approx(abs(expected.imag), rel=1e-3)


@pytest.mark.parametrize("mode", ["continuous", "sampled"])
def test_a_lag_that_comes_later_begins_at_the_torque_of_the_joint(mode: str) -> None:
    before = experiment_of("smc", {}, mode=mode)
    lane = Lane("A", pack(before), np.zeros((10, len(RECORD), JOINTS)), cutting_of())
    for number in range(5):
        assert lane.step(number * 1e-3, number, number) == 0
    given = lane.work[TAU].copy()
    lane.adopt(pack(before.patched({"robot": DRIVES["two"]})))
    for row in (DELIVERED, BETWEEN):
        np.testing.assert_array_equal(lane.work[row], given)
    assert lane.step(5e-3, 5, 5) == 0
    assert np.abs(lane.work[DELIVERED] - given).max() < 0.2 * np.abs(given).max()
    lane.adopt(pack(before))
    assert not lane.work[DELIVERED : BETWEEN + 1].any()
