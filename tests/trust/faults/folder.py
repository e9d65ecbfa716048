"""Folders in which nothing can be written: full ones and closed ones, as real as we may."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

SMALL_FILE = 4096
"""Size in bytes that a file may have where a full disk can only be played (*ours*): the small
preset goes in, the big one doesn't."""


@dataclass(frozen=True)
class FullFolder:
    """A folder that can be made to refuse what is written.

    Attributes:
        path: the folder.
        how: how it is done, in words.
        fill: lets writing fail from now on.
        free: lets it work again, ``None`` where that can't be.
        prepare: to be called in the server's process before it begins, if anything.
    """

    path: Path
    how: str
    fill: Callable[[], None]
    free: Callable[[], None] | None
    prepare: Callable[[], None] | None = None


def _mounted(path: Path) -> bool:
    """Mount a disk of 256 kB in memory, where we may."""
    if sys.platform != "linux" or os.geteuid() != 0:
        return False
    command = ["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(path)]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


@contextmanager
def _disk() -> Iterator[tuple[Path, bool]]:
    """Yield an empty folder and whether it is a disk of its own."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "presets"
        path.mkdir()
        mounted = _mounted(path)
        try:
            yield path, mounted
        finally:
            if mounted:
                subprocess.run(["umount", "--lazy", str(path)], check=True)


@contextmanager
def full_folder() -> Iterator[FullFolder]:
    """Yield a folder on a disk that can be filled up."""
    with _disk() as (path, mounted):
        ballast = path / ".ballast"

        def fill() -> None:
            with suppress(OSError), ballast.open("wb", buffering=0) as file:
                while True:
                    file.write(bytes(4096))

        def limit() -> None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (SMALL_FILE, SMALL_FILE))

        if mounted:
            yield FullFolder(path, "on a real disk of 256 kB", fill, ballast.unlink)
        else:
            how = f"with a limit of {SMALL_FILE // 1024} kB a file (no right to mount a disk)"
            yield FullFolder(path, how, lambda: None, None, limit)


@contextmanager
def closed_folder() -> Iterator[FullFolder]:
    """Yield a folder that can be closed to writing."""
    with _disk() as (path, mounted):

        def remount(option: str) -> Callable[[], None]:
            command = ["mount", "-o", f"remount,{option}", str(path)]
            return lambda: subprocess.run(command, check=True) and None

        if mounted:
            how = "on a disk that is mounted read-only"
            yield FullFolder(path, how, remount("ro"), remount("rw"))
        else:
            how = "by its permissions, 0555"
            yield FullFolder(path, how, lambda: path.chmod(0o555), lambda: path.chmod(0o755))
