"""Compiled kernels: kept on disk, and never run stale."""

from __future__ import annotations

import ast
import importlib
from pathlib import Path
from types import ModuleType

import numba
import pytest

import robot
from robot import compiled
from robot.compiled import CACHE, is_warm, kernel
from robot.experiment import Experiment
from robot.simulate import simulate
from robot.switching import switch

FOLDER = Path(robot.__file__).parent
KERNEL_FILES = [
    path
    for path in sorted(FOLDER.rglob("*.py"))
    if any(line.startswith("@kernel") for line in path.read_text().splitlines())
]


def module_of(path: Path) -> ModuleType:
    parts = path.relative_to(FOLDER.parent).with_suffix("").parts
    return importlib.import_module(".".join(parts))


def origins(path: Path) -> dict[str, str]:
    """Return the names that a file imports from this package, and the files that define them."""
    found = {}
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("robot"):
            file = module_of_name(str(node.module))
            found |= {alias.asname or alias.name: file for alias in node.names}
    return found


def module_of_name(name: str) -> str:
    return Path(str(importlib.import_module(name).__file__)).name


def test_there_are_kernels() -> None:
    assert len(KERNEL_FILES) > 10


@pytest.mark.parametrize("path", KERNEL_FILES, ids=lambda path: path.stem)
def test_numbers_compiled_into_a_kernel_come_from_files_that_renew_it(path: Path) -> None:
    module, known = module_of(path), origins(path)
    renewing = {file.name for file in KERNEL_FILES} | set(compiled._CONSTANTS)
    for value in vars(module).values():
        if not isinstance(value, numba.core.dispatcher.Dispatcher):
            continue
        for name in value.py_func.__code__.co_names:
            if name in known and value.py_func.__module__ == module.__name__:
                assert known[name] in renewing, f"{name} of {known[name]}"


def test_kernels_are_kept() -> None:
    assert switch.stats.cache_path.startswith(str(CACHE))


def test_division_by_zero_is_no_error() -> None:
    @kernel
    def divided(a, b):  # type: ignore[no-untyped-def]
        return a / b

    assert divided(1.0, 0.0) == float("inf")


def test_a_run_leaves_the_kernels_warm() -> None:
    simulate(Experiment.from_document({"simulation": {"horizon": 0.1}}))
    assert is_warm()
    assert CACHE.is_dir()
