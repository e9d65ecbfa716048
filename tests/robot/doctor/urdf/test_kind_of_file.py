"""A file that is no URDF is told what it is, and in which line that shows."""

from __future__ import annotations

from pathlib import Path

import pytest

from slidetune.robot.doctor.examine import Finding, examine
from slidetune.robot.doctor.urdf.xml_tree import MOST_BYTES, MOST_ELEMENTS
from tests.robot.doctor.arm_text import GOOD, HERE, changed, examined, marked_line, only

XACRO = '<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
OTHERS = {
    "xacro": (f'{XACRO}\n{HERE}<xacro:include filename="a.xacro"/></robot>', "xacro, not URDF"),
    "expression": (
        changed('<mass value="2.0"/>', f'{HERE}<mass value="${{m}}"/>'),
        "1 elements such as <mass> with ${m}",
    ),
    "SDF": (f'<?xml version="1.0"?>\n{HERE}<sdf version="1.9"/>', "SDF (Gazebo), not URDF"),
    "MJCF": (f'{HERE}<mujoco model="m"/>', "MJCF (MuJoCo), not URDF"),
    "mesh": (f"\n{HERE}<COLLADA/>", "COLLADA, a mesh, not URDF"),
    "page": (f"\n{HERE}<html/>", "the root element is <html>, a URDF has <robot>"),
    "DOCTYPE": (f"\n{HERE}<!DOCTYPE robot>\n<robot/>", "the file has a DOCTYPE"),
    "bomb": (
        f'{HERE}<!DOCTYPE robot [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>\n<robot name="&b;"/>',
        "entities could make a small file endless",
    ),
    "open": (f'<robot name="a">\n{HERE}</robt>', "mismatched tag at line 2, column 14"),
    "words": (f"{HERE}not a robot", "is no XML: "),
    "entity": (f'<robot>\n{HERE}<link name="&a;"/></robot>', "undefined entity at line 2"),
}  # fmt: skip


def refusal(path: Path) -> Finding:
    found = examine(path)
    assert found.arm is None
    (refused,) = only(found, "refused")
    assert refused.where == "file"
    assert refused.remedy
    return refused


@pytest.mark.parametrize("name", OTHERS)
def test_what_is_no_urdf_is_told_what_it_is(name: str, tmp_path: Path) -> None:
    text, words = OTHERS[name]
    (refused,) = only(examined(tmp_path, text), "refused")
    assert words in refused.text
    assert refused.line == marked_line(text)


def test_xacro_is_told_how_to_be_expanded(tmp_path: Path) -> None:
    (refused,) = only(examined(tmp_path, OTHERS["xacro"][0]), "refused")
    assert "xacro file.urdf.xacro > out.urdf" in refused.remedy


def test_the_name_of_xacro_alone_makes_no_xacro(tmp_path: Path) -> None:
    text = changed('<robot name="two">', XACRO.strip().replace('"x"', '"two"'))
    assert examined(tmp_path, text).arm is not None


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "is no XML: no element found at line 1, column 1"),
        (b"PK\x03\x04\x14\x00", "is no XML: "),
        (b"\x00" * 100, "is no XML: "),
        (b'<?xml version="1.0" encoding="klingon"?><robot/>', "klingon"),
        (b"<robot/>" * 2, "is no XML: junk after document element at line 1, column 9"),
        (b"<a>" * (MOST_ELEMENTS + 1), "the file has more than 200,000 elements"),
    ],
    ids=["empty", "ZIP", "zeros", "encoding", "two roots", "many elements"],
)
def test_what_is_no_xml_is_told_where(data: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_bytes(data)
    assert words in refusal(path).text


def test_other_encodings_are_read(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_bytes(GOOD.replace('"1.0"?', '"1.0" encoding="utf-16"?').encode("utf-16"))
    assert examine(path).arm is not None


def test_a_file_too_large_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    with path.open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    assert refusal(path).text == "the file has 20,000,001 bytes, at most 20,000,000 are read"


@pytest.mark.parametrize("name", ["missing.urdf", ".", "a\0b"])
def test_what_cannot_be_read_is_said(name: str, tmp_path: Path) -> None:
    assert "can't be read" in refusal(tmp_path / name).text
