"""A notebook as a page: its text and its code, for those who read it without Jupyter."""

from __future__ import annotations

import json
from typing import Any

from docs.site.table import page


def _source(cell: dict[str, Any]) -> str:
    source = cell["source"]
    return source if isinstance(source, str) else "".join(source)


def _cell(cell: dict[str, Any]) -> str:
    source = _source(cell)
    return f"```python\n{source}\n```" if cell["cell_type"] == "code" and source else source


def notebook_page(text: str, name: str) -> str:
    """Return a notebook as Markdown.

    Args:
        text: the file, without results: they are kept in none of ours.
        name: of the file, which the page links to.
    """
    first, *others = json.loads(text)["cells"]
    link = f"[The notebook itself]({name}) runs in Jupyter, with figures and plots in place."
    return page(_cell(first), link, *map(_cell, others))
