"""What the controller of a sampled loop sees: the true angles and velocities, and noise."""

from __future__ import annotations

from math import cos, log, pi, sin, sqrt

import numpy as np

from slidetune.robot.environment.layout import SEED, SENSOR_Q, SENSOR_V
from slidetune.robot.fields.quantity import JOINTS
from slidetune.robot.kernels.compiler import kernel
from slidetune.robot.kernels.workspace import MEASURED_Q, MEASURED_V, Q, V


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
def measure(sample, environment, work):  # type: ignore[no-untyped-def]
    """Write what the controller sees of the current state: the truth plus white noise.

    Args:
        sample: number of the control period; same seed and sample, same noise.
        environment: what ``pack_environment`` returned.
        work: workspace; writes MEASURED_Q [rad] and MEASURED_V [rad/s].
    """
    deviation_q, deviation_v = environment[SENSOR_Q, 0], environment[SENSOR_V, 0]
    for j in range(JOINTS):
        work[MEASURED_Q, j] = work[Q, j]
        work[MEASURED_V, j] = work[V, j]
        if deviation_q > 0.0 or deviation_v > 0.0:
            seed = int(environment[SEED, 0])
            radius = sqrt(-2.0 * log(_uniform(seed, sample, 2 * j)))
            angle = 2.0 * pi * _uniform(seed, sample, 2 * j + 1)
            work[MEASURED_Q, j] += deviation_q * radius * cos(angle)
            work[MEASURED_V, j] += deviation_v * radius * sin(angle)
