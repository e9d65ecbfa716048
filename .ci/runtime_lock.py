"""Prints the part of the lock that an installation needs, with its hashes.

Usage: python runtime_lock.py REPORT LOCK; ``pip install --dry-run --report`` writes the first.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path


def runtime_lock(report: str, lock: str) -> str:
    """Return the entries of a lock for all that a report would install from elsewhere.

    Args:
        report: JSON of ``pip install --dry-run --report``.
        lock: text of ``requirements.lock``.

    Raises:
        ValueError: if the lock lacks one of them, or has another version.
    """
    entries = {}
    for entry in re.split(r"\n(?=[^\s#])", lock):
        pinned = re.match(r"([\w.-]+)==([^\s;\\]+)", entry)
        if pinned:
            entries.setdefault((_plain(pinned[1]), pinned[2]), entry)
    found = []
    for one in json.loads(report)["install"]:
        if one["download_info"]["url"].startswith("file:"):
            continue  # the wheel itself
        name, version = _plain(one["metadata"]["name"]), one["metadata"]["version"]
        if (name, version) not in entries:
            raise ValueError(f"the lock has no {name}=={version}")
        found.append(entries[name, version])
    return "\n".join(sorted(found)) + "\n"


def _plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


if __name__ == "__main__":
    print(runtime_lock(*(Path(name).read_text(encoding="utf-8") for name in sys.argv[1:])), end="")
