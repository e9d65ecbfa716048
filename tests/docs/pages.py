"""The documentation as it is written: its pages, headings, links and blocks of code."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from docs.site.written_pages import written_pages

ROOT = Path(__file__).resolve().parents[2]
TOP = tuple(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"))
_FENCE = re.compile(r"^( *)(`{3,})(\w*)[^\n]*\n(.*?)^\1\2 *$", re.MULTILINE | re.DOTALL)
_REMARK = re.compile(r"<!-- (not run|run in|file): (.+?) -->")
_CODE = re.compile(r"(`+)(.+?)\1")
_LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


@dataclass(frozen=True)
class Block:
    """A block of code.

    Attributes:
        page: where it stands.
        line: number of the line at which its code begins.
        language: as the page says, or empty.
        code: its text.
        not_run: why it isn't run, or empty.
        folder: where it is run, within that of the page.
        file: under which name the page speaks of it, or empty.
    """

    page: Path
    line: int
    language: str
    code: str
    not_run: str
    folder: str
    file: str

    def __str__(self) -> str:
        """Say where it is."""
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def pages() -> list[Path]:
    """Return every page: those of docs/ and those at the top."""
    return [*TOP, *written_pages()]


@cache
def blocks(page: Path) -> tuple[Block, ...]:
    """Return the blocks of a page in their order."""
    text = page.read_text(encoding="utf-8")
    found = []
    for match in _FENCE.finditer(text):
        before = text[: match.start()].rstrip().rsplit("\n", 1)[-1]
        said = dict(_REMARK.findall(before))
        line = text.count("\n", 0, match.start()) + 2
        names = ("not run", "run in", "file")
        found.append(Block(page, line, match[3], match[4], *(said.get(name, "") for name in names)))
    return tuple(found)


def prose(page: Path) -> str:
    """Return a page without its blocks of code and its comments."""
    text = _FENCE.sub("", page.read_text(encoding="utf-8"))
    return re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)


def code_spans(page: Path) -> list[str]:
    """Return what stands in backquotes within a page's prose."""
    return [match[2].strip() for match in _CODE.finditer(prose(page))]


def links(page: Path) -> list[str]:
    """Return the targets of a page's links and pictures."""
    return _LINK.findall(_CODE.sub("", prose(page)))


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as Git hosts make them."""
    found: dict[str, int] = {}
    for heading in re.findall(r"^#{1,6} +(.+?) *$", prose(page), re.MULTILINE):
        shown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        anchor = re.sub(r"[^\w\- ]", "", shown.lower()).replace(" ", "-")
        count = found.get(anchor, 0)
        found[anchor] = count + 1
        if count:
            found[f"{anchor}-{count}"] = 1
    return set(found)
