"""Compiled kernels: kept on disk, and never run stale."""

from __future__ import annotations

import ast
import importlib
import os
import stat
import tempfile
from pathlib import Path
from types import ModuleType

import numba
import pytest

from slidetune import robot
from slidetune.robot.kernels import compiler
from slidetune.robot.kernels.compiler import CACHE, is_warm, kernel
from slidetune.robot.laws.terms.switching import switch
from slidetune.robot.loop.warmup import warm_up

FOLDER = Path(robot.__file__).parent
KERNEL_FILES = [
    path
    for path in sorted(FOLDER.rglob("*.py"))
    if any(line.startswith(("@kernel", "@inlined")) for line in path.read_text().splitlines())
]


def path_in_robot(path: Path) -> str:
    return path.relative_to(FOLDER).as_posix()


def module_of(path: Path) -> ModuleType:
    parts = path.relative_to(FOLDER).with_suffix("").parts
    return importlib.import_module(".".join(["slidetune.robot", *parts]))


def origins(path: Path) -> dict[str, str]:
    """Return the names that a file imports from this package, and the files that define them."""
    found = {}
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("slidetune.robot"):
            file = module_of_name(str(node.module))
            found |= {alias.asname or alias.name: file for alias in node.names}
    return found


def module_of_name(name: str) -> str:
    return path_in_robot(Path(str(importlib.import_module(name).__file__)))


def test_there_are_kernels() -> None:
    assert len(KERNEL_FILES) > 10


@pytest.mark.parametrize("path", KERNEL_FILES, ids=path_in_robot)
def test_numbers_compiled_into_a_kernel_come_from_files_that_renew_it(path: Path) -> None:
    module, known = module_of(path), origins(path)
    renewing = set(map(path_in_robot, KERNEL_FILES)) | set(compiler._CONSTANTS)
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


def test_warming_up_leaves_the_kernels_warm() -> None:
    warm_up()
    assert is_warm()
    assert CACHE.is_dir()


@pytest.fixture
def homeless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Take the cache folder away, and return the temporary folder that is left."""
    (tmp_path / "file").write_text("")
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(compiler.platformdirs, "user_cache_dir", lambda _: tmp_path / "file" / "x")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    monkeypatch.setenv(compiler._HANDED_ON, "")
    return tmp_path / "tmp"


def test_kernels_without_a_cache_folder_go_to_a_private_one_that_is_found_again(
    homeless: Path,
) -> None:
    folder = compiler._folder()
    assert folder.parent == homeless / f"slidetune-{os.getuid()}"
    assert stat.S_IMODE(folder.parent.stat().st_mode) == 0o700
    assert compiler._folder() == folder


def test_kernels_of_a_folder_that_can_not_be_written_are_taken_from_there(
    homeless: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ready = homeless / "image" / "kernels" / compiler._digest()
    (ready / "laws").mkdir(parents=True)
    (ready / "laws" / "smc.nbi").write_text("compiled")
    monkeypatch.setattr(compiler.platformdirs, "user_cache_dir", lambda _: homeless / "image")

    def refuse(_: Path) -> None:
        raise PermissionError

    monkeypatch.setattr(compiler, "_forget_old", refuse)  # root may write anywhere
    folder = compiler._folder()
    assert folder.parent == homeless / f"slidetune-{os.getuid()}"
    assert (folder / "laws" / "smc.nbi").read_text() == "compiled"
    (folder / "laws" / "smc.nbi").write_text("newer")
    assert compiler._folder() == folder
    assert (folder / "laws" / "smc.nbi").read_text() == "newer"
    assert {path.name for path in folder.parent.iterdir()} == {folder.name}


@pytest.mark.parametrize("kind", ["open", "link", "file"])
def test_a_folder_that_others_could_fill_is_never_run_from_nor_stops_the_start(
    homeless: Path, kind: str
) -> None:
    foreign = homeless / f"slidetune-{os.getuid()}"
    if kind == "open":
        foreign.mkdir()
        foreign.chmod(0o777)
    elif kind == "link":
        (homeless / "theirs").mkdir(mode=0o700)
        foreign.symlink_to(homeless / "theirs")
    else:
        foreign.write_text("")
    folder = compiler._folder()
    assert foreign not in folder.parents
    assert folder.resolve() == folder
    assert stat.S_IMODE(folder.parent.stat().st_mode) == 0o700
    assert compiler._folder() == folder  # in the processes that this one starts, too
