"""What the controller sees: exact, or with white noise of its deviation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import SENSOR_Q, SENSOR_V, pack_environment
from slidetune.robot.environment.sensor import measure
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.workspace import MEASURED_Q, MEASURED_V, WORK_ROWS, Q, V

Array = np.ndarray
SIX = [1.0, -2.0, 3.0, 0.0, 0.5, -0.1]


def environment(friction: float | list[float] = 0.0, coulomb: float = 0.0, **changes: Any) -> Array:
    return pack_environment(Disturbance.model_validate(changes), friction, coulomb, None)


def measured(numbers: Array, samples: list[int]) -> tuple[Array, Array]:
    """Return what is measured of a state at rest in 0. Shapes (n, 6)."""
    work, rows = np.zeros((WORK_ROWS, JOINTS)), []
    for sample in samples:
        measure(sample, numbers, work)
        rows.append(work[[MEASURED_Q, MEASURED_V]])
    q, v = np.moveaxis(np.array(rows), 1, 0)
    return q, v


def noisy(position: float = 0.001, velocity: float = 0.05, seed: int = 1) -> Array:
    return environment(sensor_noise={"position": position, "velocity": velocity}, seed=seed)


def test_sensors_are_exact_without_noise() -> None:
    work = np.random.default_rng(1).normal(size=(WORK_ROWS, JOINTS))
    measure(5, environment(), work)
    np.testing.assert_array_equal(work[MEASURED_Q], work[Q])
    np.testing.assert_array_equal(work[MEASURED_V], work[V])


def test_sensor_noise_has_its_deviation_and_no_mean() -> None:
    q, v = measured(noisy(), list(range(20_000)))
    np.testing.assert_allclose(q.std(axis=0), 0.001, rtol=0.03)
    np.testing.assert_allclose(v.std(axis=0), 0.05, rtol=0.03)
    assert np.abs(q.mean(axis=0)).max() < 4 * 0.001 / np.sqrt(20_000)
    assert np.abs(v.mean(axis=0)).max() < 4 * 0.05 / np.sqrt(20_000)


def test_sensor_noise_is_normal_and_white() -> None:
    q, v = measured(noisy(), list(range(20_000)))
    both = np.hstack([q / 0.001, v / 0.05])
    np.testing.assert_allclose((both**4).mean(axis=0), 3.0, atol=0.25)
    assert np.abs(np.corrcoef(both.T) - np.eye(2 * JOINTS)).max() < 0.03
    for lag in (1, 2, 7):
        assert np.abs((both[lag:] * both[:-lag]).mean(axis=0)).max() < 0.03


def test_sensor_noise_does_not_depend_on_the_order_of_looking() -> None:
    forward = measured(noisy(), [3, 4, 5, 900])
    backward = measured(noisy(), [900, 5, 4, 3])
    for one, other in zip(forward, backward, strict=True):
        np.testing.assert_array_equal(one, other[::-1])


def test_sensor_noise_follows_the_seed() -> None:
    first, again, other = (measured(noisy(seed=seed), [0, 1, 2]) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert (first[0] != other[0]).all()


@pytest.mark.parametrize("seed", [0, 1, 2, 2**31 - 1])
def test_no_sample_is_an_outlier(seed: int) -> None:
    q, v = measured(noisy(seed=seed), list(range(2000)))
    assert max(np.abs(q / 0.001).max(), np.abs(v / 0.05).max()) < 5.5


def test_noise_on_the_angle_alone_leaves_the_velocity() -> None:
    q, v = measured(noisy(velocity=0.0), [1, 2])
    assert q.any()
    assert not v.any()
    assert environment()[[SENSOR_Q, SENSOR_V], 0].tolist() == [0.0, 0.0]
