"""Markdown as the generated pages write it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from typing import Any


def cell(text: object) -> str:
    """Return text for one cell of a table: on one line, its bars escaped."""
    return re.sub(r"\s+", " ", str(text)).strip().replace("|", r"\|")


def plain(text: object) -> str:
    """Return text that Markdown and HTML take literally."""
    return re.sub(r"([\\*_\[\]<>`|])", r"\\\1", " ".join(str(text).split()))


def told(text: object) -> str:
    """Return text that is Markdown already, on one line, with nothing in it taken for HTML."""
    parts = re.split(r"(`[^`]*`)", cell(text))
    return "".join(
        part if part.startswith("`") else part.replace("<", r"\<").replace("*", r"\*")
        for part in parts
    )


def code(text: object) -> str:
    """Return text as code; nothing of nothing."""
    inside = cell(text)
    if not inside:
        return ""
    fence = "``" if "`" in inside else "`"
    return f"{fence}{inside}{fence}"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; nothing where it has no rows. Cells are Markdown already."""
    lines = [f"| {' | '.join(row)} |" for row in rows]
    if not lines:
        return ""
    return "\n".join([f"| {' | '.join(heads)} |", f"|{' --- |' * len(heads)}", *lines, ""])


def json_block(value: Any) -> str:
    """Return a value as a block of JSON."""
    return f"```json\n{json.dumps(value, ensure_ascii=False, indent=2)}\n```\n"


def page(*parts: str) -> str:
    """Return parts of a page one below the other; empty ones leave no gap."""
    return "\n\n".join(part.strip("\n") for part in parts if part.strip()) + "\n"
