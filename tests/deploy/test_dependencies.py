"""What the package imports is what its metadata asks for, and the other way round."""

from __future__ import annotations

import ast
import sys
from email import message_from_string
from importlib.metadata import packages_distributions
from pathlib import Path
from zipfile import ZipFile

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

OPTIONAL = {"distributed"}
"""What an extra brings: the code that imports it runs with ``--scheduler`` alone."""
NOT_IMPORTED = {
    "cmaes",
    "fastapi-offline",
    "httptools",
    "pycollada",
    "python-multipart",
    "uvloop",
    "websockets",
    "zstandard",
}
"""Asked for on behalf of others, which import it where it is, or for its files (pyproject.toml)."""


def imported(wheel: Path) -> dict[str, set[str]]:
    """Top-level modules that the wheel's code imports, and by which files."""
    found: dict[str, set[str]] = {}
    with ZipFile(wheel) as archive:
        for name in archive.namelist():
            if not name.endswith(".py"):
                continue
            for node in ast.walk(ast.parse(archive.read(name))):
                modules = (
                    [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                )
                modules += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
                for module in modules:
                    found.setdefault(module.partition(".")[0], set()).add(name)
    return found


def asked_for(wheel: Path) -> list[Requirement]:
    with ZipFile(wheel) as archive:
        (name,) = (one for one in archive.namelist() if one.endswith(".dist-info/METADATA"))
        metadata = message_from_string(archive.read(name).decode())
    return [Requirement(text) for text in metadata.get_all("Requires-Dist") or []]


def test_every_import_of_the_wheel_is_asked_for_and_nothing_is_asked_for_in_vain(
    wheel: Path,
) -> None:
    brought = {**packages_distributions(), "pinocchio": ["pin"]}  # which is in a folder apart
    outside = {
        module: files
        for module, files in imported(wheel).items()
        if module not in sys.stdlib_module_names and module != "slidetune"
    }
    assert outside.keys() >= {"numpy", "numba", "pinocchio", "viser"}
    wanted = {
        canonicalize_name(one.name)
        for one in asked_for(wheel)
        if one.marker is None or "extra" not in str(one.marker)
    }
    used = set()
    for module, files in outside.items():
        names = {canonicalize_name(name) for name in brought[module]}
        assert names & (wanted | OPTIONAL), f"{module} of {sorted(files)[0]} is not asked for"
        used |= names & wanted
    assert wanted - used <= NOT_IMPORTED


def test_the_wheel_tells_who_it_is(wheel: Path) -> None:
    with ZipFile(wheel) as archive:
        (name,) = (one for one in archive.namelist() if one.endswith("entry_points.txt"))
        assert "slidetune = slidetune.server.cli:main" in archive.read(name).decode()
        (name,) = (one for one in archive.namelist() if one.endswith(".dist-info/METADATA"))
        metadata = message_from_string(archive.read(name).decode())
    assert metadata["Requires-Python"] == ">=3.11"
    assert metadata["License-Expression"] == "MIT"
    assert str(metadata.get_payload()).startswith("# Slidetune")
