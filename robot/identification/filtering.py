"""A log without what lies above the motion: the same filter on both sides of the equation.

Inverse dynamic identification (Gautier 1997; Janot, Vandanjon and Gautier 2014): angles pass a wide
filter without phase and are differentiated; torque and regressor then pass the same narrow one, and
of the rows only as many remain as tell something new.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError

Array = np.ndarray

BANDWIDTH = 10.0
"""Cutoff of the filter in [Hz] (*ours*): well above what arms are moved by, below most noise."""
_SHARE = 0.1
"""Highest cutoff as a share of the rate of the rows (*ours*)."""
_WIDER = 4.0
"""Cutoff of the angles over that of the equation (*ours*): below the latter they are whole, so that
both of its sides have passed the same filter."""
_LEAST_BANDWIDTH = 0.5
_ORDER = 4
"""Of the Butterworth filter, which passes both ways."""
_FINE = 20.0
"""Rows a period of the cutoff at which the regressor is evaluated (*ours*)."""
_EDGE = 2.0
"""Periods of the cutoff that are left out at both ends, where the filter begins (*ours*)."""
FEWEST = 40
"""Fewest rows that remain (*ours*)."""
MOST = 60_000
"""Most rows at which the regressor is evaluated (*ours*): five minutes at 10 Hz, 0.3 GB."""


class Kinematics(NamedTuple):
    """A log without what lies above the cutoff.

    Attributes:
        time: time in [s], evenly spaced. Shape (m,).
        q: angles in [rad]. Shape (m, n).
        v: velocities in [rad/s]. Shape (m, n).
        a: accelerations in [rad/s^2]. Shape (m, n).
        torque: torques in [N m], not yet filtered. Shape (m, n).
        bandwidth: the cutoff in [Hz].
    """

    time: Array
    q: Array
    v: Array
    a: Array
    torque: Array
    bandwidth: float

    @property
    def rate(self) -> float:
        """Rows a second."""
        return float(1.0 / (self.time[1] - self.time[0]))


def kinematics_of(
    recording: Recording, torque: Array, bandwidth: float | None, late: float = 0.0
) -> Kinematics:
    """Return angles, velocities and accelerations of a log below a cutoff.

    Args:
        recording: a log.
        torque: its torques in [N m]. Shape (m, n).
        bandwidth: the cutoff in [Hz]; 10 Hz, or a tenth of the rate where that is less.
        late: by how much the torques act later than the log has them, in [s].

    Raises:
        RecordingError: if the log is too slow or too short for it.
    """
    from scipy.signal import savgol_filter  # here, because it takes long to import

    time = recording.time
    count = max(round(recording.duration / recording.period), 1) + 1
    even = np.linspace(0.0, time[-1], count)
    h = float(even[1])
    most = _SHARE / h
    cutoff = min(BANDWIDTH, most) if bandwidth is None else bandwidth
    if not _LEAST_BANDWIDTH <= cutoff <= most:
        raise RecordingError(
            f"{recording.name}: bandwidth must be in [{_LEAST_BANDWIDTH:g}, {most:.3g}] Hz for "
            f"rows at {1.0 / h:.4g} Hz, got {cutoff:.3g}"
        )
    if recording.duration < (FEWEST + 4.0 * _EDGE) / (2.0 * cutoff):
        raise RecordingError(
            f"{recording.name}: {recording.duration:.3g} s tell too little at {cutoff:.3g} Hz: "
            f"{(FEWEST + 4.0 * _EDGE) / (2.0 * cutoff):.3g} s are needed"
        )
    if recording.duration * _FINE * cutoff > MOST:
        raise RecordingError(
            f"{recording.name}: lasts {recording.duration:.4g} s, at {cutoff:.3g} Hz at most "
            f"{MOST / (_FINE * cutoff):.4g} s are fitted: cut it, or lower the bandwidth"
        )
    q = _smoothed(_at(even, time, recording.q), 1.0 / h, _WIDER * cutoff)
    v = savgol_filter(q, 5, 4, deriv=1, delta=h, axis=0)  # differences of fourth order
    a = savgol_filter(q, 5, 4, deriv=2, delta=h, axis=0)
    kept = max(int(1.0 / (h * _FINE * cutoff)), 1)
    # Before rows are left out, what lies above half of their rate is taken off.
    force = _at(even, time + late, torque)
    if kept > 1:
        force = _smoothed(force, 1.0 / h, 0.4 / (h * kept))
    rows = slice(None, None, kept)
    return Kinematics(even[rows], q[rows], v[rows], a[rows], force[rows], cutoff)


def thinned(kinematics: Kinematics, block: Array) -> Array:
    """Return a torque or a column of the regressor, filtered, with the rows that tell something.

    Args:
        kinematics: the log.
        block: shape (m, …).

    Returns:
        Two rows a period of the cutoff. Shape (r, …).
    """
    smooth = _smoothed(block, kinematics.rate, kinematics.bandwidth)
    edge = int(_EDGE * kinematics.rate / kinematics.bandwidth) + 1
    step = max(round(kinematics.rate / (2.0 * kinematics.bandwidth)), 1)
    return smooth[edge:-edge:step]


def _smoothed(block: Array, rate: float, cutoff: float) -> Array:
    from scipy.signal import butter, sosfiltfilt

    sections = butter(_ORDER, cutoff, fs=rate, output="sos")
    return np.asarray(sosfiltfilt(sections, block, axis=0))


def _at(even: Array, time: Array, block: Array) -> Array:
    return np.stack([np.interp(even, time, column) for column in block.T], axis=1)
