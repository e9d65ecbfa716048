"""How near a curve comes to the real axis left of the layer."""

from __future__ import annotations

import numpy as np
import pytest

from slidetune.robot.margins.clearance import clearance_of

OMEGA = np.geomspace(1.0, 1e3, 200)


def test_an_integral_keeps_a_right_angle_from_it() -> None:
    found = clearance_of(OMEGA, 10.0 / (1j * OMEGA), 0.1)
    assert found is not None
    assert found.angle == pytest.approx(0.5 * np.pi)


def test_only_what_is_longer_than_the_layer_counts() -> None:
    lag = 10.0 / (1j * OMEGA * (1.0 + 0.01j * OMEGA))
    wide, thin = (clearance_of(OMEGA, lag, layer) for layer in (1.0, 0.01))
    assert wide is not None
    assert thin is not None
    assert thin.angle < wide.angle
    assert abs(10.0 / (1j * wide.omega * (1.0 + 0.01j * wide.omega))) == pytest.approx(1.0, rel=0.1)
    assert clearance_of(OMEGA, lag, 20.0) is None


def test_without_a_layer_all_of_it_counts() -> None:
    lag = 10.0 / (1j * OMEGA * (1.0 + 0.01j * OMEGA))
    found = clearance_of(OMEGA, lag, 0.0)
    assert found is not None
    assert found.omega == pytest.approx(OMEGA[-1])
