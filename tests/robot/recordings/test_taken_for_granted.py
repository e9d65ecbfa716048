"""What headers leave open is told, or refused where it may be either: units, and whose column."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slidetune.robot.arm.known import KnownArm, arm_named
from slidetune.robot.recordings.recording import Wanted, read_recording
from slidetune.robot.recordings.refused import RecordingError
from tests.robot.recordings.files import swing, table

Q = [f"q{number}" for number in range(1, 7)]
BESIDE = [f"{name}{number}" for name in ("v", "tau", "i") for number in range(1, 7)]


@pytest.fixture(scope="module")
def arm() -> KnownArm:
    return arm_named("jaka_zu5")


def test_units_that_no_header_has_are_told(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    path = table(tmp_path / "a.csv", ["t", *Q, *BESIDE], [time, q, q, q, q])
    assert read_recording(path, arm).remarks == (
        "taken where no unit is given: angles as rad, velocities as rad/s, torques as N·m, "
        "currents as A",
    )
    units = [f"{name} [deg]" for name in Q], [f"{name} [deg/s]" for name in BESIDE[:6]]
    path = table(tmp_path / "b.csv", ["t", *units[0], *units[1], *BESIDE[6:12]], [time, q, q, q])
    assert read_recording(path, arm).remarks == ("taken where no unit is given: torques as N·m",)
    # What is left out has no unit.
    path = table(tmp_path / "c.csv", ["t", *Q, *BESIDE[6:12]], [time, q, np.full((200, 6), np.nan)])
    assert read_recording(path, arm).remarks == ("taken where no unit is given: angles as rad",)


def test_angles_in_degrees_have_velocities_in_degrees_a_second(
    tmp_path: Path, arm: KnownArm
) -> None:
    time, q = swing()
    v = np.gradient(q, time, axis=0)
    blocks = [time, np.degrees(q), np.degrees(v)]
    path = table(tmp_path / "a.csv", ["t", *Q, *BESIDE[:6]], blocks)
    found = read_recording(path, arm, Wanted(angles="deg"))
    np.testing.assert_allclose(found.q, q, rtol=1e-12)
    assert found.v is not None
    np.testing.assert_allclose(found.v, v, rtol=1e-12)
    assert found.remarks == ("taken where no unit is given: velocities as deg/s",)
    names = ["t", *Q, *(f"{name} [rad/s]" for name in BESIDE[:6])]
    found = read_recording(table(tmp_path / "b.csv", names, blocks), arm, Wanted(angles="deg"))
    assert found.v is not None
    np.testing.assert_array_equal(found.v, np.degrees(v))
    assert not found.remarks


def test_columns_of_joints_that_the_arm_lacks_are_named(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    names = ["t", *Q, "q7", "q8", *BESIDE[:6], "v7"]
    path = table(tmp_path / "a.csv", names, [time, q, q[:, :2], q, q[:, 0]])
    found = read_recording(path, arm)
    np.testing.assert_array_equal(found.q, q)
    assert "not used, as the arm has 6 joints: q7, q8, v7" in found.remarks
    names = ["t", *(f"q{number}" for number in range(8))]
    found = read_recording(table(tmp_path / "b.csv", names, [time, q, q[:, :2]]), arm)
    np.testing.assert_array_equal(found.q, q)
    assert "not used, as the arm has 6 joints: q6, q7" in found.remarks


def test_one_column_more_from_0_on_is_no_guess(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    names = ["t", *(f"q{number}" for number in range(7))]
    path = table(tmp_path / "a.csv", names, [time, q[:, 0] + 1.0, q])
    with pytest.raises(RecordingError, match="the first or the last may be the one too many"):
        read_recording(path, arm)
    for first in (0, 1):
        mapping = {f"joint_{joint + 1}": f"q{joint + first}" for joint in range(6)}
        found = read_recording(path, arm, Wanted(mapping))
        expected = q if first else np.column_stack([q[:, 0] + 1.0, q[:, :5]])
        np.testing.assert_array_equal(found.q, expected)
