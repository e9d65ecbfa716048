"""Files become recordings; bad ones are refused with row, column and a way out."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from slidetune.robot.arm.known import KnownArm, arm_named
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.recordings.limits import LARGEST_FILE, MOST_ROWS
from slidetune.robot.recordings.recording import Wanted, columns_of, read_recording
from slidetune.robot.recordings.refused import RecordingError
from slidetune.server.exports.csv_file import csv_lines
from slidetune.server.exports.recorded_run import recorded_run
from tests.robot.recordings.files import plain, swing, table

Array = np.ndarray
Q = [f"q{number}" for number in range(1, 7)]


@pytest.fixture(scope="module")
def arm() -> KnownArm:
    return arm_named("jaka_zu5")


def refused(path: Path, arm: KnownArm, wanted: Wanted | None = None) -> RecordingError:
    with pytest.raises(RecordingError) as caught:
        read_recording(path, arm, wanted)
    assert str(caught.value).startswith(f"{path.name}: ")
    return caught.value


def changed(path: Path, row: int, change: Callable[[list[str]], list[str]]) -> Path:
    """Change the cells of one line of a file, counted from 1."""
    lines = path.read_text(encoding="utf-8").split("\n")
    lines[row - 1] = ",".join(change(lines[row - 1].split(",")))
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def test_an_exported_run_comes_back_to_the_last_bit(tmp_path: Path, arm: KnownArm) -> None:
    lanes = {"A": {"law": "smc"}, "Computed torque": {"law": "computed_torque"}}
    run = simulate(Experiment.from_document({"lanes": lanes, "simulation": {"horizon": 0.5}}))
    path = tmp_path / "run.csv"
    path.write_text("".join(csv_lines(recorded_run(run))), encoding="utf-8")
    said = str(refused(path, arm))
    assert "A, Computed torque" in said
    assert "source" in said
    for name, lane in run.lanes.items():
        found = read_recording(path, arm, Wanted(source=name))
        np.testing.assert_array_equal(found.time, run.time)
        for column, other in (
            (found.q, lane.q),
            (found.v, lane.v),
            (found.tau, lane.tau),
            (found.q_d, run.q_d),
            (found.v_d, run.v_d),
        ):
            np.testing.assert_array_equal(column, other)
        assert found.measured
        assert not found.remarks


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
@pytest.mark.parametrize("style", ["q{}", "joint_{}", "J{}", "position_{}"])
def test_separators_and_names_make_no_difference(
    tmp_path: Path, arm: KnownArm, separator: str, style: str
) -> None:
    time, q = swing()
    names = ["time", *(style.format(number) for number in range(1, 7))]
    found = read_recording(table(tmp_path / "a.csv", names, [time, q], separator), arm)
    np.testing.assert_array_equal(found.q, q)
    np.testing.assert_array_equal(found.time, time)


def test_indices_from_zero_are_those_from_one(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    names = ["timestamp", *(f"actual_q_{number}" for number in range(6))]
    found = read_recording(table(tmp_path / "a.csv", names, [time, q]), arm)
    np.testing.assert_array_equal(found.q, q)


def test_a_decimal_comma_is_understood_where_it_parts_no_columns(
    tmp_path: Path, arm: KnownArm
) -> None:
    text = plain(tmp_path / "a.csv").read_text(encoding="utf-8")
    semicolons = tmp_path / "b.csv"
    semicolons.write_text(text.replace(",", ";").replace(".", ","), encoding="utf-8")
    np.testing.assert_array_equal(read_recording(semicolons, arm).q, swing()[1])
    head, _, body = text.partition("\n")
    commas = tmp_path / "c.csv"
    commas.write_text(f"{head}\n{body.replace('.', ',')}", encoding="utf-8")
    error = refused(commas, arm)
    assert error.row == 2
    assert "semicolons" in str(error)


@pytest.mark.parametrize(
    ("unit", "factor"), [("[deg]", np.pi / 180.0), ("(°)", np.pi / 180.0), ("[mrad]", 1e-3)]
)
def test_units_of_headers_count(tmp_path: Path, arm: KnownArm, unit: str, factor: float) -> None:
    time, q = swing()
    names = ["time [ms]", *(f"q{number} {unit}" for number in range(1, 7))]
    found = read_recording(table(tmp_path / "a.csv", names, [1e3 * time, q / factor]), arm)
    np.testing.assert_allclose(found.q, q, rtol=1e-12)
    np.testing.assert_allclose(found.time, time, atol=1e-12)


def test_latin_1_from_a_spreadsheet_is_read(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    names = ["t", *(f"q{number} [°]" for number in range(1, 7))]
    path = table(tmp_path / "a.csv", names, [time, np.degrees(q)])
    path.write_bytes(path.read_text(encoding="utf-8").encode("latin-1"))
    np.testing.assert_allclose(read_recording(path, arm).q, q, rtol=1e-12)


def test_what_is_not_asked_for_may_hold_anything(tmp_path: Path, arm: KnownArm) -> None:
    lines = plain(tmp_path / "a.csv").read_text(encoding="utf-8").split("\n")
    added = ["mode," + lines[0], *(f'"running, fast",{line}' for line in lines[1:] if line)]
    path = tmp_path / "b.csv"
    path.write_text("\ufeff" + "\r\n".join(added), encoding="utf-8")
    np.testing.assert_array_equal(read_recording(path, arm).q, swing()[1])


def test_a_mapping_wins_over_headers(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    names = ["clock", *(f"a{number}" for number in range(1, 6)), "q1", "load"]
    path = table(tmp_path / "a.csv", names, [time, q, q[:, 0]])
    mapping = {"time": "clock", "joint_6": "q1"}
    mapping |= {f"joint_{number}": f"a{number}" for number in range(1, 6)}
    found = read_recording(path, arm, Wanted(mapping))
    np.testing.assert_array_equal(found.q, q)
    assert columns_of(path) == tuple(names)
    for wrong, said in (
        ({"time": "clok"}, "no column is called 'clok'"),
        ({**mapping, "joint_9": "a1"}, "joint_1, joint_2"),
        ({**mapping, "2.speed": "a1"}, ".velocity"),
    ):
        assert said in str(refused(path, arm, Wanted(wrong)))


def test_a_file_without_header_can_be_mapped(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    path = tmp_path / "a.csv"
    np.savetxt(path, np.column_stack([time, q]), delimiter=",", fmt="%.17g")
    assert "column 1, column 2" in str(refused(path, arm))
    mapping = {"time": "column 1", **{str(j): f"column {j + 1}" for j in range(1, 7)}}
    np.testing.assert_array_equal(read_recording(path, arm, Wanted(mapping)).q, q)


def test_a_header_behind_a_hash_is_numpys(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    path = tmp_path / "a.txt"
    np.savetxt(path, np.column_stack([time, q]), header="t " + " ".join(Q), fmt="%.17g")
    np.testing.assert_array_equal(read_recording(path, arm).q, q)


@pytest.mark.parametrize(
    ("stamp", "unit", "said"),
    [
        (1_700_000_000.0, 1.0, False),
        (1_700_000_000_000.0, 1e3, True),
        (1_700_000_000_000_000.0, 1e6, True),
        (1_700_000_000_000_000_000.0, 1e9, True),
    ],
)
def test_stamps_since_1970_tell_their_unit(
    tmp_path: Path, arm: KnownArm, stamp: float, unit: float, said: bool
) -> None:
    time, q = swing()
    path = table(tmp_path / "a.csv", ["timestamp", *Q], [stamp + unit * time, q])
    found = read_recording(path, arm)
    np.testing.assert_allclose(found.time, time, atol=3e-7)
    assert any("since 1970" in remark for remark in found.remarks) == said


def test_whole_seconds_and_nanoseconds_are_one_time(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    nanoseconds = np.round(1e9 * (time + 0.5)).astype(int)
    parts = [1_700_000_000 + nanoseconds // 1_000_000_000, nanoseconds % 1_000_000_000]
    names = ["header.stamp.sec", "header.stamp.nanosec", *Q]
    found = read_recording(table(tmp_path / "a.csv", names, [*parts, q]), arm)
    np.testing.assert_allclose(found.time, time, atol=1e-9)


def test_a_time_that_may_be_anything_is_refused(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    path = table(tmp_path / "a.csv", ["t", *Q], [1e3 * time, q])
    error = refused(path, arm)
    assert error.column == "t"
    assert "time [ms]" in str(error)
    np.testing.assert_allclose(read_recording(path, arm, Wanted(time="ms")).time, time, atol=1e-12)


def test_torque_and_current_that_are_empty_are_left_out(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    names = ["t", *Q, *(f"tau{number}" for number in range(1, 7)), "i1"]
    path = table(tmp_path / "a.csv", names, [time, q, np.full((200, 6), np.nan), time])
    found = read_recording(path, arm)
    assert found.tau is None
    assert found.current is None
    assert any(remark.startswith("current is left out") for remark in found.remarks)


def test_uneven_rows_and_gaps_are_told(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    random = np.random.default_rng(1)
    uneven = time + random.uniform(-0.004, 0.004, len(time))
    found = read_recording(table(tmp_path / "a.csv", ["t", *Q], [uneven, q]), arm)
    assert any("uneven" in remark for remark in found.remarks)
    late = np.where(time > 1.0, time + 3.0, time)
    found = read_recording(table(tmp_path / "b.csv", ["t", *Q], [late, q]), arm)
    assert any("gap of 3.01 s before row 103" in remark for remark in found.remarks)


def test_a_jump_by_a_turn_is_no_motion(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    way = q.copy()
    way[:, 4] = 3.0 + 2.0 * time
    wrapped = way.copy()
    wrapped[:, 4] = (way[:, 4] + np.pi) % (2.0 * np.pi) - np.pi
    found = read_recording(table(tmp_path / "a.csv", ["t", *Q], [time, wrapped]), arm)
    np.testing.assert_allclose(found.q, way, atol=1e-12)
    assert any("joint_5 jumps by a turn once" in remark for remark in found.remarks)


@pytest.mark.parametrize("begin", [3.1415, -3.1415, 9.0])
def test_desired_angles_are_of_the_turn_of_measured_ones(
    tmp_path: Path, arm: KnownArm, begin: float
) -> None:
    time, q = swing()
    q = q - q[0] + begin
    error = 0.01 * np.sin(time)[:, None] * np.ones(6)
    wrapped = [(block + np.pi) % (2.0 * np.pi) - np.pi for block in (q - error - 0.002, q)]
    names = ["t", *Q, *(f"q_d{number}" for number in range(1, 7))]
    for measured, desired in ((wrapped[0], wrapped[1]), (q - error - 0.002, wrapped[1])):
        found = read_recording(table(tmp_path / "a.csv", names, [time, measured, desired]), arm)
        assert found.q_d is not None
        np.testing.assert_allclose(found.q_d - found.q, error + 0.002, atol=1e-9)
        moved = np.round((desired[0] - measured[0]) / (2.0 * np.pi)).astype(bool)
        said = [one for one in found.remarks if one.startswith("the desired angle of joint_")]
        assert sum("same turn" in one for one in said) == moved.sum()


def test_degrees_without_a_unit_are_told(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    path = table(tmp_path / "a.csv", ["t", *Q], [time, np.degrees(q)])
    assert any("if they are degrees" in remark for remark in read_recording(path, arm).remarks)
    found = read_recording(path, arm, Wanted(angles="deg"))
    np.testing.assert_allclose(found.q, q, rtol=1e-12)
    assert not found.remarks


def test_angles_that_were_asked_for_stand_in_for_measured_ones(
    tmp_path: Path, arm: KnownArm
) -> None:
    time, q = swing()
    names = ["t", *(f"q_d{number}" for number in range(1, 7))]
    found = read_recording(table(tmp_path / "a.csv", names, [time, q]), arm)
    np.testing.assert_array_equal(found.q, q)
    assert not found.measured


@pytest.mark.parametrize(
    ("change", "column", "said"),
    [
        (lambda cells: [*cells[:3], "", *cells[4:]], "q3", "is empty or NaN"),
        (lambda cells: [*cells[:3], "nan", *cells[4:]], "q3", "is empty or NaN"),
        (lambda cells: [*cells[:3], "inf", *cells[4:]], "q3", "is infinite"),
        (lambda cells: [*cells[:3], "12abc", *cells[4:]], "q3", "'12abc' is no number"),
        (lambda cells: [*cells[:3], "0x1f", *cells[4:]], "q3", "'0x1f' is no number"),
        (lambda cells: [*cells[:3], "1_0", *cells[4:]], "q3", "'1_0' is no number"),
        (lambda cells: ["2026-01-02T03:04:05", *cells[1:]], "t", "write time in seconds"),
        (lambda cells: ["0.01", *cells[1:]], "t", "time falls: 0.01"),
        (lambda cells: ["0.08", *cells[1:]], "t", "time stands still: 0.08"),
        (lambda cells: cells[:4], "", "has 4 cells where the header has 7"),
        (lambda cells: [*cells, "1"], "", "has 8 cells where the header has 7"),
    ],
)
def test_a_bad_row_is_refused_with_its_place(
    tmp_path: Path, arm: KnownArm, change: Callable[[list[str]], list[str]], column: str, said: str
) -> None:
    error = refused(changed(plain(tmp_path / "a.csv"), 11, change), arm)
    assert error.row == 11
    assert error.column == column
    assert "row 11" in str(error)
    assert said in str(error)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is empty"),
        (b"\n\n\n", "has no rows"),
        (b"t,q1,q2,q3,q4,q5,q6\n", "has a header and no rows"),
        (b"hello\nworld\n", "single column"),
        (b"t,q1,q2,q3,q4,q5,q6\n0,1,2,3,4,5,6\n", "has 1 rows, at least 8"),
        (b"a,b\n1,2\n", "no column is called time"),
        (b"t,q1,q2\n1,2,3\n", "joint_3, joint_4, joint_5, joint_6"),
        (b"PK\x03\x04rest", "save the sheet as CSV"),
        (b"SQLite format 3\0", "ros2 bag convert"),
        (b"#ROSBAG V2.0\n", "ROS 1"),
        (b"\xff\xfet\0,\0", "UTF-8"),
        (b"\x1f\x8b\x08\0", "gzip"),
        (b"abc\0def", "is binary"),
        (b"x" * 300_000, "longer than"),
    ],
)
def test_what_is_no_table_says_what_it_is(
    tmp_path: Path, arm: KnownArm, content: bytes, said: str
) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    assert said in str(refused(path, arm))


def test_a_file_that_is_not_there_and_a_folder_are_refused(tmp_path: Path, arm: KnownArm) -> None:
    assert "no such file" in str(refused(tmp_path / "none.csv", arm))
    assert "is no file" in str(refused(tmp_path, arm))


def test_a_file_beyond_the_limit_is_refused_before_it_is_read(
    tmp_path: Path, arm: KnownArm
) -> None:
    path = plain(tmp_path / "a.csv")
    os.truncate(path, LARGEST_FILE + 1)
    assert "at most 200 MB" in str(refused(path, arm))


def test_rows_beyond_the_limit_are_refused(
    tmp_path: Path, arm: KnownArm, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert MOST_ROWS == 1_000_000
    monkeypatch.setattr("slidetune.robot.recordings.csv_file.MOST_ROWS", 150)
    assert "more than 150 rows" in str(refused(plain(tmp_path / "a.csv"), arm))


def test_two_columns_of_one_joint_are_no_guess(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    path = table(tmp_path / "a.csv", ["t", *Q, "J3"], [time, q, q[:, 2]])
    said = str(refused(path, arm))
    assert "'q3' and 'J3'" in said
    found = read_recording(path, arm, Wanted({"joint_3": "J3"}))
    np.testing.assert_array_equal(found.q, q)


def test_a_wrong_unit_is_refused(tmp_path: Path, arm: KnownArm) -> None:
    time, q = swing()
    path = table(tmp_path / "a.csv", ["t", *(f"{name} [mm]" for name in Q)], [time, q])
    error = refused(path, arm)
    assert error.column == "q1 [mm]"
    assert "q1 [rad] or q1 [deg]" in str(error)
