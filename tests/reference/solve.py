"""Integrates the reference's closed loop to high accuracy."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from scipy.integrate import Radau

from tests.reference.loop import Loop

Array = np.ndarray

MAX_ANGLE, MAX_VELOCITY = 100.0, 200.0
"""Where a lane counts as diverged, in [rad] and [rad/s]."""
STEPS = 60_000
"""Steps of the integrator after which it gives up."""


class GaveUpError(Exception):
    """The integrator could not get through."""


class Solution(NamedTuple):
    """A solved experiment.

    Attributes:
        q: angles in [rad], NaN after it left its bounds. Shape (m, n).
        end: until when it stayed within its bounds in [s].
    """

    q: Array
    end: float


def solve(
    document: dict[str, Any],
    time: Array,
    rtol: float,
    thin: float = 1e-6,
    most: int = STEPS,
    arms: tuple[pin.Model, pin.Model] | None = None,
) -> Solution:
    """Integrate an experiment of one lane by Radau IIA of order five.

    Args:
        document: the experiment as plain values, complete.
        time: when to look in [s], rising from 0. Shape (n,).
        rtol: relative tolerance; the absolute one is a hundredth of it.
        thin: layer that stands for ``sign`` in [rad/s].
        most: steps after which it gives up.
        arms: the true and the nominal arm; by default those of the published arm.

    Raises:
        GaveUpError: if it takes too many steps.
    """
    loop = Loop(document, thin, arms)
    joints = loop.joints
    q = np.full((len(time), joints), np.nan)
    q[0] = loop.start[:joints]
    ends = [edge for edge in loop.edges if 0.0 < edge < time[-1]] + [float(time[-1])]
    t, y, row, steps = 0.0, loop.start, 1, 0
    for end in ends:
        loop.within = 0.5 * (t + end)
        stepper = Radau(
            loop.rate,
            t,
            y,
            end,
            rtol=rtol,
            atol=0.01 * rtol,
            jac=loop.jacobian,
            first_step=min(1e-9, end - t),
        )
        while stepper.status == "running":
            stepper.step()
            steps += 1
            if stepper.status == "failed" or steps > most:
                raise GaveUpError(f"at {stepper.t:.6g} s after {steps} steps")
            found = stepper.dense_output()
            while row < len(time) and time[row] <= stepper.t:
                q[row] = found(time[row])[:joints]
                row += 1
            state = np.abs(stepper.y)
            if state[:joints].max() > MAX_ANGLE or state[joints : 2 * joints].max() > MAX_VELOCITY:
                return Solution(q, stepper.t)
        t, y = end, stepper.y
    return Solution(q, float(time[-1]))
