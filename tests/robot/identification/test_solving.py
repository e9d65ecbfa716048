"""Intervals hold what they promise, whether residuals depend on each other or not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from slidetune.robot.identification.solving import _critical, half_widths


@pytest.mark.parametrize(("rho", "least"), [(0.0, 0.93), (0.5, 0.91), (0.8, 0.88), (0.9, 0.84)])
def test_a_mean_and_a_slope_lie_within_their_intervals(rho: float, least: float) -> None:
    rows, inside = 300, []
    time = np.linspace(-1.0, 1.0, rows)
    slopes = np.stack([np.ones(rows), time], axis=1)[:, None, :]
    inverse = np.linalg.inv(slopes[:, 0].T @ slopes[:, 0])
    for seed in range(300):
        random = np.random.default_rng(seed)
        noise = lfilter([1.0], [1.0, -rho], random.standard_normal(rows + 100))[100:]
        found = inverse @ slopes[:, 0].T @ noise
        residual = noise - slopes[:, 0] @ found
        inside.append(np.abs(found) <= half_widths(slopes, residual[:, None]))
    assert np.mean(inside) >= least
    assert np.mean(inside) <= 0.99


def test_the_critical_values_are_those_of_the_limit_distribution() -> None:
    # Of Kiefer and Vogelsang 2005, of a mean of white noise: its t by a sum over b of all rows.
    assert _critical(0.0) == pytest.approx(1.96)
    share, rows, far = 0.2, 250, []
    width = int(share * rows)
    weights = 1.0 - np.abs(np.arange(-rows + 1, rows)) / width
    weights = np.clip(weights, 0.0, None)
    for seed in range(4000):
        noise = np.random.default_rng(seed).standard_normal(rows)
        left = noise - noise.mean()
        long = float((np.correlate(left, left, "full") * weights).sum()) / rows
        far.append(abs(noise.mean()) * np.sqrt(rows / long))
    assert np.quantile(far, 0.95) == pytest.approx(_critical(share), rel=0.06)


def test_what_two_joints_share_is_one_piece_of_news() -> None:
    random = np.random.default_rng(1)
    shared = random.standard_normal(400)
    slopes = np.ones((400, 2, 1))
    twice = half_widths(slopes, np.stack([shared, shared], axis=1))
    once = half_widths(slopes[:, :1], shared[:, None])
    np.testing.assert_allclose(twice, once, rtol=0.08)
