"""The drive between the commanded torque and the joint: a lag, or two equal ones in series.

A lag follows the command, which its limit has bounded, and begins at 0:

    tau_lag dx/dt = command - x

In continuous mode it joins the implicit step, whose torque at a joint is then a share of the
command at the end of the step, and what is carried over from before. Under a command that is held
it is solved exactly, and the arm is stepped under its mean.
"""

from __future__ import annotations

from math import exp, expm1

from slidetune.robot.environment.layout import BITS, LAG, LAGS, TWO_LAGS
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import inlined, kernel
from slidetune.robot.kernels.workspace import (
    APPLIED,
    BETWEEN,
    CARRIED,
    COMMAND,
    CURRENT,
    DELIVERED,
    WITHHELD,
)

_LONG = 700.0
"""Time constants after which nothing is left of a torque (*ours*): e^-700 is the least number."""


@inlined
def lags(environment):  # type: ignore[no-untyped-def]
    """Tell whether any drive has a lag."""
    return int(environment[BITS, 0]) & LAGS != 0


@kernel
def begin_lag(h, state, environment, work):  # type: ignore[no-untyped-def]
    r"""Write what the lags make of a command over one implicit Euler step.

    .. math:: x_1 = \rho x + (1 - \rho) u_1, \qquad \rho = \frac{\tau_{lag}}{\tau_{lag} + h}

    Args:
        h: step in [s].
        state: first row of the state from which the step starts.
        environment: what ``pack_environment`` returned.
        work: workspace; writes WITHHELD [-] and CARRIED [N m].
    """
    two = int(environment[BITS, 0]) & TWO_LAGS != 0
    for j in range(JOINTS):
        kept = environment[LAG, j] / (environment[LAG, j] + h)
        work[WITHHELD, j] = kept
        work[CARRIED, j] = kept * work[state + DELIVERED, j]
        if two:
            work[WITHHELD, j] = kept * (2.0 - kept)
            work[CARRIED, j] += (1.0 - kept) * kept * work[state + BETWEEN, j]


@inlined
def without_lag(work):  # type: ignore[no-untyped-def]
    """Write that a command is delivered at once."""
    for j in range(JOINTS):
        work[WITHHELD, j], work[CARRIED, j] = 0.0, 0.0


@kernel
def end_lag(h, state, into, environment, work):  # type: ignore[no-untyped-def]
    """Write the torques of the lags after an implicit step, whose command is in COMMAND [N m].

    Args:
        h: step in [s].
        state: first row of the state from which the step started.
        into: first row of the state to write; it may be the same.
        environment: what ``pack_environment`` returned.
        work: workspace with what ``begin_lag`` wrote.
    """
    for j in range(JOINTS):
        kept = environment[LAG, j] / (environment[LAG, j] + h)
        given = work[CARRIED, j] + work[COMMAND, j] - work[WITHHELD, j] * work[COMMAND, j]
        follows = kept * work[state + BETWEEN, j] + (1.0 - kept) * work[COMMAND, j]
        work[into + DELIVERED, j], work[into + BETWEEN, j] = given, follows


@kernel
def held_lag(width, lag):  # type: ignore[no-untyped-def]
    r"""Return what a lag does in a time ``width`` under a command that is held.

    With :math:`r = w/\tau_{lag}`, and x and y the deviations of two lags in series from u:

    .. math:: x_1 = e^{-r} x, \quad y_1 = e^{-r}(y + r x), \quad
        \bar y = \frac{1 - e^{-r}}{r} y + \frac{1 - e^{-r} - r e^{-r}}{r} x

    Returns:
        :math:`e^{-r}`, :math:`r e^{-r}`, and the two factors of the mean [-].
    """
    if width >= _LONG * lag:
        share = lag / width
        return 0.0, 0.0, share, share
    r = width / lag
    left, gone = exp(-r), -expm1(-r)
    return left, r * left, gone / r, (gone - r * left) / r


@kernel
def drive(width, share, environment, work):  # type: ignore[no-untyped-def]
    """Let the lags follow the held command in COMMAND for a time, and add their mean to APPLIED.

    Args:
        width: the time in [s].
        share: its share of a step of the arm.
        environment: what ``pack_environment`` returned.
        work: workspace; moves the lags of the current state on.
    """
    two = int(environment[BITS, 0]) & TWO_LAGS != 0
    for j in range(JOINTS):
        command = work[COMMAND, j]
        left, passed, mean, mean_of_first = held_lag(width, environment[LAG, j])
        last = work[CURRENT + DELIVERED, j] - command
        first = work[CURRENT + BETWEEN, j] - command if two else 0.0
        work[APPLIED, j] += share * (command + mean * last + mean_of_first * first)
        work[CURRENT + DELIVERED, j] = command + left * last + passed * first
        work[CURRENT + BETWEEN, j] = command + left * first
