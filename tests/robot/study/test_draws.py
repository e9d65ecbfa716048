"""Draws stay in their ranges, are the same for every trial, and leave the nominal model alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.arm.arm import nominal_arm
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.study.draws import (
    QUANTITIES,
    check_ranges,
    drawn,
    placed,
    unit_draw,
    values_at,
)

RANGES: dict[str, list[float]] = {
    "payload": [0.5, 3.0],
    "inertia": [0.8, 1.3],
    "viscous_friction": [0.5, 2.0],
    "coulomb_friction": [0.0, 1.5],
    "disturbance": [0.2, 2.0],
    "sensor_noise": [0.0, 3.0],
    "input_delay": [0.0, 0.002],
    "lag": [0.0, 0.004],
}


def uncertain(ranges: dict[str, Any] = RANGES) -> Experiment:
    torques = {
        "constant": [5.0, -5.0, 3.0, 1.0, 1.0, 1.0],
        "sine": {"amplitude": 2.0},
        "noise": {"amplitude": 0.5},
    }
    return load_preset("realistic").patched({"disturbance": torques, "uncertainty": ranges})


def test_every_quantity_is_drawn_from_its_range_and_from_nothing_else() -> None:
    experiment = uncertain()
    assert set(RANGES) == set(QUANTITIES)
    values = [values_at(experiment.uncertainty, unit_draw(1, index)) for index in range(400)]
    for name, (low, high) in RANGES.items():
        found = np.array([one[name] for one in values])
        assert low <= found.min() < low + 0.05 * (high - low)
        assert high - 0.05 * (high - low) < found.max() <= high
        assert found.mean() == pytest.approx(0.5 * (low + high), abs=0.1 * (high - low))


def test_what_is_drawn_stands_in_the_experiment() -> None:
    experiment, index = uncertain(), 7
    values = values_at(experiment.uncertainty, unit_draw(1, index))
    other = drawn(experiment, index)
    before, after = experiment.robot, other.robot
    assert after.payload.mass == values["payload"]
    assert after.inertia_scale == pytest.approx(before.inertia_scale * values["inertia"])
    assert after.lag == values["lag"]
    assert other.simulation.input_delay == values["input_delay"]
    for name in ("viscous_friction", "coulomb_friction"):
        scaled = np.multiply(getattr(before, name), values[name])
        np.testing.assert_allclose(getattr(after, name), scaled)
    torques, drawn_torques = experiment.disturbance, other.disturbance
    factor = values["disturbance"]
    np.testing.assert_allclose(drawn_torques.constant, np.multiply(torques.constant, factor))
    assert drawn_torques.sine.amplitude == pytest.approx(2.0 * factor)
    assert drawn_torques.noise.amplitude == pytest.approx(0.5 * factor)
    noise = drawn_torques.sensor_noise
    assert noise.velocity == pytest.approx(torques.sensor_noise.velocity * values["sensor_noise"])
    assert other.lanes == experiment.lanes


def test_a_draw_is_the_same_whatever_else_is_uncertain_and_whatever_is_tuned() -> None:
    alone = uncertain({"payload": RANGES["payload"]})
    for index in range(5):
        mass = drawn(uncertain(), index).robot.payload.mass
        assert drawn(alone, index).robot.payload.mass == mass
        tuned = alone.patched({"lanes": {"NFTSM": {"nu": 3.0}}})
        assert drawn(tuned, index).robot.payload.mass == mass
    assert drawn(alone.patched({"uncertainty": {"seed": 2}}), 0) != drawn(alone, 0)


@pytest.mark.parametrize("factor", [0.8, 1.25])
def test_the_nominal_model_stays_what_it_is(factor: float) -> None:
    experiment = uncertain({"inertia": [factor, factor]})
    before, after = experiment, placed(experiment, np.full(len(QUANTITIES), 0.5))
    models = [nominal_arm(one.robot, one.disturbance.nominal_mismatch) for one in (before, after)]
    masses = [
        np.array([one.mass for one in arm.model.inertias]) for arm in models if arm is not None
    ]
    np.testing.assert_allclose(masses[0], masses[1], rtol=1e-12)
    true = [np.array([one.mass for one in pack(e).model.inertias]) for e in (before, after)]
    payload = before.robot.payload.mass
    assert true[1][1:-1].sum() / true[0][1:-1].sum() == pytest.approx(factor)
    assert true[1][-1] - payload == pytest.approx(factor * (true[0][-1] - payload))


@pytest.mark.parametrize(
    ("ranges", "path", "words"),
    [
        ({"inertia": [0.5, 5.0]}, "robot.inertia_scale", "[0.1, 3]"),
        ({"coulomb_friction": [0.0, 10.0]}, "robot.coulomb_friction", "[0, 50] N·m"),
        ({"sensor_noise": [0.0, 10.0]}, "disturbance.sensor_noise.velocity", "[0, 0.5] rad/s"),
    ],
)
def test_a_range_that_leads_out_of_bounds_is_refused_and_never_cut(
    ranges: dict[str, Any], path: str, words: str
) -> None:
    noisy = {"sensor_noise": {"velocity": 0.1}}
    experiment = uncertain(ranges).patched({"disturbance": noisy})
    with pytest.raises(InvalidExperimentError) as caught:
        check_ranges(experiment)
    (field,) = caught.value.fields
    assert field.path == path
    assert words in field.message
    check_ranges(uncertain())


def test_without_ranges_a_draw_is_the_experiment() -> None:
    experiment = load_preset("paper")
    assert drawn(experiment, 3) is experiment
