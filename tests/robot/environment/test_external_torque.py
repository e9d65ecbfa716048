"""What acts on the joints besides the controller."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.external_torque import disturbance_torque, external_torque
from slidetune.robot.environment.layout import LIMIT, TONE_OMEGA, TONE_PHASE, pack_environment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import (
    CURRENT,
    DISTURBANCE,
    F_SLOPE,
    HALF,
    PUSH,
    WORK_ROWS,
    F,
    V,
)

Array = np.ndarray
SIX = [1.0, -2.0, 3.0, 0.0, 0.5, -0.1]


def environment(friction: float | list[float] = 0.0, coulomb: float = 0.0, **changes: Any) -> Array:
    return pack_environment(Disturbance.model_validate(changes), friction, coulomb, None)


def torques(numbers: Array, times: Array) -> Array:
    """Return F at given times, at rest. Shape (n, 6)."""
    work, rows = np.zeros((WORK_ROWS, JOINTS)), []
    for t in times:
        external_torque(float(t), 0.0, CURRENT, numbers, work)
        rows.append(work[F].copy())
    return np.array(rows)


def at_velocity(numbers: Array, v: Array | float, state: int = CURRENT) -> tuple[Array, Array]:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[state + V] = v
    external_torque(0.3, 0.0, state, numbers, work)
    return work[F].copy(), work[F_SLOPE].copy()


def test_nothing_acts_by_default() -> None:
    assert not torques(environment(), np.linspace(0, 9, 50)).any()
    assert np.isinf(environment()[LIMIT]).all()


def test_constant_torque_is_constant() -> None:
    found = torques(environment(constant=SIX), np.array([0.0, 1.0, 77.0]))
    np.testing.assert_array_equal(found, [SIX] * 3)


def test_sine_has_its_amplitude_frequency_and_phase() -> None:
    times = np.linspace(0.0, 2.0, 101)
    found = torques(environment(sine={"amplitude": SIX, "frequency": 1.5, "phase": 0.4}), times)
    expected = np.sin(2.0 * np.pi * 1.5 * times + 0.4)[:, None] * np.array(SIX)
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("t", "on"), [(0.0, 0), (0.99, 0), (1.0, 1), (1.24, 1), (1.26, 0), (2.1, 0), (11.1, 0)]
)
def test_single_pulse_comes_and_goes(t: float, on: int) -> None:
    pulse = {"amplitude": SIX, "start": 1.0, "duration": 0.25}
    found = torques(environment(pulse=pulse), np.array([t]))[0]
    np.testing.assert_array_equal(found, on * np.array(SIX))


@pytest.mark.parametrize(
    ("t", "on"), [(0.5, 0), (0.99, 0), (1.1, 1), (1.3, 0), (3.1, 1), (3.3, 0), (21.2, 1), (22.1, 0)]
)
def test_periodic_pulse_comes_again_but_not_before_its_start(t: float, on: int) -> None:
    pulse = {"amplitude": SIX, "start": 1.0, "duration": 0.25, "period": 2.0}
    found = torques(environment(pulse=pulse), np.array([t]))[0]
    np.testing.assert_array_equal(found, on * np.array(SIX))


def test_sources_add_up() -> None:
    parts: list[dict[str, Any]] = [
        {"constant": SIX},
        {"sine": {"amplitude": 2.0, "frequency": 3.0}},
        {"pulse": {"amplitude": SIX, "start": 0.2, "duration": 0.3}},
        {"noise": {"amplitude": 1.5}},
    ]
    times = np.linspace(0.0, 1.0, 41)
    together: dict[str, Any] = {}
    for part in parts:
        together |= part
    alone = sum(torques(environment(**part), times) for part in parts)
    np.testing.assert_allclose(torques(environment(**together), times), alone, atol=1e-12)


def test_noise_has_its_effective_value_on_every_joint() -> None:
    amplitude = np.array([1.0, 2.0, 0.5, 10.0, 0.0, 3.0])
    times = np.arange(0.0, 200.0, 0.04)
    noise = {"amplitude": amplitude.tolist(), "bandwidth": 8.0}
    found = torques(environment(noise=noise), times)
    np.testing.assert_allclose(np.sqrt((found**2).mean(axis=0)), amplitude, rtol=0.03)
    np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=0.05 * amplitude.max())


@pytest.mark.parametrize("bandwidth", [2.0, 20.0])
def test_noise_fills_its_band_and_nothing_above(bandwidth: float) -> None:
    rate = 5.0 * bandwidth
    times = np.arange(0.0, 4096.0) / rate
    found = torques(environment(noise={"amplitude": 1.0, "bandwidth": bandwidth}), times)
    power = np.abs(np.fft.rfft(found * np.blackman(4096)[:, None], axis=0)) ** 2
    frequency = np.fft.rfftfreq(4096, 1.0 / rate)
    above = power[frequency > 1.05 * bandwidth].sum(axis=0) / power.sum(axis=0)
    assert above.max() < 1e-6
    for part in range(4):
        inside = (frequency >= part * bandwidth / 4) & (frequency < (part + 1) * bandwidth / 4)
        share = power[inside].sum(axis=0) / power.sum(axis=0)
        assert (share > 0.1).all()


def test_joints_are_disturbed_independently() -> None:
    found = torques(environment(noise={"amplitude": 1.0}), np.arange(0.0, 200.0, 0.04))
    correlation = np.corrcoef(found.T) - np.eye(JOINTS)
    assert np.abs(correlation).max() < 0.1


@given(st.integers(0, 2**31 - 1))
def test_same_seed_gives_the_same_bits_and_another_does_not(seed: int) -> None:
    numbers = environment(noise={"amplitude": 1.0}, seed=seed)
    np.testing.assert_array_equal(numbers, environment(noise={"amplitude": 1.0}, seed=seed))
    other = environment(noise={"amplitude": 1.0}, seed=seed ^ 1)
    tones = slice(TONE_OMEGA, TONE_PHASE)
    assert (numbers[tones] != other[tones]).all()


def test_noise_of_one_joint_does_not_depend_on_the_others() -> None:
    times = np.linspace(0.0, 5.0, 60)
    alone = torques(environment(noise={"amplitude": [0, 0, 1, 0, 0, 0]}), times)
    together = torques(environment(noise={"amplitude": [5, 4, 1, 3, 2, 1]}), times)
    np.testing.assert_array_equal(alone[:, 2], together[:, 2])
    assert not alone[:, [0, 1, 3, 4, 5]].any()


def test_viscous_friction_is_proportional_to_the_velocity() -> None:
    friction = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    v = np.array([1.0, -1.0, 0.5, 2.0, -3.0, 0.0])
    torque, slope = at_velocity(environment(friction), v)
    np.testing.assert_allclose(torque, friction * v)
    np.testing.assert_array_equal(slope, friction)


@given(st.floats(-10.0, 10.0))
def test_coulomb_friction_opposes_and_saturates(v: float) -> None:
    torque, slope = at_velocity(environment(coulomb=6.0), v)
    np.testing.assert_allclose(torque, 6.0 * np.tanh(v / 0.02), atol=1e-12)
    assert np.isfinite(slope).all()
    assert (slope >= 0.0).all()


@given(st.floats(-0.1, 0.1))
def test_friction_slope_is_the_derivative(v: float) -> None:
    numbers = environment(2.0, coulomb=6.0)
    ahead, behind = at_velocity(numbers, v + 1e-7)[0], at_velocity(numbers, v - 1e-7)[0]
    np.testing.assert_allclose(at_velocity(numbers, v)[1], (ahead - behind) / 2e-7, rtol=1e-4)


def test_friction_looks_at_the_state_it_is_told() -> None:
    assert at_velocity(environment(1.0), 3.0, state=HALF)[0].tolist() == [3.0] * JOINTS


def test_a_push_helps_the_joints_instead_of_taking_from_them() -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[PUSH] = SIX
    external_torque(0.0, 0.0, CURRENT, environment(constant=1.0), work)
    np.testing.assert_allclose(work[F], 1.0 - np.array(SIX))


def impulse(document: dict[str, Any], edges: Array) -> Array:
    """Return the impulse in [N m s] that the means over the given steps add up to. Shape (6,)."""
    numbers, work, total = environment(**document), np.zeros((WORK_ROWS, JOINTS)), np.zeros(JOINTS)
    for start, end in pairwise(edges):
        disturbance_torque(start, end - start, numbers, work)
        total += (end - start) * work[DISTURBANCE]
    return total


@pytest.mark.parametrize("steps", [1, 2, 7, 100, 3000])
@pytest.mark.parametrize(
    "pulse",
    [
        {"start": 0.3004, "duration": 0.001, "period": 0.0},
        {"start": 0.3004, "duration": 0.001, "period": 0.0017},
        {"start": 0.9, "duration": 5.0, "period": 0.0},
        {"start": 0.1, "duration": 2.0, "period": 0.5},
    ],
)
def test_a_pulse_gives_its_impulse_whatever_the_step(steps: int, pulse: dict[str, float]) -> None:
    document = {"pulse": {"amplitude": 40.0, **pulse}}
    start, duration, period = pulse["start"], pulse["duration"], pulse["period"] or np.inf
    begins = start + np.arange(700) * period if period < np.inf else np.array([start])
    merged = duration >= period
    lasts = np.clip(1.0 - begins, 0.0, min(duration, period) if merged else duration)
    found = impulse(document, np.linspace(0.0, 1.0, steps + 1))
    np.testing.assert_allclose(found, 40.0 * lasts.sum(), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("steps", [1, 3, 10, 200])
def test_a_swing_and_noise_give_their_impulse_whatever_the_step(steps: int) -> None:
    document = {
        "sine": {"amplitude": 5.0, "frequency": 100.0, "phase": 0.4},
        "noise": {"amplitude": 3.0, "bandwidth": 200.0},
        "constant": 1.0,
    }
    fine = impulse(document, np.linspace(0.0, 0.123, 100_001))
    found = impulse(document, np.linspace(0.0, 0.123, steps + 1))
    np.testing.assert_allclose(found, fine, atol=1e-9)


def test_the_mean_over_no_time_is_the_torque_itself() -> None:
    document = {"sine": {"amplitude": 5.0, "frequency": 3.0}, "noise": {"amplitude": 1.0}}
    numbers, work = environment(**document), np.zeros((WORK_ROWS, JOINTS))
    disturbance_torque(0.2, 0.0, numbers, work)
    instant = work[DISTURBANCE].copy()
    disturbance_torque(0.2, 1e-7, numbers, work)
    np.testing.assert_allclose(work[DISTURBANCE], instant, rtol=1e-4)
