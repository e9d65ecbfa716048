"""What the trust scripts print and, when asked, write into the documentation."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date
from pathlib import Path

from slidetune.server.bench.table import machine

DOCS = Path(__file__).resolve().parents[2] / "docs"


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table; the first column is text, the others are figures."""
    alignment = ["---", *["--:"] * (len(headings) - 1)]
    lines = [headings, alignment, *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def provenance(command: str) -> str:
    """Return the line that says which command gave the figures, when and on which machine."""
    about = machine()
    load = "unknown" if about["load"] is None else f"{about['load']:.1f}"
    return (
        f"*`{command}`, {date.today().isoformat()}: {about['processor']}, {about['cores']} cores, "
        f"load {load}; {about['system']}; Python {about['python']}, "
        f"Slidetune {about['slidetune']}, Pinocchio {about['pin']}, NumPy {about['numpy']}.*"
    )


def record(document: str, section: str, body: str) -> None:
    """Replace one marked section of a page in ``docs``.

    Args:
        document: file name, such as ``trust.md``.
        section: name of the section between ``<!-- begin name -->`` and ``<!-- end name -->``.
        body: Markdown to put there.

    Raises:
        LookupError: if the page has no such section.
    """
    path = DOCS / document
    begin, end = f"<!-- begin {section} -->", f"<!-- end {section} -->"
    text = path.read_text(encoding="utf-8")
    pattern = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.DOTALL)
    if not pattern.search(text):
        raise LookupError(f"docs/{document} has no section {section}")
    new = f"{begin}\n{body.strip()}\n{end}"
    path.write_text(pattern.sub(lambda _: new, text), encoding="utf-8")
