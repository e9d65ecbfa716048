"""What acts on the joints besides the controller: torques, friction, limits, sensor noise.

F is the torque that the joints lose to the world (Liu et al. 2025, Eq. 1).
"""

from __future__ import annotations

from math import cos, floor, log, pi, sin, sqrt, tanh

import numpy as np

from slidetune.robot.fields.quantity import JOINTS, Integer, Number, PerJoint, Section, field
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import (
    DISTURBANCE,
    EDGE,
    ERRORS,
    F_SLOPE,
    MEASURED_Q,
    MEASURED_V,
    PUSH,
    F,
    Q,
    V,
)

Array = np.ndarray

COULOMB_WIDTH = 0.02
"""Velocity [rad/s] over which Coulomb friction changes its sign (*ours*)."""
TONES = 16
"""Sines of random phase that make one joint's band-limited noise (*ours*)."""

VISCOUS, COULOMB, LIMIT, CONSTANT, SINE, PULSE, NOISE, COMMON = range(8)
TONE_OMEGA = 8
TONE_PHASE = TONE_OMEGA + TONES
WORLD_ROWS = TONE_PHASE + TONES
# Columns of the row COMMON.
OMEGA, PHASE, START, DURATION, PERIOD, BITS = range(6)
# Bits of the column BITS: which parts of the world there are.
SWINGS, PULSES, NOISES, RUBS, LIMITS = 1, 2, 4, 8, 16
KINKS = RUBS | LIMITS
# Sensor noise stands in a row of its own, after the tones.
SENSOR = WORLD_ROWS
SENSOR_Q, SENSOR_V, SEED = range(3)


class SineTorque(Section):
    """A torque that swings."""

    amplitude: PerJoint = field(
        0.0,
        title="Amplitude",
        symbol="F_sine",
        unit="N·m",
        low=-200.0,
        high=200.0,
        step=0.5,
        meaning="Greatest torque of the swing.",
    )
    frequency: Number = field(
        1.0,
        title="Frequency",
        symbol="f",
        unit="Hz",
        low=0.01,
        high=100.0,
        step=0.01,
        scale="log",
        meaning="Swings a second.",
    )
    phase: Number = field(
        0.0,
        title="Phase",
        unit="rad",
        low=-3.1416,
        high=3.1416,
        step=0.01,
        meaning="Where the swing begins.",
    )


class PulseTorque(Section):
    """A torque that comes and goes."""

    amplitude: PerJoint = field(
        0.0,
        title="Height",
        symbol="F_pulse",
        unit="N·m",
        low=-200.0,
        high=200.0,
        step=0.5,
        meaning="Torque while the pulse lasts.",
    )
    start: Number = field(
        3.0, title="Start", unit="s", low=0.0, high=60.0, step=0.1, meaning="When it first comes."
    )
    duration: Number = field(
        0.5,
        title="Duration",
        unit="s",
        low=0.001,
        high=60.0,
        step=0.01,
        scale="log",
        meaning="How long it lasts.",
    )
    period: Number = field(
        0.0,
        title="Period",
        unit="s",
        low=0.0,
        high=60.0,
        step=0.1,
        meaning="Time from one pulse to the next; 0 for a single one.",
    )


class NoiseTorque(Section):
    """A random torque within a band of frequencies."""

    amplitude: PerJoint = field(
        0.0,
        title="Effective value",
        symbol="F_noise",
        unit="N·m",
        low=0.0,
        high=100.0,
        step=0.1,
        meaning="Root mean square of the torque.",
    )
    bandwidth: Number = field(
        10.0,
        title="Bandwidth",
        unit="Hz",
        low=0.1,
        high=200.0,
        step=0.1,
        scale="log",
        meaning="Highest frequency that it holds.",
    )


class SensorNoise(Section):
    """White noise on what the controller measures, in sampled mode."""

    position: Number = field(
        0.0,
        title="Angle noise",
        unit="rad",
        low=0.0,
        high=0.01,
        step=0.00001,
        applies="sampled",
        meaning="Standard deviation of every angle sample.",
    )
    velocity: Number = field(
        0.0,
        title="Velocity noise",
        unit="rad/s",
        low=0.0,
        high=0.5,
        step=0.0001,
        applies="sampled",
        meaning="Standard deviation of every velocity sample.",
    )


class Disturbance(Section):
    """All that the controller is not told."""

    constant: PerJoint = field(
        0.0,
        title="Constant torque",
        symbol="F",
        unit="N·m",
        low=-200.0,
        high=200.0,
        step=0.5,
        equation="Eq. 1",
        source="inferred",
        meaning="Torque that the joints always lose.",
    )
    sine: SineTorque = SineTorque()
    pulse: PulseTorque = PulseTorque()
    noise: NoiseTorque = NoiseTorque()
    nominal_mismatch: Number = field(
        1.0,
        title="Nominal model",
        symbol="M̂/M",
        low=0.1,
        high=3.0,
        step=0.01,
        meaning="Inertials that a model-based law believes in, as a multiple of the true ones.",
    )
    sensor_noise: SensorNoise = SensorNoise()
    seed: Integer = field(
        1,
        title="Seed",
        low=0,
        high=2**31 - 1,
        step=1,
        meaning="Same seed, same noise: runs can be repeated to the last bit.",
    )


def pack_world(
    disturbance: Disturbance, viscous: PerJoint, coulomb: PerJoint, torque_limit: PerJoint | None
) -> Array:
    """Return disturbance, friction and limits as numbers.

    Args:
        disturbance: the disturbance.
        viscous: viscous friction in [N m s/rad].
        coulomb: Coulomb friction in [N m].
        torque_limit: torque limits in [N m], ``None`` for none.

    Returns:
        Shape (WORLD_ROWS + 1, 6).
    """
    world = np.zeros((WORLD_ROWS + 1, JOINTS))
    world[VISCOUS], world[COULOMB] = viscous, coulomb
    world[LIMIT] = np.inf if torque_limit is None else torque_limit
    world[CONSTANT], world[SINE] = disturbance.constant, disturbance.sine.amplitude
    world[PULSE], world[NOISE] = disturbance.pulse.amplitude, disturbance.noise.amplitude
    pulse, sine = disturbance.pulse, disturbance.sine
    common = [2.0 * pi * sine.frequency, sine.phase, pulse.start, pulse.duration, pulse.period]
    bits = sum(
        bit
        for bit, active in (
            (SWINGS, np.any(world[SINE])),
            (PULSES, np.any(world[PULSE])),
            (NOISES, np.any(world[NOISE])),
            (RUBS, np.any(world[COULOMB])),
            (LIMITS, np.any(np.isfinite(world[LIMIT]))),
        )
        if active
    )
    world[COMMON, :6] = [*common, float(bits)]
    if bits & NOISES:
        _pack_tones(disturbance, world)
    noise = disturbance.sensor_noise
    world[SENSOR, :3] = noise.position, noise.velocity, disturbance.seed
    return world


def _pack_tones(disturbance: Disturbance, world: Array) -> None:
    """Spread the tones over the band, one in each of TONES equal parts, all of equal power."""
    random = np.random.default_rng(disturbance.seed)
    parts = (np.arange(TONES)[:, None] + random.random((TONES, JOINTS))) / TONES
    world[TONE_OMEGA:TONE_PHASE] = 2.0 * pi * disturbance.noise.bandwidth * parts
    world[TONE_PHASE:WORLD_ROWS] = 2.0 * pi * random.random((TONES, JOINTS))


@kernel
def _on_time(since, world):  # type: ignore[no-untyped-def]
    """Return how long in [s] the pulse has been on, ``since`` [s] after its first start."""
    duration, period = world[COMMON, DURATION], world[COMMON, PERIOD]
    if since <= 0.0:
        return 0.0
    if period == 0.0:
        return min(since, duration)
    count = floor(since / period)
    return count * min(duration, period) + min(since - count * period, duration)


@kernel
def _pulse_mean(t, width, world):  # type: ignore[no-untyped-def]
    """Return the share of ``[t, t + width]`` in which the pulse is on; at ``t`` for width 0."""
    since = t - world[COMMON, START]
    if width > 0.0:
        return (_on_time(since + width, world) - _on_time(since, world)) / width
    if world[COMMON, PERIOD] > 0.0 and since > 0.0:
        since -= world[COMMON, PERIOD] * floor(since / world[COMMON, PERIOD])
    return 1.0 if 0.0 <= since < world[COMMON, DURATION] else 0.0


@kernel
def _damped(x):  # type: ignore[no-untyped-def]
    """Return sin(x)/x: the mean of a sine over 2x of its angle, over its value in the middle."""
    return 1.0 - x * x / 6.0 if abs(x) < 1e-4 else sin(x) / x


@kernel
def disturbance_torque(t, width, world, work):  # type: ignore[no-untyped-def]
    r"""Mean of the disturbance over a step, written to DISTURBANCE [N m].

    .. math:: \frac{1}{w} \int_t^{t+w} F_0 + \tilde F \sin(\omega s + \alpha) + \hat F(s)
        + \bar F(s)\,ds - \tau_{push}

    The mean is exact, so that a pulse or a swing gives its whole impulse, whatever the step.

    Args:
        t: time in [s].
        width: length of the step in [s]; 0 asks for the torque at ``t``.
        world: what ``pack_world`` returned.
        work: workspace; writes ERRORS[EDGE] too: whether a pulse begins or ends within the step.
    """
    bits, middle = int(world[COMMON, BITS]), t + 0.5 * width
    wave, pulse = 0.0, 0.0
    work[ERRORS, EDGE] = 0.0
    if bits & SWINGS:
        omega = world[COMMON, OMEGA]
        wave = sin(omega * middle + world[COMMON, PHASE]) * _damped(0.5 * omega * width)
    if bits & PULSES:
        pulse = _pulse_mean(t, width, world)
        work[ERRORS, EDGE] = 1.0 if 0.0 < pulse < 1.0 else 0.0
    for j in range(JOINTS):
        torque = world[CONSTANT, j] + wave * world[SINE, j] + pulse * world[PULSE, j]
        if bits & NOISES and world[NOISE, j] != 0.0:
            total = 0.0
            for n in range(TONES):
                omega = world[TONE_OMEGA + n, j]
                tone = cos(omega * middle + world[TONE_PHASE + n, j])
                total += tone * _damped(0.5 * omega * width)
            torque += world[NOISE, j] * sqrt(2.0 / TONES) * total
        work[DISTURBANCE, j] = torque - work[PUSH, j]


@kernel
def changes_within_a_step(world):  # type: ignore[no-untyped-def]
    """Tell whether the mean of the disturbance depends on the length of the step."""
    return int(world[COMMON, BITS]) & (SWINGS | PULSES | NOISES) != 0


@kernel
def external_torque(t, width, base, world, work):  # type: ignore[no-untyped-def]
    r"""Torque lost to the world and its slope over velocity.

    .. math:: F = \text{DISTURBANCE} + d\,v + f_C \tanh(v / v_C)

    Args:
        t: time in [s].
        width: length of the step over which the disturbance counts in [s]; 0 for ``t`` alone.
        base: first row of the state whose velocity counts.
        world: what ``pack_world`` returned.
        work: workspace; writes DISTURBANCE [N m], F [N m] and F_SLOPE [N m s/rad].
    """
    disturbance_torque(t, width, world, work)
    rubs = int(world[COMMON, BITS]) & RUBS != 0
    for j in range(JOINTS):
        v, slope = work[base + V, j], world[VISCOUS, j]
        torque = work[DISTURBANCE, j] + slope * v
        if rubs and world[COULOMB, j] != 0.0:
            rubbing = tanh(v / COULOMB_WIDTH)
            torque += world[COULOMB, j] * rubbing
            slope += world[COULOMB, j] * (1.0 - rubbing * rubbing) / COULOMB_WIDTH
        work[F, j] = torque
        work[F_SLOPE, j] = slope


@kernel
def _uniform(seed, sample, stream):  # type: ignore[no-untyped-def]
    """Hash three whole numbers to (0, 1) (the finalizer of SplitMix64): no state, no order."""
    # One more than the seed: zero would be a fixed point, and its sample nine deviations away.
    z = np.uint64(seed + 1) * np.uint64(0x9E3779B97F4A7C15)
    z += np.uint64(sample) * np.uint64(0xD1342543DE82EF95) + np.uint64(stream)
    for _ in range(2):
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z = z ^ (z >> np.uint64(31))
    return (float(z >> np.uint64(11)) + 0.5) / 9007199254740992.0


@kernel
def measure(sample, world, work):  # type: ignore[no-untyped-def]
    """Write what the controller sees of the current state: the truth plus white noise.

    Args:
        sample: number of the control period; same seed and sample, same noise.
        world: what ``pack_world`` returned.
        work: workspace; writes MEASURED_Q [rad] and MEASURED_V [rad/s].
    """
    deviation_q, deviation_v = world[SENSOR, SENSOR_Q], world[SENSOR, SENSOR_V]
    for j in range(JOINTS):
        work[MEASURED_Q, j] = work[Q, j]
        work[MEASURED_V, j] = work[V, j]
        if deviation_q > 0.0 or deviation_v > 0.0:
            seed = int(world[SENSOR, SEED])
            radius = sqrt(-2.0 * log(_uniform(seed, sample, 2 * j)))
            angle = 2.0 * pi * _uniform(seed, sample, 2 * j + 1)
            work[MEASURED_Q, j] += deviation_q * radius * cos(angle)
            work[MEASURED_V, j] += deviation_v * radius * sin(angle)
