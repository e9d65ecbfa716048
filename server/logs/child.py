"""The process in which a log is read, smoothed or fitted.

A file of 200 MB takes half a minute, and a damaged one may take more than it should: the live
session is not kept waiting for it, and whatever becomes of it is lost with this process alone.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from slidetune.robot.arm.known import KnownArm, arm_named
from slidetune.robot.arm.section import Robot
from slidetune.robot.identification.identify import Identification, identify
from slidetune.robot.loop.response import thinned
from slidetune.robot.recordings.headers import ANGLE, TORQUE, Meaning, meaning_of
from slidetune.robot.recordings.matching import TIME
from slidetune.robot.recordings.recording import Recording, Wanted, columns_of, read_recording
from slidetune.robot.recordings.reference import over_limits, reference_of
from slidetune.robot.recordings.refused import RecordingError
from slidetune.robot.recordings.stamps import clock_of
from slidetune.server.compute.apart import answer_once
from slidetune.server.logs.archive import load_recording, save_recording

Asked = dict[str, Any]
_BUCKETS = 250
"""Pieces of a curve, of two points each (*ours*)."""


def answered(asked: Asked) -> dict[str, Any]:
    """Answer one question about a log; see ``server.logs.work_apart``."""
    kinds = {"read": _read, "trajectory": _trajectory, "identify": _identify}
    try:
        return kinds[asked["kind"]](asked)
    except RecordingError as error:
        return {"refused": _told(error)}


def _told(error: RecordingError) -> dict[str, Any]:
    return {"message": str(error), "row": error.row, "column": error.column, "value": error.value}


def _read(asked: Asked) -> dict[str, Any]:
    """Read a file and keep its numbers; where it is refused say what may be said to it in turn."""
    path, wanted = Path(asked["path"]), Wanted(**asked["wanted"])
    arm = arm_named(asked["arm"])
    joints = list(arm.model.names)[1:]
    report: dict[str, Any] = {"columns": [], "sources": [], "joints": joints, "mapping": {}}
    try:
        report["columns"] = list(columns_of(path, wanted.source))
    except RecordingError as error:
        if not error.names:
            raise
        return {**report, "sources": list(error.names), "reason": _told(error)}
    report["mapping"] = _mapping(report["columns"], joints) | dict(wanted.mapping)
    try:
        recording = read_recording(path, arm, wanted)
    except RecordingError as error:
        sources = [name for name in error.names if name not in report["columns"]]
        return {**report, "sources": sources, "reason": _told(error)}
    save_recording(Path(asked["archive"]), recording)
    return {**report, "log": _summary(recording)}


def _summary(recording: Recording) -> dict[str, Any]:
    parts = {
        "angles": recording.q if recording.measured else None,
        "velocities": recording.v,
        "torques": recording.tau,
        "currents": recording.current,
        "desired angles": recording.q_d,
    }
    return {
        "name": recording.name,
        "rows": len(recording.time),
        "duration": recording.duration,
        "rate": 1.0 / recording.period,
        "holds": [name for name, block in parts.items() if block is not None],
        "remarks": list(recording.remarks),
    }


def _mapping(columns: list[str], joints: list[str]) -> dict[str, str]:
    """Return which columns are time, angles and torques as far as their headers are clear."""
    found = [meaning_of(name, joints) for name in columns]
    mapping: dict[str, str] = {}
    twice: set[str] = set()
    with suppress(RecordingError):
        mapping[TIME] = columns[clock_of(columns, {}).columns[0]]
    for quantity, ending in ((ANGLE, ""), (TORQUE, ".torque")):
        fitting = [
            (name, meaning)
            for name, meaning in zip(columns, found, strict=True)
            if meaning is not None and meaning.quantity == quantity and not meaning.reference
        ]
        begin = 0 if any(meaning.index == 0 for _, meaning in fitting) else 1
        for name, meaning in fitting:
            joint = _joint(meaning, begin)
            if joint is None or joint >= len(joints):
                continue
            key = f"{joint + 1}{ending}"
            twice |= {key} & mapping.keys()
            mapping[key] = name
    return {key: name for key, name in mapping.items() if key not in twice}


def _joint(meaning: Meaning, begin: int) -> int | None:
    return meaning.joint if meaning.index is None else meaning.index - begin


def _trajectory(asked: Asked) -> dict[str, Any]:
    arm = arm_named(asked["arm"])
    found = reference_of(load_recording(Path(asked["archive"])), arm, asked["spacing"])
    limits = over_limits(found.trajectory, arm)
    return {
        "patch": found.patch(),
        "spacing": found.trajectory.spacing,
        "waypoints": len(found.trajectory.waypoints.splitlines()),
        "duration": found.duration,
        "rms": found.rms.tolist(),
        "greatest": found.greatest.tolist(),
        "limits": limits,
        "remarks": [remark for remark in found.remarks if remark not in limits],
    }


def _identify(asked: Asked) -> dict[str, Any]:
    arm: KnownArm = arm_named(asked["arm"])
    robot = Robot.model_validate(asked["robot"], context={"joints": arm.joints})
    recording = load_recording(Path(asked["archive"]))
    found = identify(recording, robot, asked["parts"], asked["constants"], load=asked["load"])
    return {
        "estimates": [
            {
                "path": one.path,
                "title": one.title,
                "unit": one.unit,
                "present": one.present,
                "value": one.value,
                "low": one.low,
                "high": one.high,
                "told": one.told,
                "reason": one.reason,
            }
            for one in found.estimates
        ],
        "patch": found.patch,
        "rms_torque": found.rms_torque.tolist(),
        "rms_residual": found.rms_residual.tolist(),
        "bandwidth": found.bandwidth,
        "remarks": list(found.remarks),
        **_curves(found),
    }


def _curves(found: Identification) -> dict[str, Any]:
    """Return measured torque and residual, thinned to their extremes."""
    both = np.concatenate([found.torque, found.residual], axis=1)
    time, columns = thinned(found.time, both, _BUCKETS)
    joints = found.torque.shape[1]
    return {
        "time": np.round(time, 5).tolist(),
        "torque": np.round(columns[:joints], 6).tolist(),
        "residual": np.round(columns[joints:], 6).tolist(),
    }


if __name__ == "__main__":
    answer_once(answered)
