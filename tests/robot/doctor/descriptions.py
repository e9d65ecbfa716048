"""Where the descriptions of real robots are."""

from __future__ import annotations

from functools import cache
from importlib.metadata import files
from pathlib import Path


@cache
def described(name: str) -> Path:
    """Return the path of a URDF of example-robot-data."""
    known = files("example-robot-data") or []
    return next(Path(str(file.locate())) for file in known if file.name == name)
