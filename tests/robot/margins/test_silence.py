"""The threshold of silence, against what simulate() does on either side of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.harmonic_balance import limit_cycles
from slidetune.robot.margins.plain_lane import switches
from slidetune.robot.margins.silence import silent_layer
from slidetune.robot.margins.switching_loop import switching_loop
from slidetune.robot.margins.switching_term import SwitchingTerm

Array = np.ndarray

ARM = {"inertials": "datasheet", "armature": [0.6, 0.6, 0.6, 0.15, 0.15, 0.15]}
SURFACE = {"nu": 8.0, "c": 1.0, "mu": 0.0}
REACHING = {"k1": [20, 20, 12, 2, 2, 2], "k2": [40, 40, 25, 5, 5, 5]}
LOOPS: list[tuple[str, dict[str, Any], dict[str, Any], dict[str, Any]]] = [
    ("hold", {}, {}, {"law": "nftsm", **SURFACE, **REACHING}),
    ("hold, slow", {}, {"control_rate": 250.0}, {"law": "smc", **REACHING}),
    ("delay", {}, {"input_delay": 0.002}, {"law": "nftsm", **SURFACE, **REACHING}),
    ("one lag", {"lag": 0.005}, {}, {"law": "smc", **REACHING}),
    (
        "two lags, learning",
        {"lag": 0.004, "lag_order": "second"},
        {},
        {"law": "rbfnn_nftsm", **SURFACE, **REACHING},
    ),
    (
        "two lags, shaped",
        {"lag": 0.01, "lag_order": "second"},
        {"control_rate": 500.0, "input_delay": 0.001},
        {"law": "nftsm", **SURFACE, "k1": 5.0, "k2": 20.0, "inertia_shaped": True},
    ),
    (
        "drives that differ",
        {"lag": [0.004, 0.004, 0.004, 0.002, 0.002, 0.001], "lag_order": "second"},
        {},
        {"law": "nftsm", **SURFACE, **REACHING},
    ),
    (
        "continuous",
        {"lag": 0.005, "lag_order": "second"},
        {"mode": "continuous", "step": 0.0005},
        {"law": "nftsm", **SURFACE, **REACHING},
    ),
]


def experiment(robot: dict[str, Any], simulation: dict[str, Any], lane: Any) -> Experiment:
    document = {
        "robot": {**ARM, **robot},
        "lanes": {"A": lane},
        "trajectory": {"kind": "hold", "position": [0.3, -1.0, 1.2, 0.4, 0.8, 0.2]},
        "simulation": {"mode": "sampled", "horizon": 3.0, "initial_error": 1e-4, **simulation},
    }
    return Experiment.from_document(document)


def swings(one: Experiment, layer: Array) -> bool:
    """Tell whether some S still swings at the end."""
    within = one.patched({"lanes": {"A": {"switching": "tanh", "epsilon": layer.tolist()}}})
    changes = np.diff(simulate(within, estimate=False).lanes["A"].S, axis=0)
    third = len(changes) // 3
    before, last = (np.ptp(part, axis=0) for part in (changes[third : 2 * third], changes[-third:]))
    return bool(np.any(last > 0.5 * before + 1e-12))


def threshold(one: Experiment, layer: Array) -> float:
    """Return the share of some layers at which simulate() falls silent, by bisection."""
    low, high = 0.6, 1.6
    assert swings(one, low * layer)
    assert not swings(one, high * layer)
    while high / low > 1.03:
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if swings(one, middle * layer) else (low, middle)
    return float(np.sqrt(low * high))


@pytest.mark.parametrize(("_", "robot", "simulation", "lane"), LOOPS, ids=[x[0] for x in LOOPS])
def test_one_layer_for_all_joints_is_silent_from_its_threshold_on(
    _: str, robot: dict[str, Any], simulation: dict[str, Any], lane: dict[str, Any]
) -> None:
    one = experiment(robot, simulation, lane)
    found = silent_layer(pack(one), "A", np.ones(JOINTS), 0.0)
    assert found is not None
    assert threshold(one, found) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(("_", "robot", "simulation", "lane"), LOOPS, ids=[x[0] for x in LOOPS])
def test_a_layer_for_each_joint_is_silent_from_its_threshold_on(
    _: str, robot: dict[str, Any], simulation: dict[str, Any], lane: dict[str, Any]
) -> None:
    one = experiment(robot, simulation, lane)
    packed = pack(one)
    cycles = limit_cycles(
        switching_loop(packed, "A", 0.0), SwitchingTerm.within("sign", np.ones(JOINTS))
    )
    crossings = np.array([cycle.crossing for cycle in cycles if cycle is not None])
    layers = np.empty(JOINTS)
    for group in {cycle.locked for cycle in cycles if cycle is not None}:
        found = silent_layer(packed, "A", crossings, 0.0, group)
        assert found is not None
        layers[list(group)] = found[list(group)]
    assert threshold(one, layers) == pytest.approx(1.0, abs=0.1)
    # Harmonic balance alone says nearly as much.
    np.testing.assert_allclose(crossings, layers, rtol=0.15)


def test_a_threshold_is_told_down_to_the_narrowest_layer_there_is() -> None:
    lane = {"law": "integral_smc", "k1": 5.0, "k2": 4.0, "kp": 100.0, "kd": 20.0}
    one = experiment({}, {"control_rate": 10000.0, "plant_substeps": 4, "horizon": 0.5}, lane)
    found = silent_layer(pack(one), "A", np.ones(JOINTS), 0.0)
    assert found is not None
    assert found[0] == pytest.approx(0.5 * 4.0 / 10000.0, rel=0.05)
    assert threshold(one, found) == pytest.approx(1.0, abs=0.1)


def test_a_loop_that_its_proportional_gain_makes_swing_is_never_silent() -> None:
    lane = {"law": "smc", "k1": 600.0, "k2": 5.0}
    one = experiment({"lag": 0.01, "lag_order": "second"}, {}, lane)
    assert silent_layer(pack(one), "A", np.ones(JOINTS), 0.0) is None


def test_laws_without_a_switching_term_have_no_balance() -> None:
    lanes = {
        "linear": {"law": "computed_torque"},
        "power": {"law": "smc", "reaching": "power"},
        "k2 = 0": {"law": "smc", "k2": 0.0},
        "smc": {"law": "smc"},
    }
    packed = pack(Experiment.from_document({"lanes": lanes}))
    assert [switches(packed, name) for name in lanes] == [False, False, False, True]


def test_kappa_is_the_gain_itself_where_the_law_shapes_the_inertia() -> None:
    shaped = {"law": "nftsm", **SURFACE, "k2": 20.0, "inertia_shaped": True}
    loop = switching_loop(pack(experiment({}, {}, shaped)), "A", 0.0)
    np.testing.assert_allclose(loop.kappa, 20.0, rtol=1e-9)


def test_kappa_is_what_the_switching_torque_alone_does_to_each_joint() -> None:
    lane = {"law": "nftsm", "nu": 8.0, "c": 2.0, "mu": 0.0, **REACHING}
    packed = pack(experiment({"viscous_friction": 0.0}, {}, lane))
    loop = switching_loop(packed, "A", 0.0)
    # Far above everything else of the loop S is the integral of -kappa sw.
    omega = np.array([2e5])
    free = np.abs(omega * loop.response(omega)[0].diagonal())
    np.testing.assert_allclose(free, loop.kappa, rtol=1e-3)
