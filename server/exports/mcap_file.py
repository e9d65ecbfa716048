"""What is recorded as an MCAP file of messages of ROS 2, which Foxglove and PlotJuggler show."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from mcap_ros2.writer import Writer

from slidetune.robot.arm.arm import build_arm
from slidetune.robot.arm.known import arm_named
from slidetune.robot.arm.section import Robot
from slidetune.robot.experiment.merge_patch import merged_values
from slidetune.robot.version import __version__
from slidetune.server.exports.recorded import Recorded
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


class _Words(NamedTuple):
    """A text, and when it is said."""

    time: float
    topic: str
    text: str


def mcap_of(recorded: Recorded, tell: Tell | None = None) -> bytes:
    """Return what is recorded as MCAP, every row of it, stamped with simulated time.

    Each lane has the topics ``/LANE/joint_states`` (``sensor_msgs/JointState``: positions,
    velocities, torques), ``/LANE/flange`` (``geometry_msgs/PoseStamped``), ``/LANE/error`` and
    ``/LANE/sliding_variable`` (``std_msgs/Float64MultiArray``); ``/desired`` has the first two of
    what all of them follow. As ``std_msgs/String``: ``/experiment``, the experiment at the first
    row as YAML; ``/edits``, every edit as JSON; ``/LANE/gains``, its gains as JSON, at the first
    row and wherever an edit has changed them; ``/LANE/remark``, why it stood still. While a lane
    stands still it sends nothing.

    Args:
        recorded: what to write.
        tell: called with the share that is done, 0 to 1.
    """
    file = io.BytesIO()
    bag = _Bag(file)
    stamps = np.rint(recorded.time * _SECOND).astype(np.int64).tolist()
    names = list(arm_named(recorded.arm).joint_names)
    tracks = _tracks(recorded)
    topics = dict(zip(recorded.lanes, (track.topic for track in tracks), strict=False))
    words = sorted(_words(recorded, topics), key=lambda one: one.time)
    for row, (time, stamp) in enumerate(zip(recorded.time.tolist(), stamps, strict=True)):
        while words and words[0].time <= time:
            bag.say(words.pop(0), stamp)
        for track in tracks:
            if np.isfinite(track.q[row, 0]):
                bag.write(track, row, stamp, names)
        if tell is not None and row % _TOLD == 0:
            tell(row / len(stamps))
    for said in words:
        bag.say(said, stamps[-1])
    bag.finish(str(recorded.experiment["title"]))
    return file.getvalue()


def _words(recorded: Recorded, topics: Mapping[str, str]) -> Iterator[_Words]:
    """Yield what is said in words, each topic in order."""
    begin, document = float(recorded.time[0]), recorded.experiment
    yield _Words(begin, "/experiment", recorded.yaml)
    for name, topic in topics.items():
        yield _Words(begin, f"/{topic}/gains", _json(document["lanes"][name]))
    for edit in recorded.edits:
        yield _Words(edit.time, "/edits", _json(edit.content))
        before, document = document, merged_values(document, edit.content["patch"])
        for name, topic in topics.items():
            if (gains := document["lanes"][name]) != before["lanes"][name]:
                yield _Words(edit.time, f"/{topic}/gains", _json(gains))
    for said in recorded.remarks:
        yield _Words(said.time, f"/{topics[said.topic]}/remark", said.content["remark"])


def _json(content: Mapping[str, Any]) -> str:
    return json.dumps(content, ensure_ascii=False, allow_nan=False)


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

    def say(self, words: _Words, stamp: int) -> None:
        self._put(words.topic, "std_msgs/msg/String", stamp, {"data": words.text})

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


def _tracks(recorded: Recorded) -> list[_Track]:
    """Return the lanes, then what they follow."""
    poses = _Poses(recorded)
    taken = {DESIRED, "experiment", "edits"}
    tracks = []
    for name, lane in recorded.lanes.items():
        topic = _free(_UNSUITED.sub("_", name).strip("_").lower() or "lane", taken)
        others = {"error": lane["e"], "sliding_variable": lane["S"]}
        pose = poses.of(lane["q"])
        tracks.append(_Track(topic, lane["q"], lane["v"], lane["tau"], pose, others))
    nothing = np.empty((len(recorded.time), 0))
    q_d, v_d = recorded.desired["q_d"], recorded.desired["v_d"]
    return [*tracks, _Track(DESIRED, q_d, v_d, nothing, poses.of(q_d), {})]


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


class _Poses:
    """Where the flange is."""

    def __init__(self, recorded: Recorded) -> None:
        arm = arm_named(recorded.arm)
        known = {"joints": arm.joints}
        robot = Robot.model_validate(recorded.experiment["robot"], context=known)
        self._model = build_arm(robot).model
        self._flange = self._model.getFrameId(arm.tip)

    def of(self, angles: Array) -> Array:
        """Return x, y, z in [m] and the quaternion x, y, z, w at each row. Shape (n, 7)."""
        model, data = self._model, self._model.createData()
        poses = np.full((len(angles), 7), np.nan)
        for row, q in enumerate(angles):
            if np.isfinite(q[0]):
                pin.forwardKinematics(model, data, q)
                poses[row] = pin.SE3ToXYZQUAT(pin.updateFramePlacement(model, data, self._flange))
        return poses
