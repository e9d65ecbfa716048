"""What any document may hold before anybody looks at its meaning: bounded depth, keys, numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from slidetune.robot.fields.field_path import field_path

DEEPEST = 12
"""Most levels of mappings and lists in each other (*ours*); a preset has four."""
LONGEST_KEY = 120
"""Most characters of a key (*ours*); the longest that means something has 40."""
MOST_KEYS = 1000
"""Most keys of a document (*ours*); six lanes have fewer than 300 together."""
MOST_VALUES = 5000
"""Most values of a document, or pieces of a text (*ours*): a quarter of a second
of the YAML parser's time; six lanes with a value per joint throughout take fewer than 2000."""

_LONGEST_BITS = 1024
_Place = tuple[Any, str] | None


class UnfitError(ValueError):
    """Values that no document may hold; ``path`` says where."""

    def __init__(self, place: _Place, text: str) -> None:
        """Keep the place, from the top down, and the text."""
        parts: list[str] = []
        while place is not None:
            place, part = place
            parts.append(part)
        self.path = field_path(reversed(parts))
        super().__init__(text)


class PlainMapping(dict[str, Any]):
    """A mapping that ``plain_values`` returned: nobody need look at it again."""


def excess(document: Any) -> str:
    """Return what a document has too many of, or an empty text; it is counted no further."""
    keys, values, waiting = 0, 0, [document]
    while waiting and keys <= MOST_KEYS and values <= MOST_VALUES:
        value = waiting.pop()
        values += 1
        if isinstance(value, Mapping):
            keys += len(value)
            waiting.extend(value.values())
        elif isinstance(value, list | tuple):
            waiting.extend(value)
    if keys > MOST_KEYS:
        return f"contains more than {MOST_KEYS} keys: no experiment needs so many"
    if values > MOST_VALUES:
        return f"contains more than {MOST_VALUES} values: no experiment needs so many"
    return ""


def plain_values(document: Any) -> Any:
    """Return a document with every whole number that no float holds as infinity.

    Everything behind this can walk the values and write them down without a second thought:
    Python writes no number of more than 4300 digits, and walks no depth of a thousand.

    Args:
        document: mappings, lists and plain values in each other.

    Raises:
        UnfitError: for too many values, for values nested too deep, and for keys that are too
            long or hold unpaired surrogates.
    """
    if too_many := excess(document):
        raise UnfitError(None, too_many)
    return _plain(document, None, 0)


def _plain(value: Any, place: _Place, depth: int) -> Any:
    kind = type(value)
    if kind is float or kind is str or kind is bool:
        return value
    if isinstance(value, int):
        return value if value.bit_length() <= _LONGEST_BITS else math.inf * (1 if value > 0 else -1)
    if not isinstance(value, Mapping | list | tuple):
        return value
    if depth == DEEPEST:
        raise UnfitError(place, f"is nested deeper than {DEEPEST} levels")
    if not isinstance(value, Mapping):
        return [_plain(item, (place, str(i)), depth + 1) for i, item in enumerate(value)]
    return PlainMapping(
        (key, _plain(item, (place, _checked_key(key, place)), depth + 1))
        for key, item in value.items()
    )


def _checked_key(key: object, place: _Place) -> str:
    if not isinstance(key, str):
        return "?"  # its section refuses it by its own rules
    if len(key) > LONGEST_KEY:
        raise UnfitError(
            place, f"contains a key of {len(key)} characters, at most {LONGEST_KEY} are allowed"
        )
    if not key.isascii() and any("\ud800" <= letter <= "\udfff" for letter in key):
        raise UnfitError(place, "contains a key with unpaired surrogates")
    return key
