"""A recording as the desired motion of an experiment."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np

from slidetune.robot.arm.known import KnownArm
from slidetune.robot.motion.recorded import (
    DECIMALS,
    FEWEST_WAYPOINTS,
    LONGEST_ORIGIN,
    MOST_NUMBERS,
    SMALLEST_SPACING,
    WIDEST_SPACING,
    RecordedTrajectory,
    recorded_samples,
    waypoint_text,
)
from slidetune.robot.motion.trajectory import pack_trajectory
from slidetune.robot.recordings.recording import Recording
from slidetune.robot.recordings.refused import RecordingError
from slidetune.robot.recordings.smoothing import Smoothed, smooth

Array = np.ndarray

_FIRST = 12
"""Intervals that are tried first (*ours*)."""
_NO_CLOSER = 1.02
"""Factor on the least residual of all that is close enough (*ours*): what the spline itself leaves
is then a fifth of the noise."""
_CLOSE = 2e-5
"""Effective residual in [rad] or [m] that is close enough (*ours*): an encoder's last digit."""
STOP = 0.5
"""Time in [s] in which a motion comes to rest that ends while it moves (*ours*)."""
AT_REST = 0.02
"""Speed in [rad/s] or [m/s] below which a joint counts as at rest (*ours*)."""
_LAST, _FEWEST_LAST = 0.2, 6
"""Time in [s] at the end that tells how fast it moves, and rows of it at least (*ours*)."""
_MOST_ROWS = 100_000
"""Rows that are looked at (*ours*): of more, means of neighbours."""
_FINE = 8
"""Times between two waypoints at which limits are looked at (*ours*)."""


@dataclass(frozen=True)
class Reference:
    """A desired motion made of a recording.

    Attributes:
        trajectory: the section of an experiment.
        rms: effective residual of each joint in [rad]. Shape (n,).
        greatest: greatest residual of each joint in [rad]. Shape (n,).
        duration: time from the first row to the last in [s].
        remarks: what it does beside: limits that it exceeds, a stop at its end.
    """

    trajectory: RecordedTrajectory
    rms: Array
    greatest: Array
    duration: float
    remarks: tuple[str, ...]

    def patch(self) -> dict[str, Any]:
        """Return the merge patch that lets an experiment follow it."""
        return {"trajectory": self.trajectory.model_dump(mode="json")}


def reference_of(recording: Recording, arm: KnownArm, spacing: float | None = None) -> Reference:
    """Return the motion of a recording, resampled and smoothed by a spline of degree five.

    Measured angles count, or those that were asked for where none were measured. Waypoints are as
    many as come closer to the rows, up to what an experiment may hold.

    Args:
        recording: of this arm.
        arm: whose limits count.
        spacing: time between two waypoints in [s]; chosen where none is given.

    Raises:
        RecordingError: if it is too short, or the spacing can't be had.
    """
    time, q = _thinned(recording.time, recording.q)
    speed, bend = _motion_at_end(time, q)
    joint = int(np.argmax(np.abs(speed)))
    remarks = []
    if abs(speed[joint]) > AT_REST:
        time, q = _with_stop(time, q, speed, bend)
        remarks.append(
            f"the recording ends while joint {joint + 1} moves: it comes to rest in {STOP:g} s more"
        )
    length = float(time[-1])
    most = min(MOST_NUMBERS // arm.joints - 1, int(length / SMALLEST_SPACING), len(time) - 1)
    if most < FEWEST_WAYPOINTS - 1 or length / most > WIDEST_SPACING:
        raise RecordingError(
            f"{recording.name}: {recording.duration:.3g} s can't be a desired motion of "
            f"{arm.joints} joints: it takes 0.01 s and at most {most * WIDEST_SPACING:g} s"
        )
    if spacing is not None:
        least = _rounded_up(length / most)
        if not least <= spacing <= min(WIDEST_SPACING, length / (FEWEST_WAYPOINTS - 1)):
            raise RecordingError(
                f"spacing must be in [{least:g}, {length / (FEWEST_WAYPOINTS - 1):.3g}] s for "
                f"{length:.3g} s and {arm.joints} joints, got {spacing:g}"
            )
        found = smooth(time, q, ceil(length / spacing - 1e-9) + 1, spacing)
    else:
        found = _sufficient(time, q, most)
    trajectory = RecordedTrajectory.model_validate(
        {
            "spacing": found.spacing,
            "waypoints": waypoint_text(found.waypoints),
            "origin": recording.name[:LONGEST_ORIGIN],
        },
        context={"joints": arm.joints},
    )
    residual = _residual(trajectory, recording, arm.joints)
    return Reference(
        trajectory,
        np.sqrt(np.mean(residual**2, axis=0)),
        np.abs(residual).max(axis=0),
        recording.duration,
        (*remarks, *over_limits(trajectory, arm)),
    )


def _thinned(time: Array, q: Array) -> tuple[Array, Array]:
    """Return a recording with fewer rows: means of neighbours, the ends as they are."""
    each = ceil(len(time) / _MOST_ROWS)
    if each == 1:
        return time, q
    count = len(time) // each * each
    mean_time = time[:count].reshape(-1, each).mean(axis=1)
    mean_q = q[:count].reshape(-1, each, q.shape[1]).mean(axis=1)
    return np.append(mean_time, time[-1]), np.vstack([mean_q, q[-1:]])


def _motion_at_end(time: Array, q: Array) -> tuple[Array, Array]:
    """Return v [rad/s] and a [rad/s^2] at the end, of a cubic through the last rows."""
    begin = min(int(np.searchsorted(time, time[-1] - _LAST)), len(time) - _FEWEST_LAST)
    cubic = np.polynomial.polynomial.polyfit(time[begin:] - time[-1], q[begin:], 3)
    return np.asarray(cubic[1]), np.asarray(2.0 * cubic[2])


def _with_stop(time: Array, q: Array, speed: Array, bend: Array) -> tuple[Array, Array]:
    """Return a recording with rows behind its end, along which it comes to rest.

    Speed and acceleration go to 0 along a cubic, Hermite's between v, a and rest.
    """
    count = max(_FEWEST_LAST, ceil(STOP / float(np.median(np.diff(time)))))
    u = (np.arange(1, count + 1) / count)[:, None]
    from_speed = STOP * (u - u**3 + 0.5 * u**4)
    from_bend = STOP**2 * (0.5 * u**2 - 2.0 / 3.0 * u**3 + 0.25 * u**4)
    way = from_speed * speed + from_bend * bend
    return np.append(time, time[-1] + STOP * u[:, 0]), np.vstack([q, q[-1] + way])


def _sufficient(time: Array, q: Array, most: int) -> Smoothed:
    """Return the spline with the fewest waypoints that foretells rows as well as any."""
    length, counts, intervals = float(time[-1]), [], min(_FIRST, most)
    while intervals < most:
        counts.append(intervals)
        intervals *= 2
    # All of them: a spline that is too coarse for a motion comes no closer with twice its knots.
    tried = []
    for count in (*counts, most):
        spacing = _rounded_up(length / count)
        found = smooth(time, q, ceil(length / spacing - 1e-9) + 1, spacing)
        if (found.validated <= _CLOSE).all():
            return found
        tried.append(found)
    bound = _NO_CLOSER * np.min([found.validated for found in tried], axis=0)
    bound = np.maximum(bound, _CLOSE)
    return next(
        (found for found in tried if (found.validated <= bound).all()),
        min(tried, key=lambda found: float(found.validated.sum())),
    )


def _rounded_up(spacing: float) -> float:
    """Return a spacing of whole 10 us that is not shorter."""
    return ceil(1e5 * spacing - 1e-6) / 1e5


def _residual(trajectory: RecordedTrajectory, recording: Recording, joints: int) -> Array:
    """Return rows minus the motion as it is written. Shape (m, n)."""
    return np.asarray(recording.q - motion_at(trajectory, recording.time, joints)[0])


def motion_at(
    trajectory: RecordedTrajectory, time: Array, joints: int
) -> tuple[Array, Array, Array]:
    """Return q_d [rad], v_d [rad/s] and a_d [rad/s^2] at times in [s]. Shapes (m, n)."""
    from scipy.interpolate import BPoly  # here, because it takes long to import

    samples = recorded_samples(trajectory, joints)
    stops = trajectory.spacing * np.arange(len(samples))
    spline = BPoly.from_derivatives(stops, samples)
    inside = np.clip(time, 0.0, stops[-1])
    held = (time < 0.0) | (time > stops[-1])
    v, a = spline(inside, 1), spline(inside, 2)
    v[held], a[held] = 0.0, 0.0
    return spline(inside), v, a


def over_limits(trajectory: RecordedTrajectory, arm: KnownArm) -> list[str]:
    """Return in words where a motion exceeds the arm's limits of angle and velocity."""
    numbers = pack_trajectory(trajectory, joints=arm.joints)
    count = int(numbers[2])
    time = np.linspace(0.0, float(numbers[1]), _FINE * count + 1)
    q, v, _ = motion_at(trajectory, time, arm.joints)
    model, said = arm.model, []
    slack = 10.0**-DECIMALS
    for joint, name in enumerate(list(model.names)[1:]):
        low, high = model.lowerPositionLimit[joint], model.upperPositionLimit[joint]
        beyond = np.maximum(q[:, joint] - high, low - q[:, joint])
        at = int(np.argmax(beyond))
        if beyond[at] > slack:
            said.append(
                f"{name} is at {q[at, joint]:.4g} after {time[at]:.3g} s, its limits are "
                f"{low:.4g} to {high:.4g}"
            )
        fastest = int(np.argmax(np.abs(v[:, joint])))
        limit = model.velocityLimit[joint]
        if abs(v[fastest, joint]) > limit + slack:
            said.append(
                f"{name} moves at {abs(v[fastest, joint]):.4g} per s after {time[fastest]:.3g} s, "
                f"its limit is {limit:.4g}"
            )
    return said
