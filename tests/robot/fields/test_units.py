"""Units of joints, of which some slide."""

from __future__ import annotations

import pytest

from slidetune.robot.fields.units import in_units_of, sliding, unit_of_joints


@pytest.mark.parametrize(
    ("turns", "slides"),
    [
        ("rad", "m"),
        ("rad/s", "m/s"),
        ("mrad", "mm"),
        ("N·m", "N"),
        ("N·m/s", "N/s"),
        ("N·m·s/rad", "N·s/m"),
        ("N·m/rad", "N/m"),
        ("kg·m²", "kg"),
        ("rad·s²", "m·s²"),
        ("1/s", "1/s"),
        ("mm", "mm"),
        ("", ""),
    ],
)
def test_every_unit_of_a_joint_has_one_where_it_slides(turns: str, slides: str) -> None:
    assert sliding(turns) == slides
    assert unit_of_joints(turns, [True, True]) == slides
    assert unit_of_joints(turns, [False, False]) == turns
    both = turns if turns == slides else f"{turns} | {slides}"
    assert unit_of_joints(turns, [False, True]) == both


def test_texts_have_the_units_of_the_joints() -> None:
    text = "Joint 2 needs 5 N·m at 3 rad/s; S = 2 rad/s², 4 N·m·s/rad, radius 1 m, gradual, 3 mrad."
    assert in_units_of(text, [False]) == text
    assert in_units_of(text, [True]) == (
        "Joint 2 needs 5 N at 3 m/s; S = 2 m/s², 4 N·s/m, radius 1 m, gradual, 3 mm."
    )
    assert "5 N·m | N at" in in_units_of(text, [True, False])
    assert in_units_of("(±100 rad, ±200 rad/s) at", [True]) == "(±100 m, ±200 m/s) at"
