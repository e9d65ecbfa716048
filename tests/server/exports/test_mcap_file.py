"""MCAP as its own reader reads it."""

from __future__ import annotations

import io
import json
from collections import defaultdict
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from slidetune.robot.arm.description import URDF_PATH
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.exports.mcap_file import mcap_of
from slidetune.server.exports.recorded_run import recorded_run
from tests.server.exports.exported import short_experiment

Messages = dict[str, list[tuple[int, Any]]]


def read(content: bytes) -> Messages:
    """Messages by topic, each with its stamp in [ns]."""
    found: Messages = defaultdict(list)
    reader = make_reader(io.BytesIO(content), decoder_factories=[DecoderFactory()])
    for _, channel, message, decoded in reader.iter_decoded_messages():
        assert message.log_time == message.publish_time
        found[channel.topic].append((message.log_time, decoded))
    return found


@pytest.fixture(scope="module")
def run() -> Run:
    return simulate(short_experiment(), estimate=False)


@pytest.fixture(scope="module")
def messages(run: Run) -> Messages:
    return read(mcap_of(recorded_run(run)))


def test_joint_states_are_the_rows_to_the_last_bit(run: Run, messages: Messages) -> None:
    lane, states = run.lanes["Lane 1"], messages["/lane_1/joint_states"]
    assert [stamp for stamp, _ in states] == np.rint(run.time * 1e9).astype(int).tolist()
    for stamp, state in states:
        assert state.header.stamp.sec * 10**9 + state.header.stamp.nanosec == stamp
        assert state.name == [f"joint_{number}" for number in range(1, 7)]
    for field, values in (("position", lane.q), ("velocity", lane.v), ("effort", lane.tau)):
        assert np.array_equal([getattr(state, field) for _, state in states], values)
    desired = [state.position for _, state in messages["/desired/joint_states"]]
    assert np.array_equal(desired, run.q_d)
    errors = [numbers.data for _, numbers in messages["/lane_1/error"]]
    assert np.array_equal(errors, lane.e)


def test_poses_are_those_of_the_raw_description(run: Run, messages: Messages) -> None:
    model = pin.buildModelFromUrdf(str(URDF_PATH))
    data, frame = model.createData(), model.getFrameId("flange_link")
    poses = messages["/lane_1/flange"]
    lane = run.lanes["Lane 1"]
    for (_, pose), q, flange in zip(poses, lane.q, lane.flange, strict=True):
        pin.framesForwardKinematics(model, data, q)
        place, turn = pose.pose.position, pose.pose.orientation
        assert np.allclose([place.x, place.y, place.z], flange, rtol=0.0, atol=1e-12)
        assert np.allclose([place.x, place.y, place.z], data.oMf[frame].translation, atol=1e-12)
        rotation = pin.Quaternion(turn.w, turn.x, turn.y, turn.z).matrix()
        assert np.allclose(rotation, data.oMf[frame].rotation, rtol=0.0, atol=1e-12)


def test_a_lane_that_left_its_bounds_ends_there_and_says_why(run: Run, messages: Messages) -> None:
    lane = run.lanes["lane-1"]
    assert lane.freeze is not None
    rows = int(np.isfinite(lane.q[:, 0]).sum())
    assert 0 < rows < len(run.time)
    assert len(messages["/lane_1_2/joint_states"]) == rows
    ((stamp, remark),) = messages["/lane_1_2/remark"]
    assert stamp == round(lane.freeze.time * 1e9)
    assert remark.data == lane.freeze.cause
    assert "/lane_1/remark" not in messages


def test_the_experiment_and_the_gains_are_in_it(run: Run, messages: Messages) -> None:
    ((_, text),) = messages["/experiment"]
    assert experiment_from_yaml(text.data.encode()) == run.experiment
    ((_, gains),) = messages["/lane_1/gains"]
    assert json.loads(gains.data) == run.experiment.document()["lanes"]["Lane 1"]


def test_another_arm_has_a_limit_of_its_own_for_each_joint() -> None:
    lanes = {"A": {"law": "computed_torque"}}
    robot = {"model": "two_links", "torque_limit": [60.0, 25.0]}
    simulation = {"mode": "sampled", "horizon": 0.1}
    document = {"robot": robot, "lanes": lanes, "simulation": simulation}
    run = simulate(Experiment.from_document(document), estimate=False)
    messages = read(mcap_of(recorded_run(run)))
    places = [pose.pose.position for _, pose in messages["/a/flange"]]
    flange = [[place.x, place.y, place.z] for place in places]
    assert np.allclose(flange, run.lanes["A"].flange, rtol=0.0, atol=1e-12)
    assert len(messages["/a/joint_states"][0][1].effort) == 2
