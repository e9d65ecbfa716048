"""The lags of the drives: against the exponential of their matrix, and the implicit Euler step."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import pack_environment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.drive import begin_lag, drive, end_lag, lags
from slidetune.robot.kernels.workspace import (
    APPLIED,
    BETWEEN,
    CARRIED,
    COMMAND,
    CURRENT,
    DELIVERED,
    FULL,
    WITHHELD,
    WORK_ROWS,
)

Array = np.ndarray


def drawn(seed: int, count: int) -> tuple[Array, Array, Array, float]:
    """Return a workspace with torques and a command, its environment, lags [s] and a time [s]."""
    random = np.random.default_rng(seed)
    work = random.normal(scale=50.0, size=(WORK_ROWS, JOINTS))
    lag = np.exp(random.uniform(np.log(1e-4), np.log(0.05), JOINTS))
    lag[random.random(JOINTS) < 0.2] = 0.0
    lag[0] = 0.01
    environment = pack_environment(Disturbance(), 0.0, 0.0, None, lag, count)
    return work, environment, lag, float(np.exp(random.uniform(np.log(1e-7), np.log(5e-3))))


def chain(lag: float, count: int) -> Array:
    """Return the slopes of [integral of the joint's torque, its lags from the joint, command]."""
    slopes = np.zeros((count + 2, count + 2))
    slopes[0, 1] = 1.0
    for n in range(1, count + 1):
        slopes[n, n], slopes[n, n + 1] = -1.0 / lag, 1.0 / lag
    return slopes


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("seed", range(30))
def test_a_held_command_is_followed_exactly(seed: int, count: int) -> None:
    work, environment, lag, width = drawn(seed, count)
    assert lags(environment)
    before = work.copy()
    work[APPLIED] = 0.0
    drive(width, 0.25, environment, work)
    for j in range(JOINTS):
        if lag[j] == 0.0:
            assert work[APPLIED, j] == pytest.approx(0.25 * before[COMMAND, j], rel=1e-14)
            continue
        torques = [before[CURRENT + row, j] for row in (DELIVERED, BETWEEN)[:count]]
        start = np.array([0.0, *torques, before[COMMAND, j]])
        integral, *after = expm(chain(lag[j], count) * width) @ start
        assert work[APPLIED, j] == pytest.approx(0.25 * integral / width, rel=1e-8, abs=1e-9)
        assert work[CURRENT + DELIVERED, j] == pytest.approx(after[0], rel=1e-10, abs=1e-10)
        if count == 2:
            assert work[CURRENT + BETWEEN, j] == pytest.approx(after[1], rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("seed", range(30))
def test_an_implicit_step_solves_the_equation_of_the_lags(seed: int, count: int) -> None:
    work, environment, lag, h = drawn(seed, count)
    begin_lag(h, CURRENT, environment, work)
    command = work[COMMAND]
    delivered = work[CARRIED] + (1.0 - work[WITHHELD]) * command
    end_lag(h, CURRENT, FULL, environment, work)
    np.testing.assert_allclose(work[FULL + DELIVERED], delivered, rtol=1e-12, atol=1e-9)
    into = work[FULL + BETWEEN] if count == 2 else command
    for after, before, ahead in (
        (work[FULL + DELIVERED], work[CURRENT + DELIVERED], into),
        *([(work[FULL + BETWEEN], work[CURRENT + BETWEEN], command)] if count == 2 else []),
    ):
        np.testing.assert_allclose(lag * (after - before), h * (ahead - after), atol=1e-11)


@pytest.mark.parametrize("lag", [5e-324, 1e-300, 1e-12, 1e-6])
@pytest.mark.parametrize("count", [1, 2])
def test_a_lag_too_short_to_matter_does_not(lag: float, count: int) -> None:
    work, _, _, _ = drawn(1, count)
    environment = pack_environment(Disturbance(), 0.0, 0.0, None, lag, count)
    work[APPLIED] = 0.0
    drive(1e-3, 1.0, environment, work)
    for row in (APPLIED, DELIVERED):
        np.testing.assert_allclose(work[row], work[COMMAND], rtol=1e-2, atol=2.0)
    begin_lag(1e-3, CURRENT, environment, work)
    end_lag(1e-3, CURRENT, FULL, environment, work)
    assert np.isfinite(work).all()


def test_a_drive_without_a_lag_is_none() -> None:
    assert not lags(pack_environment(Disturbance(), 0.0, 0.0, None, 0.0, 2))
