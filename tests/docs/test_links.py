"""Every link of the documentation leads somewhere, as it is read on a Git host."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from docs.site.written_pages import DOCS
from tests.docs.pages import ROOT, anchors, links, pages


def leads_to(page: Path, link: str) -> str:
    """Say what is wrong with a link; nothing where it is right."""
    target, _, anchor = link.partition("#")
    path = (page.parent / target).resolve() if target else page
    if not path.exists():
        return f"{page.name} links to {link}: there is no such file"
    if not path.is_relative_to(ROOT):
        return f"{page.name} links to {link}, which is outside of the repository"
    if anchor and anchor not in anchors(path):
        return f"{page.name} links to {link}: there is no such heading"
    return ""


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.name)
def test_every_link_leads_to_a_file_and_a_heading_that_exist(page: Path) -> None:
    inner = [link for link in links(page) if not re.match(r"\w+:", link)]
    assert [wrong for link in inner if (wrong := leads_to(page, link))] == []


def test_a_wrong_link_is_found() -> None:
    page = DOCS / "index.md"
    assert leads_to(page, "tutorial.md") == ""
    assert leads_to(page, "tutorial.md#1-start") == ""
    assert "no such file" in leads_to(page, "tutorials.md")
    assert "no such heading" in leads_to(page, "tutorial.md#start")


def test_every_picture_is_shown_small_and_said_in_words() -> None:
    shown: set[Path] = set()
    for page in pages():
        text = page.read_text(encoding="utf-8")
        for words, target in re.findall(r"!\[([^\]]*)\]\(([^)]+)\)", text):
            assert len(words) > 10, f"{page.name}: {target} is not said in words"
            shown.add((page.parent / target).resolve())
    pictures = set((DOCS / "pictures").iterdir())
    extra = {DOCS / "pictures" / "dashboard-dark.png"}  # for those who link to it from elsewhere
    assert shown == pictures - extra
    sizes = [path.stat().st_size for path in pictures]
    assert max(sizes) <= 150_000
    assert sum(sizes) <= 1_500_000
