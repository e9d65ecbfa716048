"""Describing functions, against the integrals that define them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from slidetune.robot.margins.switching_term import SwitchingTerm, integrator


@pytest.mark.parametrize("switching", ["tanh", "saturation", "sign"])
def test_describing_function_is_its_integral(switching: str) -> None:
    function = {"tanh": np.tanh, "saturation": lambda x: np.clip(x, -1.0, 1.0), "sign": np.sign}
    amplitude, layer = np.array([1e-6, 0.02, 0.3, 5.0]), np.array([0.1, 0.1, 0.2, 0.01])
    found = SwitchingTerm.within(switching, layer).describing_function(amplitude, 1.0, 0.0)
    for A, epsilon, N in zip(amplitude, layer, found, strict=True):

        def passed(angle: float, A: float = A, epsilon: float = epsilon) -> float:
            return float(function[switching](A / epsilon * np.sin(angle)) * np.sin(angle))

        whole, _ = quad(passed, 0.0, np.pi, points=[0.5 * np.pi], epsrel=1e-9, limit=400)
        assert 0.5 * np.pi * A * N == pytest.approx(whole, rel=3e-3)


def test_that_of_super_twisting_is_its_integral_turned_by_the_slower_half() -> None:
    amplitude, omega = np.array([1e-6, 0.02, 3.0]), 40.0
    root, rate = np.array([15.0, 5.0, 2.0]), np.array([110.0, 30.0, 300.0])
    term = SwitchingTerm("twisting", np.ones(3), root, rate)
    found = term.describing_function(amplitude, omega, 0.0)
    for A, k1, k2, N in zip(amplitude, root, rate, found, strict=True):
        at_once, _ = quad(lambda angle: np.sin(angle) ** 1.5, 0.0, np.pi)
        # z of a sign in time with the sine is a triangle, a quarter of a period behind.
        late, _ = quad(lambda angle: (angle - np.pi / 2.0) * np.cos(angle), 0.0, np.pi)
        assert N.real == pytest.approx(k1 * A**0.5 * 2.0 * at_once / (np.pi * A), rel=1e-4)
        assert N.imag == pytest.approx(k2 / omega * 2.0 * late / (np.pi * A), rel=1e-9)


@pytest.mark.parametrize("hold", [0.0, 0.001])
def test_its_amplitude_is_the_one_at_which_it_balances(hold: float) -> None:
    term = SwitchingTerm("twisting", np.ones(1), np.array([15.0]), np.array([110.0]))
    omega = np.array([20.0, 100.0, 800.0])
    size = 1.0 / omega
    found = term.balanced_amplitude(0, size, omega, hold)
    passed = term.describing_function(found, omega, hold)
    np.testing.assert_allclose(np.abs(passed) * size, 1.0, rtol=1e-9)


def test_a_sampled_integral_is_the_sum_of_the_samples_before() -> None:
    omega, hold = 70.0, 0.001
    wave = np.exp(1j * omega * hold * np.arange(90000))
    total = hold * np.concatenate([[0.0], np.cumsum(wave)[:-1]])
    # But for where it began.
    turned = (total - total.mean())[5000] / wave[5000]
    assert integrator(omega, hold) == pytest.approx(turned, rel=1e-3)
    assert integrator(omega, 0.0) == pytest.approx(1.0 / (1j * omega))
