"""Figures of a lane, against signals whose figures are known."""

from __future__ import annotations

import json
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, signal

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.lessons.claim import Claim, measured
from slidetune.robot.loop.metrics import (
    DEADBAND,
    Metrics,
    high_frequency_torque,
    measure_lane,
    reaching_times,
    torque_spectrum,
    total_variation,
)
from slidetune.robot.loop.simulate import simulate

Array = np.ndarray


def tone(frequency: float, amplitude: float, rate: float, seconds: float = 4.0) -> Array:
    """Return a torque that swings in joint 1 alone. Shape (n, 6)."""
    torque = np.zeros((round(rate * seconds), JOINTS))
    torque[:, 0] = amplitude * np.cos(2.0 * np.pi * frequency * np.arange(len(torque)) / rate + 0.3)
    return torque


def columns(n: int) -> dict[str, Array]:
    random = np.random.default_rng(3)
    shapes = {name: (n, JOINTS) for name in ("e", "de", "tau", "S")}
    shapes |= {"flange": (n, 3), "flange_desired": (n, 3)}
    return {name: random.normal(size=shape) for name, shape in shapes.items()}


def test_total_variation_is_the_way_that_the_torque_goes_in_a_second() -> None:
    up_and_down = np.zeros((5, JOINTS))
    up_and_down[:, 0], up_and_down[:, 3] = (0, 1, 0, 1, 0), (0, 0, -2, 0, 0)
    assert total_variation(up_and_down, 0.5) == pytest.approx((4.0 + 4.0) / 2.0)


def test_total_variation_of_a_tone_does_not_depend_on_the_sampling() -> None:
    for rate in (2000.0, 8000.0):
        found = total_variation(tone(10.0, 3.0, rate), 1.0 / rate)
        assert found == pytest.approx(4 * 3.0 * 10.0, rel=0.01)


@pytest.mark.parametrize("rate", [250.0, 1000.0, 4000.0])
@pytest.mark.parametrize("frequency", [60.0, 80.0, 110.0])
def test_tone_above_fifty_hertz_counts_with_its_effective_value(
    rate: float, frequency: float
) -> None:
    found = high_frequency_torque(tone(frequency, 3.0, rate), 1.0 / rate, 50.0)
    assert found == pytest.approx(3.0 / np.sqrt(2.0), rel=0.02)


@pytest.mark.parametrize("frequency", [0.0, 0.2, 5.0, 35.0])
def test_tone_below_fifty_hertz_does_not_count(frequency: float) -> None:
    found = high_frequency_torque(tone(frequency, 1000.0, 1000.0) + 500.0, 1e-3, 50.0)
    assert found == pytest.approx(0.0, abs=0.01)


@given(
    rate=st.floats(101.0, 4000.0),
    rows=st.integers(26, 6000),
    seed=st.integers(0, 1000),
    slope=st.floats(-100.0, 100.0),
)
def test_the_spectrum_is_that_of_scipy(rate: float, rows: int, seed: int, slope: float) -> None:
    torque = np.random.default_rng(seed).normal(size=(rows, JOINTS))
    torque += slope * np.arange(rows)[:, None]
    found = torque_spectrum(torque, 1.0 / rate, 50.0)
    if rows / rate < 0.25:
        assert found is None
        return
    assert found is not None
    expected = signal.welch(
        torque,
        1.0 / (1.0 / rate),
        window="blackmanharris",
        nperseg=min(rows, max(256, int(1.0 / (1.0 / rate)))),
        axis=0,
        detrend="linear",
    )
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-12)
    # Of a steep line its rounding is left over.
    scale = expected[1].max() + (slope * rows) ** 2
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-9, atol=1e-12 * scale)


def test_spectra_of_many_lengths_leave_no_memory_behind() -> None:
    torque = np.ones((3000, JOINTS))
    lengths = range(750, 3000, 30)
    tracemalloc.start()
    try:
        for rows in lengths:
            torque_spectrum(torque[:rows], 1.0 / 3000.0, 50.0)
        left, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    windows = 8 * sum(lengths)
    assert left < 0.5 * windows


def test_joints_add_up_as_squares() -> None:
    torque = tone(100.0, 3.0, 1000.0)
    torque[:, 5] = 4.0 / 3.0 * np.roll(torque[:, 0], 3)
    found = high_frequency_torque(torque, 1e-3, 50.0)
    assert found == pytest.approx(5.0 / np.sqrt(2.0), rel=0.02)


@pytest.mark.parametrize(("rate", "rows"), [(100.0, 1000), (80.0, 1000), (1000.0, 100)])
def test_chattering_is_unknown_where_it_can_not_be_told(rate: float, rows: int) -> None:
    assert high_frequency_torque(np.ones((rows, JOINTS)), 1.0 / rate, 50.0) is None


@given(
    bound=st.floats(10.0, 200.0),
    apart=st.floats(6.0, 60.0),
    amplitude=st.floats(0.01, 50.0),
    rate=st.sampled_from([1000.0, 2000.0]),
)
def test_a_tone_counts_above_the_bound_that_the_user_sets_and_not_below(
    bound: float, apart: float, amplitude: float, rate: float
) -> None:
    above = high_frequency_torque(tone(bound + apart, amplitude, rate), 1.0 / rate, bound)
    assert above == pytest.approx(amplitude / np.sqrt(2.0), rel=0.01)
    below = tone(max(0.0, bound - apart), amplitude, rate)
    assert high_frequency_torque(below, 1.0 / rate, bound) == pytest.approx(
        0.0, abs=1e-3 * amplitude
    )


@given(
    rate=st.floats(50.0, 10000.0),
    rows=st.integers(2, 4000),
    bound=st.floats(10.0, 5000.0),
    seed=st.integers(0, 1000),
)
def test_energy_above_the_bound_is_the_integral_of_scipys_density_or_unknown(
    rate: float, rows: int, bound: float, seed: int
) -> None:
    torque, period = np.random.default_rng(seed).normal(size=(rows, JOINTS)), 1.0 / rate
    found = high_frequency_torque(torque, period, bound)
    if 1.0 / period <= 2.0 * bound or rows * period < max(0.25, 12.5 / bound):
        assert found is None
        return
    pieces = {"nperseg": min(rows, max(256, int(1.0 / period))), "window": "blackmanharris"}
    axis, density = signal.welch(torque, 1.0 / period, axis=0, detrend="linear", **pieces)
    above = axis >= bound
    expected = np.sqrt(density[above].sum() * axis[1])
    assert found == pytest.approx(expected, rel=1e-9)


def torque_figures(torque: Array, period: float = 1e-3) -> Metrics:
    """Return the figures of a lane with that torque. Shape (n, 6)."""
    data = {**columns(len(torque)), "tau": torque}
    return measure_lane(np.arange(len(torque)) * period, data, np.ones(JOINTS), 50.0)


@given(
    rows=st.integers(1, 400),
    seed=st.integers(0, 10**6),
    scale=st.sampled_from([0.3, 1.0, 3.0, 100.0]),
    walks=st.booleans(),
)
def test_switches_are_the_peaks_and_valleys_more_prominent_than_the_deadband(
    rows: int, seed: int, scale: float, walks: bool
) -> None:
    torque = scale * DEADBAND * np.random.default_rng(seed).normal(size=(rows, JOINTS))
    torque = np.cumsum(torque, axis=0) if walks else torque
    expected = [
        sum(len(signal.find_peaks(side * one, prominence=DEADBAND)[0]) for side in (1.0, -1.0))
        for one in torque.T
    ]
    found = torque_figures(torque).switches
    np.testing.assert_allclose(found * max(rows - 1, 1) * 1e-3, expected, atol=1e-9)


@pytest.mark.parametrize("rate", [1000.0, 4000.0, 10000.0])
@pytest.mark.parametrize("frequency", [1.0, 12.5, 125.0])
def test_a_square_wave_and_a_sine_switch_twice_a_period(frequency: float, rate: float) -> None:
    sine = np.tile(tone(frequency, 3.0, rate)[:, :1], JOINTS)
    seconds = len(sine) / rate
    for wave in (sine, np.sign(sine)):
        found = torque_figures(wave, 1.0 / rate).switches
        # The span begins and ends within a half period.
        np.testing.assert_allclose(found, 2.0 * frequency, atol=1.5 / seconds)


def test_what_stays_within_the_deadband_switches_never() -> None:
    small = 0.49 * DEADBAND * np.random.default_rng(0).uniform(-1.0, 1.0, size=(1000, JOINTS))
    assert not torque_figures(20.0 + small).switches.any()
    assert not torque_figures(np.full((1000, JOINTS), 20.0)).switches.any()
    rising = np.cumsum(np.full((1000, JOINTS), 0.1), axis=0) + small
    assert not torque_figures(rising).switches.any()


@given(rows=st.integers(1, 300), seed=st.integers(0, 1000), period=st.floats(5e-5, 0.02))
def test_itae_and_rms_torque_are_their_integrals(rows: int, seed: int, period: float) -> None:
    random, time = np.random.default_rng(seed), period * np.arange(rows)
    start = random.uniform(0.0, 5.0)
    data = {name: random.normal(size=values.shape) for name, values in columns(rows).items()}
    found = measure_lane(start + time, data, np.ones(JOINTS), 50.0)
    expected = integrate.trapezoid(time[:, None] * np.abs(data["e"]), time, axis=0)
    np.testing.assert_allclose(found.itae, expected, rtol=1e-9, atol=1e-15)
    effort = np.square(data["tau"]).sum(axis=0) * period
    np.testing.assert_allclose(found.rms_torque**2 * rows * period, effort, rtol=1e-9)


def test_rms_torque_is_exact_where_it_is_held_and_half_a_step_more_where_it_is_not() -> None:
    period, rows, fine = 0.01, 400, 50
    data = columns(rows)
    found = measure_lane(period * np.arange(rows), data, np.ones(JOINTS), 50.0).rms_torque
    held = np.repeat(data["tau"], fine, axis=0)
    effort = np.square(held).sum(axis=0) * period / fine
    np.testing.assert_allclose(found**2 * rows * period, effort, rtol=1e-12)
    # A spike that is over within some steps, integrated in closed form.
    for steps in (4.5, 20.0):
        time = period * np.arange(rows)
        data["tau"] = 30.0 * np.exp(-0.5 * time / (steps * period))[:, None] * np.ones(JOINTS)
        found = measure_lane(time, data, np.ones(JOINTS), 50.0).rms_torque
        ratio = found**2 * rows / (30.0**2 * steps)
        np.testing.assert_allclose(ratio, 1.0 + 0.5 / steps, atol=0.1 / steps**2)


@pytest.mark.parametrize("rate", [0.5, 2.0, 20.0])
def test_itae_of_a_decaying_error_is_its_closed_form(rate: float) -> None:
    time, horizon = np.arange(5001) * 1e-3, 5.0
    data = columns(len(time))
    data["e"] = -0.2 * np.exp(-rate * time)[:, None] * np.ones(JOINTS)
    found = measure_lane(time, data, np.ones(JOINTS), 50.0).itae
    past = rate * horizon
    np.testing.assert_allclose(
        found, 0.2 * (1.0 - np.exp(-past) * (1.0 + past)) / rate**2, rtol=1e-4
    )


def test_reaching_time_is_the_first_within_the_layer() -> None:
    time, sliding = np.arange(5) * 0.1, np.full((5, JOINTS), 9.0)
    sliding[2:, 0], sliding[1, 1], sliding[0, 2], sliding[4, 3] = -0.5, 1.0, 0.0, 1.01
    found = reaching_times(time, sliding, np.ones(JOINTS))
    assert found == (pytest.approx(0.2), pytest.approx(0.1), 0.0, None, None, None)


def test_s_that_jumps_across_a_thin_layer_has_reached_it() -> None:
    time, sliding = np.arange(5) * 0.1, np.full((5, JOINTS), 9.0)
    sliding[2:, 0] = -9.0
    sliding[3, 1] = -0.01
    layer = np.full(JOINTS, 1e-3)
    assert reaching_times(time, sliding, layer)[:3] == (
        pytest.approx(0.2),
        pytest.approx(0.3),
        None,
    )


def test_nothing_is_reached_where_no_law_tries() -> None:
    sliding = np.zeros((5, JOINTS))
    sliding[:, 1] = 1.0, 0.0, -1.0, 0.0, 1.0
    assert reaching_times(np.arange(5) * 0.1, sliding, np.zeros(JOINTS)) == (None,) * JOINTS


def test_a_span_without_a_row_has_no_figures_rather_than_zeros() -> None:
    found = measure_lane(np.empty(0), columns(0), np.ones(JOINTS), 50.0, 0.3)
    document = found.document()
    assert document.pop("diverged_at") == 0.3
    numbers = [one for value in document.values() for one in np.atleast_1d(value)]
    assert len(numbers) == 8 * JOINTS + 4
    assert set(numbers) == {None}


def test_a_lane_that_ended_before_a_span_has_no_figures_there() -> None:
    falling = {"law": "rbfnn_smc", "k1": 0, "k2": 0, "learning_rate": 0}
    experiment = Experiment.from_document(
        {
            "lanes": {"A": falling},
            "disturbance": {"constant": -50.0},
            "simulation": {"horizon": 0.2},
        }
    )
    lane = simulate(experiment, estimate=False).lanes["A"]
    assert lane.freeze is not None
    assert (lane.metrics_since(lane.freeze.time - 1e-9).max_error > 0.0).all()
    after = lane.metrics_since(lane.freeze.time + 1e-9)
    assert np.isnan([*after.mae, after.chattering, after.flange_rms]).all()
    assert after.diverged_at == lane.freeze.time
    claim = Claim(name="x", metric="reaching_time", lane="A", since=0.19, at_least=0.0)
    assert not claim.holds(measured(claim, simulate(experiment, estimate=False)))


def test_figures_are_means_and_maxima_over_the_rows() -> None:
    time, data = np.arange(400) * 1e-3, columns(400)
    found = measure_lane(time, data, np.full(JOINTS, 0.01), 50.0, 0.3)
    np.testing.assert_allclose(found.mae, np.abs(data["e"]).mean(axis=0))
    np.testing.assert_allclose(found.max_error, np.abs(data["e"]).max(axis=0))
    np.testing.assert_allclose(found.max_velocity_error, np.abs(data["de"]).max(axis=0))
    np.testing.assert_allclose(found.peak_torque, np.abs(data["tau"]).max(axis=0))
    distance = np.linalg.norm(data["flange"] - data["flange_desired"], axis=1)
    assert found.flange_max == pytest.approx(distance.max())
    assert found.flange_rms == pytest.approx(np.sqrt((distance**2).mean()))
    assert found.chattering == pytest.approx(total_variation(data["tau"], 1e-3))
    assert found.diverged_at == 0.3


@pytest.mark.parametrize("rows", [1, 2, 300])
def test_figures_are_plain_json_however_short_the_span(rows: int) -> None:
    found = measure_lane(np.arange(rows) * 1e-3, columns(rows), np.ones(JOINTS), 50.0)
    document = json.loads(json.dumps(found.document(), allow_nan=False))
    assert len(document["mae"]) == len(document["reaching_time"]) == JOINTS
    assert document["diverged_at"] is None
