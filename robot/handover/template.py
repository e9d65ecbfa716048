"""Texts of a package: of each what a law needs is kept, and values stand in the place of names.

A line ``@if tanh or saturation`` begins what is kept where one of these holds, up to ``@elif``,
``@else`` or ``@end``; ``and``, ``or`` and ``not`` are those of Python. ``$NAME`` is a value.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Set
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
_NAME = re.compile(r"\$([A-Z][A-Z0-9_]*)")


def holds(condition: str, choices: Set[str]) -> bool:
    """Tell whether a condition such as ``shaped and not implicit`` holds.

    Args:
        condition: names with ``or``, ``and`` and ``not``, which bind in this order as in Python.
        choices: the names that hold.
    """
    return any(
        all(
            (word.removeprefix("not ") in choices) != word.startswith("not ")
            for word in part.split(" and ")
        )
        for part in condition.split(" or ")
    )


def resolved(text: str, choices: Set[str]) -> str:
    """Return a text with what the choices keep of it.

    Args:
        text: lines, some of which are directives.
        choices: the names that hold.

    Raises:
        ValueError: for a directive without its ``@if`` or ``@end``: a mistake of ours.
    """
    lines: list[str] = []
    # For each open @if: whether its present part is kept, and whether one of its parts was.
    open_parts: list[tuple[bool, bool]] = []
    for line in text.splitlines(keepends=True):
        directive, _, condition = line.strip().partition(" ")
        if directive == "@if":
            kept = holds(condition, choices)
            open_parts.append((kept, kept))
        elif directive in ("@elif", "@else", "@end"):
            if not open_parts:
                raise ValueError(f"{directive} without @if")
            _, done = open_parts.pop()
            if directive != "@end":
                kept = not done and (directive == "@else" or holds(condition, choices))
                open_parts.append((kept, done or kept))
        elif all(kept for kept, _ in open_parts):
            lines.append(line)
    if open_parts:
        raise ValueError("@if without @end")
    return "".join(lines)


def filled(text: str, values: Mapping[str, str]) -> str:
    """Return a text with values in the place of their names.

    Raises:
        KeyError: for a name without a value: a mistake of ours.
    """
    return _NAME.sub(lambda found: values[found[1]], text)


def written_text(name: str, choices: Set[str], values: Mapping[str, str]) -> str:
    """Return a text of this folder, resolved and filled.

    Args:
        name: its path here, without ``.in``.
        choices: the names that hold.
        values: what stands in the place of names.
    """
    text = (FOLDER / f"{name}.in").read_text(encoding="utf-8")
    return filled(resolved(text, choices), values)
