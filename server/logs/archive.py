"""A recording as a file of plain arrays, which is read again in a few milliseconds."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from slidetune.robot.recordings.recording import Recording

_ARRAYS = ("time", "q", "v", "tau", "current", "q_d", "v_d")


def save_recording(path: Path, recording: Recording) -> None:
    """Write a recording.

    Raises:
        OSError: if there is no room for it.
    """
    rest = {
        "name": recording.name,
        "measured": recording.measured,
        "remarks": list(recording.remarks),
    }
    arrays = {name: getattr(recording, name) for name in _ARRAYS}
    there = {name: array for name, array in arrays.items() if array is not None}
    np.savez(path, allow_pickle=False, rest=np.array(json.dumps(rest)), **there)


def load_recording(path: Path) -> Recording:
    """Read what ``save_recording`` wrote."""
    with np.load(path, allow_pickle=False) as file:
        rest = json.loads(str(file["rest"]))
        arrays = {name: file[name] for name in _ARRAYS if name in file}
    return Recording(
        name=rest["name"], measured=rest["measured"], remarks=tuple(rest["remarks"]), **arrays
    )
