"""A measured swing is the one that was put in, whatever slow motion lies under it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidetune.robot.lenses.swing import swing_of

Array = np.ndarray
PERIOD = 0.001


def slow(time: Array) -> Array:
    return np.asarray(0.3 * np.sin(time) + 0.05 * np.sin(0.7 * time + 1.0))


@given(st.floats(4.0, 90.0), st.floats(1e-3, 0.1), st.floats(0.0, 6.0))
def test_a_sine_on_a_slow_motion_is_found(frequency: float, height: float, phase: float) -> None:
    time = np.arange(5000) * PERIOD
    S = slow(time) + height * np.sin(2.0 * np.pi * frequency * time + phase)
    found = swing_of(S, PERIOD, 0.1 * height)
    assert found is not None
    assert found.frequency == pytest.approx(frequency, rel=0.02)
    assert found.amplitude == pytest.approx(height, rel=0.05)


def test_a_swing_from_sample_to_sample_is_found() -> None:
    time = np.arange(5000) * PERIOD
    found = swing_of(slow(time) + 0.01 * (-1.0) ** np.arange(5000), PERIOD, 1e-3)
    assert found is not None
    assert found.frequency == pytest.approx(500.0, rel=1e-3)
    assert found.amplitude == pytest.approx(0.01, rel=0.02)


def test_slow_motion_alone_is_silent() -> None:
    time = np.arange(5000) * PERIOD
    assert swing_of(slow(time), PERIOD, 1e-3) is None


def test_a_few_bumps_of_the_motion_are_no_swing() -> None:
    """As friction makes them, which reverses twice in a period of the motion."""
    time = np.arange(5000) * PERIOD
    bumps = np.exp(-8.0 * ((time[:, None] - np.array([0.4, 3.5])) % 6.3)).sum(axis=1)
    assert swing_of(slow(time) + 0.1 * bumps, PERIOD, 1e-3) is None


def test_what_is_spread_over_many_frequencies_is_no_swing() -> None:
    time, random = np.arange(5000) * PERIOD, np.random.default_rng(1)
    tones = 2.0 * np.pi * np.geomspace(3.0, 300.0, 60)
    # As much change in a second at each of them.
    S = np.sin(np.outer(time, tones) + random.uniform(0.0, 6.0, 60)) @ (1.0 / tones)
    assert swing_of(S, PERIOD, 1e-9) is None


@pytest.mark.parametrize("rows", [0, 1, 40])
def test_a_few_rows_tell_nothing(rows: int) -> None:
    assert swing_of((-1.0) ** np.arange(rows), PERIOD, 0.0) is None


def test_a_swing_below_the_least_is_silence() -> None:
    time = np.arange(5000) * PERIOD
    S = 0.01 * np.sin(2.0 * np.pi * 30.0 * time)
    assert swing_of(S, PERIOD, 0.009) is not None
    assert swing_of(S, PERIOD, 0.011) is None
