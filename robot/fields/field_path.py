"""How a place in an experiment is written: ``lanes.NFTSM.nu``, ``lanes."nu 0.5".nu``.

A lane may have a dot in its name; in quotes, as in TOML, it is still one key.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable

_AMBIGUOUS = re.compile('[."]|^$')
_PART = re.compile(r'"(?:[^"\\]|\\.)*"|[^."]+')


def field_path(parts: Iterable[str]) -> str:
    """Return the dotted path of some keys; one that holds a dot or a quote, or nothing, is quoted.

    Args:
        parts: keys from the top down, such as ``lanes``, ``NFTSM``, ``nu``.
    """
    return ".".join(
        json.dumps(part, ensure_ascii=False) if _AMBIGUOUS.search(part) else part for part in parts
    )


def path_parts(path: str) -> tuple[str, ...]:
    """Return the keys of a dotted path; the inverse of ``field_path``."""
    found = _PART.findall(path)
    return tuple(json.loads(part) if part.startswith('"') else part for part in found)
