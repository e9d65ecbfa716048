"""What is kept of a text, and what stands in the place of names."""

from __future__ import annotations

import pytest

from slidetune.robot.handover.template import filled, holds, resolved

TEXT = """\
before
@if a
a
@if b
a and b
@else
a alone
@end
@elif b or c
b or c
@else
none
@end
after
"""


@pytest.mark.parametrize(
    ("choices", "kept"),
    [
        ({"a"}, "a\na alone\n"),
        ({"a", "b"}, "a\na and b\n"),
        ({"b"}, "b or c\n"),
        ({"c"}, "b or c\n"),
        (set(), "none\n"),
    ],
)
def test_one_part_of_each_choice_is_kept(choices: set[str], kept: str) -> None:
    assert resolved(TEXT, choices) == f"before\n{kept}after\n"


@pytest.mark.parametrize(
    ("condition", "choices", "expected"),
    [
        ("a and not b", {"a"}, True),
        ("a and not b", {"a", "b"}, False),
        ("a and b or c", {"c"}, True),
        ("a and b or c", {"a"}, False),
        ("not a", set(), True),
    ],
)
def test_conditions_mean_what_they_do_in_python(
    condition: str, choices: set[str], expected: bool
) -> None:
    assert holds(condition, choices) is expected


@pytest.mark.parametrize("text", ["@if a\n", "@end\n", "@else\n", "@if a\n@end\n@end\n"])
def test_a_text_that_does_not_close_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="without"):
        resolved(text, set())


def test_a_name_without_a_value_is_refused() -> None:
    assert filled("$A_1 and $(B)", {"A_1": "one"}) == "one and $(B)"
    with pytest.raises(KeyError):
        filled("$A", {})
