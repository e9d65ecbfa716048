"""The radial-basis-function layer."""

from __future__ import annotations

import numpy as np
import pytest

from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import (
    CURRENT,
    HALF,
    HIDDEN,
    LEAKAGE,
    LEARNING,
    MEASURED_Q,
    NETWORK,
    NETWORK_SLOPE,
    NODES,
    QD,
    WORK_ROWS,
    W,
)
from slidetune.robot.laws.terms.network import NetworkGains, network, no_network

Array = np.ndarray
PUBLISHED_CENTERS = (-1, -0.7778, -0.5556, -0.3333, -0.1111, 0.1111, 0.3333, 0.5556, 0.7778, 1)


def evaluated(gains: NetworkGains, base: int = CURRENT, seed: int = 1) -> Array:
    work = np.zeros((WORK_ROWS, JOINTS))
    random = np.random.default_rng(seed)
    work[QD], work[MEASURED_Q] = random.normal(size=(2, JOINTS))
    for rows in (CURRENT, HALF):
        work[rows + W : rows + W + NODES] = random.normal(size=(NODES, JOINTS))
    network(gains.pack_network(), base, work)
    return work


def test_centres_are_the_published_ones_with_the_sixth_corrected() -> None:
    np.testing.assert_allclose(NetworkGains().centers(), PUBLISHED_CENTERS, atol=5e-5)


@pytest.mark.parametrize("source", ["error", "angle", "desired"])
@pytest.mark.parametrize("base", [CURRENT, HALF])
def test_output_is_equation_19(source: str, base: int) -> None:
    gains = NetworkGains(
        width=[0.1, 0.3, 1, 3, 10, 100],
        center_span=1.7,
        network_input=source,
        learning_rate=[1, 2, 3, 4, 5, 6],
        leakage=[6, 5, 4, 3, 2, 1],
    )
    work = evaluated(gains, base)
    x = {"error": work[QD] - work[MEASURED_Q], "angle": work[MEASURED_Q], "desired": work[QD]}[
        source
    ]
    distance = x - gains.centers()[:, None]
    hidden = np.exp(-(distance**2) / (2 * np.square(gains.width)))
    weights = work[base + W : base + W + NODES]
    np.testing.assert_allclose(work[HIDDEN : HIDDEN + NODES], hidden, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(work[NETWORK], (weights * hidden).sum(axis=0), rtol=1e-9)
    slope = np.array(gains.learning_rate) * (hidden**2).sum(axis=0)
    np.testing.assert_allclose(work[NETWORK_SLOPE], slope, rtol=1e-9)
    np.testing.assert_array_equal(work[LEARNING], gains.learning_rate)
    np.testing.assert_array_equal(work[LEAKAGE], gains.leakage)


def test_published_width_makes_an_integrator_of_the_network() -> None:
    hidden = evaluated(NetworkGains())[HIDDEN : HIDDEN + NODES]
    assert hidden.min() > 0.9


def test_narrow_gaussians_are_blind_between_their_centres() -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[QD] = 1.0 / 9.0 + 1.0 / 9.0
    network(NetworkGains(width=0.02).pack_network(), CURRENT, work)
    assert work[HIDDEN : HIDDEN + NODES].max() < 1e-6


@pytest.mark.parametrize("width", [0.02, 0.08, 0.12, 0.19, 0.21, 0.5, 2.0, 10.0, 100.0])
def test_outputs_are_exact_however_narrow_the_gaussians(width: float) -> None:
    gains = NetworkGains(width=width, center_span=2.0, network_input="desired")
    work = np.zeros((WORK_ROWS, JOINTS))
    for first in (-2.5, -1.0, 0.0, 1.0):
        x = work[QD] = first + np.array([0.0, 0.05, 0.5, 0.9, 1.0, 1.5])
        network(gains.pack_network(), CURRENT, work)
        hidden = np.exp(-np.square((x - gains.centers()[:, None]) / width) / 2.0)
        np.testing.assert_allclose(work[HIDDEN : HIDDEN + NODES], hidden, rtol=0.0, atol=1e-12)


def test_far_away_input_gives_no_output_and_no_error() -> None:
    work = np.zeros((WORK_ROWS, JOINTS))
    work[QD], work[W : W + NODES] = 1e6, 1e6
    network(NetworkGains(width=0.02).pack_network(), CURRENT, work)
    assert (work[NETWORK] == 0.0).all()


def test_a_law_without_a_network_leaves_none_behind() -> None:
    work = evaluated(NetworkGains(leakage=1))
    no_network(work)
    for row in (NETWORK, NETWORK_SLOPE, LEARNING, LEAKAGE):
        assert (work[row] == 0.0).all()
