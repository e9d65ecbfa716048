"""Tangents instead of curves: where they say that they hold, they do."""

from __future__ import annotations

import numpy as np

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.environment.layout import pack_environment
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.integrator.implicit_solve import SOLVED, solve_curves
from slidetune.robot.integrator.tangent import TANGENT, fill, follow_tanh, is_smooth, tangents_hold
from slidetune.robot.kernels.elimination import solve_symmetric
from slidetune.robot.kernels.workspace import (
    ACCELERATION,
    CURRENT,
    F_SLOPE,
    RIGHT,
    S_FALL,
    S_FREE,
    F,
    S,
    V,
)
from tests.robot.integrator.test_implicit_solve import Drawn

Array = np.ndarray


class Step:
    """A drawn step without friction and limits, solved by its tangents at the beginning."""

    def __init__(self, seed: int) -> None:
        self.drawn = Drawn(seed, "tanh", "exponential")
        self.work = self.drawn.before.copy()
        self.environment = pack_environment(Disturbance(), 2.0, 0.0, None)
        self.work[F], self.work[F_SLOPE] = 2.0 * self.work[V], 2.0
        fill(self.drawn.h, CURRENT, self.drawn.M, self.drawn.bias, self.work)
        solve_symmetric(self.work)

    def curves(self) -> Array:
        """Return the acceleration by the curves themselves in [rad/s^2]. Shape (6,)."""
        step, work = self.drawn, self.work.copy()
        work[ACCELERATION] = work[RIGHT]
        left = solve_curves(step.h, CURRENT, step.M, step.bias, self.environment, work)
        assert left <= SOLVED
        return work[ACCELERATION]

    def off(self) -> float:
        """Return by how much the velocity of RIGHT is off in [rad/s]."""
        return float(self.drawn.h * np.abs(self.work[RIGHT] - self.curves()).max())


def test_tangents_that_hold_solve_the_curves() -> None:
    held = followed = 0
    for seed in range(600):
        step = Step(seed)
        smooth = is_smooth(step.drawn.h, step.environment, step.work)
        holds = tangents_hold(step.drawn.h, CURRENT, step.drawn.M, step.environment, step.work)
        # The bound is the coarser question.
        assert holds or not smooth, seed
        if not holds:
            rest = (step.drawn.M, step.drawn.bias, step.environment, step.work)
            holds = follow_tanh(step.drawn.h, *rest)
            followed += holds
        held += holds
        if holds:
            # The joints couple: one that is off moves the others.
            condition = np.linalg.cond(step.drawn.M)
            assert step.off() <= JOINTS * TANGENT * condition, seed
    assert held > 100
    assert followed > 30


def test_who_passes_through_the_layer_is_left_to_the_curves() -> None:
    passed = 0
    for seed in range(200):
        step = Step(seed)
        end = step.work[S_FREE] - step.work[S_FALL] * step.curves()
        if np.abs(end - step.work[S]).max() > 1.001 * step.drawn.gains.epsilon:
            passed += 1
            rest = (step.drawn.M, step.drawn.bias, step.environment, step.work)
            assert not follow_tanh(step.drawn.h, *rest), seed
    assert passed > 50
