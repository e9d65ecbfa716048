"""The report has every finding, in plain text of a given width."""

from __future__ import annotations

from pathlib import Path

from slidetune.robot.doctor.report import report
from tests.robot.doctor.arm_text import GOOD, SHOULDER_LIMIT, changed, examined


def test_a_sound_arm_is_one_sentence(tmp_path: Path) -> None:
    text = report(examined(tmp_path, GOOD))
    assert text == "two is an arm of 2 joints, its tip is tool: nothing to say.\n"


def test_every_finding_is_in_the_table(tmp_path: Path) -> None:
    wrong = changed(SHOULDER_LIMIT, '<limit lower="2" upper="-2" velocity="0" effort="1"/>')
    found = examined(tmp_path, wrong)
    text = report(found)
    assert text.startswith("two can't be loaded: 1 refused, 1 assumed.")
    for word in ("refused", "assumed", "joint shoulder", " 33 ", "kind", "way out"):
        assert word in text
    words = " ".join(text.replace("│", " ").split())
    assert "lower is 2 and upper" in words
    assert "\x1b" not in text


def test_no_line_is_wider_than_asked(tmp_path: Path) -> None:
    wrong = changed('<mass value="2.0"/>', f'<mass value="{"9" * 5000}"/>')
    for width in (60, 100):
        lines = report(examined(tmp_path, wrong), width).splitlines()
        assert max(len(line) for line in lines) <= width


def test_brackets_in_names_are_no_markup(tmp_path: Path) -> None:
    text = report(examined(tmp_path, GOOD.replace('"elbow"', '"[red]elbow"').replace("-2.5", "9")))
    assert "[red]elbow" in text.replace("\n", "")
