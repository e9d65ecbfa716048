"""F, the torque that the joints lose (Liu et al. 2025, Eq. 1): disturbance and friction."""

from __future__ import annotations

from math import cos, floor, sin, sqrt, tanh

from slidetune.robot.environment.layout import (
    BITS,
    CONSTANT,
    COULOMB,
    DURATION,
    NOISE,
    NOISES,
    OMEGA,
    PERIOD,
    PHASE,
    PULSE,
    PULSES,
    RUBS,
    SINE,
    START,
    SWINGS,
    TONE_OMEGA,
    TONE_PHASE,
    TONES,
    VISCOUS,
)
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import DISTURBANCE, EDGE, F_SLOPE, PUSH, F, V

COULOMB_WIDTH = 0.02
"""Velocity [rad/s] over which Coulomb friction changes its sign (*ours*)."""


@kernel
def _on_time(since, environment):  # type: ignore[no-untyped-def]
    """Return how long in [s] the pulse has been on, ``since`` [s] after its first start."""
    duration, period = environment[DURATION, 0], environment[PERIOD, 0]
    if since <= 0.0:
        return 0.0
    if period == 0.0:
        return min(since, duration)
    count = floor(since / period)
    return count * min(duration, period) + min(since - count * period, duration)


@kernel
def _pulse_mean(t, width, environment):  # type: ignore[no-untyped-def]
    """Return the share of ``[t, t + width]`` in which the pulse is on; at ``t`` for width 0."""
    since = t - environment[START, 0]
    if width > 0.0:
        return (_on_time(since + width, environment) - _on_time(since, environment)) / width
    if environment[PERIOD, 0] > 0.0 and since > 0.0:
        since -= environment[PERIOD, 0] * floor(since / environment[PERIOD, 0])
    return 1.0 if 0.0 <= since < environment[DURATION, 0] else 0.0


@kernel
def _damped(x):  # type: ignore[no-untyped-def]
    """Return sin(x)/x: the mean of a sine over 2x of its angle, over its value in the middle."""
    return 1.0 - x * x / 6.0 if abs(x) < 1e-4 else sin(x) / x


@kernel
def disturbance_torque(t, width, environment, work):  # type: ignore[no-untyped-def]
    r"""Mean of the disturbance over a step, written to DISTURBANCE [N m].

    .. math:: \frac{1}{w} \int_t^{t+w} F_0 + \tilde F \sin(\omega s + \alpha) + \hat F(s)
        + \bar F(s)\,ds - \tau_{push}

    The mean is exact, so that a pulse or a swing gives its whole impulse, whatever the step.

    Args:
        t: time in [s].
        width: length of the step in [s]; 0 asks for the torque at ``t``.
        environment: what ``pack_environment`` returned.
        work: workspace; writes ERRORS[EDGE] too: whether a pulse begins or ends within the step.
    """
    bits, middle = int(environment[BITS, 0]), t + 0.5 * width
    wave, pulse = 0.0, 0.0
    work[EDGE, 0] = 0.0
    if bits & SWINGS:
        omega = environment[OMEGA, 0]
        wave = sin(omega * middle + environment[PHASE, 0]) * _damped(0.5 * omega * width)
    if bits & PULSES:
        pulse = _pulse_mean(t, width, environment)
        work[EDGE, 0] = 1.0 if 0.0 < pulse < 1.0 else 0.0
    for j in range(JOINTS):
        torque = (
            environment[CONSTANT, j] + wave * environment[SINE, j] + pulse * environment[PULSE, j]
        )
        if bits & NOISES and environment[NOISE, j] != 0.0:
            total = 0.0
            for n in range(TONES):
                omega = environment[TONE_OMEGA + n, j]
                tone = cos(omega * middle + environment[TONE_PHASE + n, j])
                total += tone * _damped(0.5 * omega * width)
            torque += environment[NOISE, j] * sqrt(2.0 / TONES) * total
        work[DISTURBANCE, j] = torque - work[PUSH, j]


@kernel
def changes_within_a_step(environment):  # type: ignore[no-untyped-def]
    """Tell whether the mean of the disturbance depends on the length of the step."""
    return int(environment[BITS, 0]) & (SWINGS | PULSES | NOISES) != 0


@kernel
def external_torque(t, width, state, environment, work):  # type: ignore[no-untyped-def]
    r"""Torque that a joint loses and its slope over velocity.

    .. math:: F = \text{DISTURBANCE} + d\,v + f_C \tanh(v / v_C)

    Args:
        t: time in [s].
        width: length of the step over which the disturbance counts in [s]; 0 for ``t`` alone.
        state: first row of the state whose velocity counts.
        environment: what ``pack_environment`` returned.
        work: workspace; writes DISTURBANCE [N m], F [N m] and F_SLOPE [N m s/rad].
    """
    disturbance_torque(t, width, environment, work)
    rubs = int(environment[BITS, 0]) & RUBS != 0
    for j in range(JOINTS):
        v, slope = work[state + V, j], environment[VISCOUS, j]
        torque = work[DISTURBANCE, j] + slope * v
        if rubs and environment[COULOMB, j] != 0.0:
            rubbing = tanh(v / COULOMB_WIDTH)
            torque += environment[COULOMB, j] * rubbing
            slope += environment[COULOMB, j] * (1.0 - rubbing * rubbing) / COULOMB_WIDTH
        work[F, j] = torque
        work[F_SLOPE, j] = slope
