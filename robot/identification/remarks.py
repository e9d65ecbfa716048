"""What is doubtful about a log and its fit, in words."""

from __future__ import annotations

import numpy as np

from slidetune.robot.recordings.recording import Recording

Array = np.ndarray

_FALLS_SHORT = 0.9
"""Share of the torque that has to be explained, or a remark says so (*ours*)."""


def remarks_on(
    recording: Recording, whole: Array, left: Array, late: tuple[float, float]
) -> tuple[str, ...]:
    """Return the remarks.

    Args:
        recording: the log, with remarks of its own.
        whole: effective torque of each joint in [N m]. Shape (n,).
        left: effective torque that the fit leaves in [N m]. Shape (n,).
        late: by how much torques were shifted, and half its 95 % interval, in [s].
    """
    remarks = list(recording.remarks)
    delay, half = (1e3 * one for one in late)
    if delay:
        later = "later" if delay > 0.0 else "earlier"
        remarks.append(
            f"torques act {abs(delay):.2f} ± {half:.2f} ms {later} than the log has them (a hold "
            "by half a control period, a delay, drives): they were shifted by that"
        )
    for joint, (torque, residual) in enumerate(zip(whole, left, strict=True)):
        explained = 1.0 - (residual / torque) ** 2 if torque > 0.0 else 1.0
        if explained < _FALLS_SHORT:
            remarks.append(
                f"joint {joint + 1}: {explained:.0%} of the torque is explained: another arm or "
                "inertials, a sign, a unit, or a torque constant?"
            )
    return tuple(remarks)
