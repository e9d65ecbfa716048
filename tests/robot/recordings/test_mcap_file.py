"""Joint states of ROS 2 in MCAP files; damaged and hostile ones are refused."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import zstandard
from mcap.writer import CompressionType
from mcap.writer import Writer as PlainWriter

from slidetune.robot.arm.known import KnownArm, arm_named
from slidetune.robot.recordings.recording import Wanted, columns_of, read_recording
from slidetune.robot.recordings.refused import RecordingError
from tests.robot.recordings.files import JOINT_STATE, NAMES, joint_states, messages, swing

Array = np.ndarray


@pytest.fixture(scope="module")
def arm() -> KnownArm:
    return arm_named("jaka_zu5")


def said(path: Path, arm: KnownArm, wanted: Wanted | None = None) -> str:
    with pytest.raises(RecordingError) as caught:
        read_recording(path, arm, wanted)
    return str(caught.value)


@pytest.mark.parametrize("stamped", [True, False])
def test_joint_states_are_read_by_the_names_of_joints(
    tmp_path: Path, arm: KnownArm, stamped: bool
) -> None:
    time, q = swing()
    order = [3, 0, 5, 1, 4, 2]
    names = [NAMES[joint] for joint in order]
    rows = messages(names, q[:, order], velocity=2.0 * q[:, order], effort=3.0 * q[:, order])
    path = joint_states(tmp_path / "a.mcap", {"/joint_states": rows}, stamped=stamped)
    found = read_recording(path, arm)
    np.testing.assert_array_equal(found.q, q)
    np.testing.assert_array_equal(found.v, 2.0 * q)
    np.testing.assert_array_equal(found.tau, 3.0 * q)
    np.testing.assert_allclose(found.time, time, atol=1e-9)


def test_without_names_the_order_counts(tmp_path: Path, arm: KnownArm) -> None:
    _, q = swing()
    path = joint_states(tmp_path / "a.mcap", {"/joint_states": messages([], q)})
    found = read_recording(path, arm)
    np.testing.assert_array_equal(found.q, q)
    assert found.v is None
    assert found.tau is None


def test_messages_of_a_gripper_between_them_are_left_out(tmp_path: Path, arm: KnownArm) -> None:
    _, q = swing()
    rows = messages(NAMES, q)
    for place in range(0, 400, 2):
        rows.insert(
            place + 1, {"name": ["finger"], "position": [0.1], "velocity": [], "effort": []}
        )
    found = read_recording(joint_states(tmp_path / "a.mcap", {"/joint_states": rows}), arm)
    np.testing.assert_array_equal(found.q, q)
    assert any("200 messages without all joints" in remark for remark in found.remarks)


def test_several_topics_are_told_and_one_is_chosen(tmp_path: Path, arm: KnownArm) -> None:
    _, q = swing()
    topics = {"/left/joint_states": messages(NAMES, q), "/right/joint_states": messages(NAMES, -q)}
    path = joint_states(tmp_path / "a.mcap", topics)
    assert "/left/joint_states, /right/joint_states" in said(path, arm)
    assert "/right" in said(path, arm, Wanted(source="/middle"))
    found = read_recording(path, arm, Wanted(source="/right/joint_states"))
    np.testing.assert_array_equal(found.q, -q)


def test_other_joints_are_listed_and_can_be_mapped(tmp_path: Path, arm: KnownArm) -> None:
    _, q = swing()
    names = ["base", "shoulder", "elbow", "roll", "pitch", "yaw"]
    path = joint_states(tmp_path / "a.mcap", {"/joint_states": messages(names, q)})
    text = said(path, arm)
    assert "shoulder/position" in text
    assert columns_of(path)[:2] == ("time [ns]", "base/position")
    mapping = {f"joint_{n}": f"{name}/position" for n, name in enumerate(names, 1)}
    np.testing.assert_array_equal(read_recording(path, arm, Wanted(mapping)).q, q)


def test_stamps_that_fall_are_refused(tmp_path: Path, arm: KnownArm) -> None:
    _, q = swing()
    rows = messages(NAMES, q)
    path = joint_states(tmp_path / "a.mcap", {"/joint_states": rows}, period=-10_000_000)
    text = said(path, arm)
    assert "row 2" in text
    assert "time falls" in text


def test_a_file_without_joint_states_lists_its_topics(tmp_path: Path, arm: KnownArm) -> None:
    assert "/said (std_msgs/msg/String)" in said(joint_states(tmp_path / "a.mcap", {}), arm)


def test_every_cut_of_a_file_is_refused_or_read(tmp_path: Path, arm: KnownArm) -> None:
    _, q = swing(40)
    path = joint_states(tmp_path / "a.mcap", {"/joint_states": messages(NAMES, q)})
    content = path.read_bytes()
    cut = tmp_path / "b.mcap"
    for length in range(9, len(content), 97):
        cut.write_bytes(content[:length])
        assert "b.mcap: " in said(cut, arm)


@pytest.mark.parametrize("seed", range(60))
def test_damaged_bytes_end_in_words(tmp_path: Path, arm: KnownArm, seed: int) -> None:
    _, q = swing(40)
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = PlainWriter(file, compression=CompressionType.NONE)
        writer.start()
        schema = writer.register_schema(
            "sensor_msgs/msg/JointState", "ros2msg", JOINT_STATE.encode()
        )
        channel = writer.register_channel("/joint_states", "cdr", schema)
        for number, row in enumerate(q):
            body = struct.pack("<4xiII", 1 + number, 0, 1) + b"\0" + b"\0" * 3
            body += struct.pack("<I", 0) + struct.pack("<I", 6) + b"\0" * 4
            body += struct.pack("<6d", *row) + struct.pack("<II", 0, 0)
            writer.add_message(channel, number * 10_000_000, body, number * 10_000_000)
        writer.finish()
    content = bytearray(path.read_bytes())
    random = np.random.default_rng(seed)
    for place in random.integers(8, len(content), 1 + seed % 5):
        content[place] = int(random.integers(0, 256))
    path.write_bytes(bytes(content))
    text = "a.mcap: "
    try:
        read_recording(path, arm)
    except RecordingError as error:
        text = str(error)
    assert text.startswith("a.mcap: ")


def chunked(path: Path, compression: str, data: bytes, size: int) -> Path:
    """Write a file of one chunk that says of itself what it likes."""
    head = struct.pack("<QQQI", 0, 0, size, 0) + struct.pack("<I", len(compression))
    body = head + compression.encode() + struct.pack("<Q", len(data)) + data
    magic = b"\x89MCAP0\r\n"
    header = struct.pack("<BQ", 1, 8) + b"\0" * 8
    path.write_bytes(magic + header + struct.pack("<BQ", 6, len(body)) + body)
    return path


@pytest.mark.parametrize("size", [1000, 2**24, 2**60])
def test_a_chunk_without_end_is_not_unpacked(tmp_path: Path, arm: KnownArm, size: int) -> None:
    bomb = zstandard.ZstdCompressor(level=1).compress(b"\0" * 2**27)
    text = said(chunked(tmp_path / "a.mcap", "zstd", bomb, size), arm)
    assert "chunk" in text
    assert "chunk" in said(chunked(tmp_path / "b.mcap", "", b"\0" * 20, size), arm)
    assert "'brotli'" in said(chunked(tmp_path / "c.mcap", "brotli", b"", 0), arm)


def test_whole_files_are_bounded(
    tmp_path: Path, arm: KnownArm, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, q = swing()
    path = joint_states(tmp_path / "a.mcap", {"/joint_states": messages(NAMES, q)})
    monkeypatch.setattr("slidetune.robot.recordings.mcap_file._LARGEST_WHOLE", 1000)
    assert "unpacks to more" in said(path, arm)
    monkeypatch.undo()
    monkeypatch.setattr("slidetune.robot.recordings.mcap_file.MOST_ROWS", 10)
    assert "more than 10 messages" in said(path, arm)
