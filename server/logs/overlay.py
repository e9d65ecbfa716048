"""A log beside the lanes: its curves and figures as those of a response."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from slidetune.robot.experiment.packed import Packed
from slidetune.robot.logs.measured import MeasuredLane, measured_lane
from slidetune.robot.loop.response import Response, thinned
from slidetune.robot.recordings.recording import Recording
from slidetune.server.logs.archive import load_recording

Array = np.ndarray

_MOST_SOUGHT = 20_000
"""Rows among which a shift is sought (*ours*): of a million it would take minutes."""
_SLACK = 1e-9
_NO_ACCURACY = {
    "error_estimate": None,
    "unconverged": 0,
    "capped": 0,
    "at_least": False,
    "remark": "",
    "patch": None,
}
"""Nothing was integrated."""


@dataclass(frozen=True)
class Overlay:
    """What the plots show of a log.

    Attributes:
        response: over the horizon of the experiment; its surface is NaN, as a log has no law.
        shift: what was added to the log's time in [s].
        rms: effective difference of the angles at a shift that was found in [rad]; ``None`` where
            it was given.
        others: shifts that fit as well in [s].
        against: whose desired motion makes the error: the experiment's, or the log's own.
        begin: first time at which the log has a row within the horizon in [s].
        end: last such time in [s].
        remarks: what was assumed, in words.
    """

    response: Response
    shift: float
    rms: float | None
    others: tuple[float, ...]
    against: str
    begin: float
    end: float
    remarks: tuple[str, ...]

    def head(self) -> dict[str, Any]:
        """Return all but the curves as plain JSON values."""
        return {
            "shift": self.shift,
            "rms": self.rms,
            "others": list(self.others),
            "against": self.against,
            "begin": self.begin,
            "end": self.end,
            "remarks": list(self.remarks),
        }


def overlay_of(
    archive: Path, packed: Packed, shift: float | None, stop: Array | None = None
) -> Overlay:
    """Return a log as it is shown beside the lanes of an experiment.

    Args:
        archive: what ``save_recording`` wrote.
        packed: the experiment as numbers.
        shift: what is added to the log's time in [s]; found where none is given.
        stop: set by another thread where nobody waits any more; it takes too short to look.

    Raises:
        RecordingError: if the log has no measured angles, or no shift can be found.
    """
    recording = load_recording(archive)
    rms: float | None = None
    others: tuple[float, ...] = ()
    said: tuple[str, ...] = ()
    if shift is None:
        found = measured_lane(_fewer(recording), packed)
        shift, rms, others = found.shift.seconds, found.shift.rms, found.shift.others
        said = tuple(one for one in found.remarks if one not in recording.remarks)
    lane = measured_lane(recording, packed, shift)
    remarks = [*lane.remarks, *(one for one in said if one not in lane.remarks)]
    horizon = packed.experiment.simulation.horizon
    first, last = np.searchsorted(lane.time, [-_SLACK, horizon + _SLACK])
    if last - first < 2:
        remarks.append(f"at this shift the log has no rows between 0 and {horizon:g} s")
        first, last = 0, 0
    time = lane.time[first:last]
    return Overlay(
        response=_response(lane, slice(first, last), horizon),
        shift=shift,
        rms=rms,
        others=others,
        against=lane.against,
        begin=float(time[0]) if len(time) else 0.0,
        end=float(time[-1]) if len(time) else 0.0,
        remarks=tuple(remarks),
    )


def _fewer(recording: Recording) -> Recording:
    """Return every so manieth row of a long recording, for the search of its shift alone."""
    each = ceil(len(recording.time) / _MOST_SOUGHT)
    if each == 1:
        return recording
    blocks = {name: getattr(recording, name) for name in ("time", "q", "v", "tau", "q_d", "v_d")}
    return replace(
        recording,
        current=None,
        **{name: block[::each] for name, block in blocks.items() if block is not None},
    )


def _response(lane: MeasuredLane, rows: slice, horizon: float) -> Response:
    distance = np.linalg.norm(lane.flange - lane.flange_desired, axis=1)[rows, None]
    surface = np.full_like(lane.e[rows], np.nan)
    table = np.hstack([lane.e[rows], lane.tau[rows], surface, distance])
    time, columns = thinned(lane.time[rows], np.ascontiguousarray(table))
    return Response(
        time=time,
        columns=columns,
        path=np.empty((0, 3)),
        metrics=lane.metrics_between(0.0, horizon).document(),
        frozen=None,
        accuracy=_NO_ACCURACY,
        goals={},
    )
