"""A refused value as a message shows it: as JSON would write it, and never at length."""

from __future__ import annotations

import json
from collections.abc import Mapping
from math import isfinite

LONGEST = 120
"""Most characters of a value that are shown (*ours*)."""
_ITEMS = 8


def written(value: object) -> str:
    """Return a value as text that UTF-8 can carry; a text as it is, anything else as in JSON."""
    if isinstance(value, str):
        # Cut before it is encoded: it may have a million characters.
        text = value[: LONGEST + 1].encode("utf-8", "backslashreplace").decode()
    else:
        text = _json(value, 0)
    return text if len(text) <= LONGEST else text[:LONGEST] + "…"


def plain_value(value: object) -> object:
    """Return a value as an error carries it: what JSON has for one value as it is, else written."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int):
        return value if abs(value) < 10**40 else written(value)
    if isinstance(value, float):
        return value if isfinite(value) else str(value)
    return written(value)


def _json(value: object, depth: int) -> str:
    if isinstance(value, Mapping | list | tuple):
        if depth == 3:
            return "…"
        return _mapping(value, depth) if isinstance(value, Mapping) else _list(value, depth)
    if isinstance(value, str):
        return json.dumps(written(value), ensure_ascii=False)
    if isinstance(value, bool) or value is None:
        return json.dumps(value)
    if isinstance(value, int):
        return str(value) if abs(value) < 10**40 else "a whole number of more than 40 digits"
    return str(value) if isinstance(value, float) else f"a {type(value).__name__}"


def _list(value: list[object] | tuple[object, ...], depth: int) -> str:
    more = ["…"] if len(value) > _ITEMS else []
    return f"[{', '.join([_json(item, depth + 1) for item in value[:_ITEMS]] + more)}]"


def _mapping(value: Mapping[object, object], depth: int) -> str:
    items = [
        f"{_json(key, depth + 1)}: {_json(item, depth + 1)}"
        for _, (key, item) in zip(range(_ITEMS), value.items(), strict=False)
    ]
    return f"{{{', '.join(items + (['…'] if len(value) > _ITEMS else []))}}}"
