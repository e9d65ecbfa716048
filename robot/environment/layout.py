"""Disturbance, friction, limits and sensor noise as the one array that the kernels read."""

from __future__ import annotations

from math import pi

import numpy as np

from slidetune.robot.environment.disturbance import Disturbance
from slidetune.robot.fields.quantity import JOINTS, PerJoint

Array = np.ndarray

TONES = 16
"""Sines of random phase that make one joint's band-limited noise (*ours*)."""

VISCOUS, COULOMB, LIMIT, CONSTANT, SINE, PULSE, NOISE, LAG = range(8)
TONE_OMEGA = 8
TONE_PHASE = TONE_OMEGA + TONES
TONES_END = TONE_PHASE + TONES
# Rows of one number for all joints, in column 0.
OMEGA, PHASE, START, DURATION, PERIOD, BITS = range(TONES_END, TONES_END + 6)
SENSOR_Q, SENSOR_V, SEED = range(BITS + 1, BITS + 4)
ENVIRONMENT_ROWS = SEED + 1
# Bits of BITS: which parts of the environment there are.
SWINGS, PULSES, NOISES, RUBS, LIMITS, LAGS, TWO_LAGS = 1, 2, 4, 8, 16, 32, 64
KINKS = RUBS | LIMITS


def pack_environment(
    disturbance: Disturbance,
    viscous: PerJoint,
    coulomb: PerJoint,
    torque_limit: PerJoint | None,
    lag: PerJoint = 0.0,
    lags: int = 1,
    joints: int = JOINTS,
) -> Array:
    """Return disturbance, friction, limits and lags of the drives as numbers.

    Args:
        disturbance: the disturbance.
        viscous: viscous friction in [N m s/rad].
        coulomb: Coulomb friction in [N m].
        torque_limit: torque limits in [N m], ``None`` for none.
        lag: time constants of the drives in [s].
        lags: how many of them are in series, 1 or 2.
        joints: how many joints the arm has.

    Returns:
        Shape (ENVIRONMENT_ROWS, n).
    """
    environment = np.zeros((ENVIRONMENT_ROWS, joints))
    environment[VISCOUS], environment[COULOMB], environment[LAG] = viscous, coulomb, lag
    environment[LIMIT] = np.inf if torque_limit is None else torque_limit
    environment[CONSTANT], environment[SINE] = disturbance.constant, disturbance.sine.amplitude
    environment[PULSE], environment[NOISE] = (
        disturbance.pulse.amplitude,
        disturbance.noise.amplitude,
    )
    pulse, sine = disturbance.pulse, disturbance.sine
    common = [2.0 * pi * sine.frequency, sine.phase, pulse.start, pulse.duration, pulse.period]
    bits = sum(
        bit
        for bit, active in (
            (SWINGS, np.any(environment[SINE])),
            (PULSES, np.any(environment[PULSE])),
            (NOISES, np.any(environment[NOISE])),
            (RUBS, np.any(environment[COULOMB])),
            (LIMITS, np.any(np.isfinite(environment[LIMIT]))),
            (LAGS, np.any(environment[LAG])),
            (TWO_LAGS, lags == 2 and np.any(environment[LAG])),
        )
        if active
    )
    environment[OMEGA : BITS + 1, 0] = [*common, float(bits)]
    if bits & NOISES:
        _pack_tones(disturbance, environment)
    noise = disturbance.sensor_noise
    environment[SENSOR_Q : SEED + 1, 0] = noise.position, noise.velocity, disturbance.seed
    return environment


def _pack_tones(disturbance: Disturbance, environment: Array) -> None:
    """Spread the tones over the band, one in each of TONES equal parts, all of equal power."""
    random, joints = np.random.default_rng(disturbance.seed), environment.shape[1]
    parts = (np.arange(TONES)[:, None] + random.random((TONES, joints))) / TONES
    environment[TONE_OMEGA:TONE_PHASE] = 2.0 * pi * disturbance.noise.bandwidth * parts
    environment[TONE_PHASE:TONES_END] = 2.0 * pi * random.random((TONES, joints))
