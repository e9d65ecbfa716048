"""The page of equations has every equation that the code uses."""

from __future__ import annotations

import re

from docs.site.written_pages import DOCS
from tests.docs.pages import ROOT

PAGE = (DOCS / "equations.md").read_text(encoding="utf-8")
LAST = 33
"""Number of the paper's last equation."""


def test_every_file_with_an_equation_is_named() -> None:
    files = [
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "robot").rglob("*.py")
        if ".. math::" in path.read_text(encoding="utf-8")
    ]
    assert len(files) > 40
    assert [name for name in files if f"`{name}`" not in PAGE] == []


def test_every_equation_of_the_paper_is_told() -> None:
    told: set[int] = set()
    for row in re.findall(r"^\| ([\d–, ]+) \|", PAGE, re.MULTILINE):
        for part in row.split(", "):
            first, _, last = part.partition("–")
            told |= set(range(int(first), int(last or first) + 1))
    assert told == set(range(1, LAST + 1))


def test_every_equation_that_the_code_quotes_is_told_as_used() -> None:
    quoted: set[int] = set()
    for path in (ROOT / "robot").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for first, last in re.findall(r"Eq\. (\d+)(?:[-–](\d+))?(?![.\d])", text):
            quoted |= set(range(int(first), int(last or first) + 1))
    unused = {
        int(number)
        for row in re.findall(r"^\| ([\d–, ]+) \|.*\| – \|$", PAGE, re.MULTILINE)
        for number in re.findall(r"\d+", row)
    }
    assert {5, 9, 13, 22} <= quoted
    assert quoted & unused == set()
