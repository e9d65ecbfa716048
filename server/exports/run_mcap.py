"""A run as an MCAP file of messages of ROS 2, which Foxglove and PlotJuggler show."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from mcap_ros2.writer import Writer

from slidetune.robot.arm.arm import build_arm
from slidetune.robot.arm.known import arm_named
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.loop.simulate import Run
from slidetune.robot.version import __version__
from slidetune.server.exports.ros_messages import DEFINITIONS

Array = np.ndarray
Tell = Callable[[float], None]

BASE = "base"
"""Frame in which the flange's place is given."""
DESIRED = "desired"
"""Topic of what all lanes follow."""
_SECOND = 1_000_000_000
_UNSUITED = re.compile(r"[^A-Za-z0-9_]+")
_TOLD = 200
"""Rows between two calls that tell the progress (*ours*)."""


class _Track(NamedTuple):
    """What moves: a lane, or what all of them follow; arrays have a row a stamp."""

    topic: str
    q: Array
    v: Array
    tau: Array
    pose: Array
    others: dict[str, Array]


def run_mcap(run: Run, tell: Tell | None = None) -> bytes:
    """Return a run as MCAP, every row of it, from the stamp 0 on.

    Each lane has the topics ``/LANE/joint_states`` (``sensor_msgs/JointState``: positions,
    velocities, torques), ``/LANE/flange`` (``geometry_msgs/PoseStamped``), ``/LANE/error`` and
    ``/LANE/sliding_variable`` (``std_msgs/Float64MultiArray``); ``/desired`` has the first two of
    what all of them follow. ``/experiment`` (``std_msgs/String``) is the experiment as YAML, gains
    included. A lane that left its bounds ends there, and ``/LANE/remark`` says why.

    Args:
        run: what to write.
        tell: called with the share that is done, 0 to 1.
    """
    file = io.BytesIO()
    bag = _Bag(file)
    stamps = np.rint(run.time * _SECOND).astype(np.int64).tolist()
    names = list(arm_named(run.experiment.robot.model).joint_names)
    bag.say("/experiment", stamps[0], experiment_to_yaml(run.experiment))
    tracks = _tracks(run)
    for row, stamp in enumerate(stamps):
        for track in tracks:
            if np.isfinite(track.q[row, 0]):
                bag.write(track, row, stamp, names)
        if tell is not None and row % _TOLD == 0:
            tell(row / len(stamps))
    for track, lane in zip(tracks, run.lanes.values(), strict=False):
        if lane.freeze is not None:
            stamp = round(lane.freeze.time * _SECOND)
            bag.say(f"/{track.topic}/remark", stamp, lane.freeze.cause)
    bag.finish(run.experiment.title)
    return file.getvalue()


class _Bag:
    """An MCAP file that is being written."""

    def __init__(self, file: io.BytesIO) -> None:
        self._writer = Writer(file)
        self._schemas = {
            name: self._writer.register_msgdef(name, text) for name, text in DEFINITIONS.items()
        }

    def finish(self, title: str) -> None:
        self._writer.add_metadata("slidetune", {"version": __version__, "title": title})
        self._writer.finish()  # type: ignore[no-untyped-call]

    def say(self, topic: str, stamp: int, text: str) -> None:
        self._put(topic, "std_msgs/msg/String", stamp, {"data": text})

    def write(self, track: _Track, row: int, stamp: int, names: list[str]) -> None:
        at = {"sec": stamp // _SECOND, "nanosec": stamp % _SECOND}
        state = {
            "header": {"stamp": at, "frame_id": ""},
            "name": names,
            "position": track.q[row].tolist(),
            "velocity": track.v[row].tolist(),
            "effort": track.tau[row].tolist(),
        }
        self._put(f"/{track.topic}/joint_states", "sensor_msgs/msg/JointState", stamp, state)
        x, y, z, *turn = track.pose[row].tolist()
        flange = {
            "header": {"stamp": at, "frame_id": BASE},
            "pose": {
                "position": {"x": x, "y": y, "z": z},
                "orientation": dict(zip("xyzw", turn, strict=True)),
            },
        }
        self._put(f"/{track.topic}/flange", "geometry_msgs/msg/PoseStamped", stamp, flange)
        for what, block in track.others.items():
            numbers = {"layout": {"dim": [], "data_offset": 0}, "data": block[row].tolist()}
            self._put(f"/{track.topic}/{what}", "std_msgs/msg/Float64MultiArray", stamp, numbers)

    def _put(self, topic: str, kind: str, stamp: int, message: dict[str, Any]) -> None:
        self._writer.write_message(topic, self._schemas[kind], message, stamp, stamp)


def _tracks(run: Run) -> list[_Track]:
    """Return the lanes, then what they follow."""
    taken = {DESIRED, "experiment"}
    tracks = []
    for name, lane in run.lanes.items():
        topic = _free(_UNSUITED.sub("_", name).strip("_").lower() or "lane", taken)
        others = {"error": lane.e, "sliding_variable": lane.S}
        pose = _flange_poses(run, lane.q)
        tracks.append(_Track(topic, lane.q, lane.v, lane.tau, pose, others))
    nothing = np.empty((len(run.time), 0))
    pose = _flange_poses(run, run.q_d)
    return [*tracks, _Track(DESIRED, run.q_d, run.v_d, nothing, pose, {})]


def _free(topic: str, taken: set[str]) -> str:
    """Return a topic that no other lane has: names may differ in signs alone."""
    if not topic[0].isalpha():
        topic = f"lane_{topic}"
    number, free = 1, topic
    while free in taken:
        number += 1
        free = f"{topic}_{number}"
    taken.add(free)
    return free


def _flange_poses(run: Run, angles: Array) -> Array:
    """Return x, y, z in [m] and the quaternion x, y, z, w of the flange. Shape (m, 7)."""
    robot = run.experiment.robot
    model = build_arm(robot).model
    data, flange = model.createData(), model.getFrameId(arm_named(robot.model).tip)
    poses = np.full((len(angles), 7), np.nan)
    for row, q in enumerate(angles):
        if np.isfinite(q[0]):
            pin.forwardKinematics(model, data, q)
            poses[row] = pin.SE3ToXYZQUAT(pin.updateFramePlacement(model, data, flange))
    return poses
