"""Where a command writes its results: standard output, or a file, whole or not at all."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from slidetune.robot.errors import SlidetuneError

STANDARD = "-"
"""Name that stands for standard output, as in other tools."""


class OutputError(SlidetuneError, ValueError):
    """A place where no results can be written."""


def check_outputs(*names: str) -> None:
    """Refuse bad places before the work begins; empty names count for nothing.

    Raises:
        OutputError: if a folder is missing or a folder itself is named, or if two results would
            go to the same place.
    """
    given = [name for name in names if name]
    for number, name in enumerate(given):
        path = Path(name)
        if any(_same_place(name, other) for other in given[:number]):
            place = "standard output" if name == STANDARD else name
            raise OutputError(f"two results can't both go to {place}: name two files")
        if name == STANDARD:
            continue
        if path.is_dir():
            raise OutputError(f"can't write to {name}: it is a folder, name a file in it")
        if not path.parent.is_dir():
            raise OutputError(f"can't write {name}: there is no folder {path.parent}")


def _same_place(name: str, other: str) -> bool:
    """Whether two names, such as ``r`` and ``./r``, are one file's or would be."""
    if STANDARD in (name, other):
        return name == other
    if os.path.realpath(name) == os.path.realpath(other):
        return True
    with suppress(OSError):
        return os.path.samefile(name, other) and Path(name).is_file()
    return False


def write_output(name: str, parts: Iterable[str] | Iterable[bytes]) -> None:
    """Write text or bytes piece by piece; an existing file gives way only to a complete new one.

    Args:
        name: a file, or ``-`` for standard output.
        parts: the text, or the bytes, in order.

    Raises:
        OSError: naming the file, if it can't be written; one that was there is as before.
    """
    try:
        _write(name, parts)
    except BrokenPipeError:
        raise
    except OSError as error:
        place = "to standard output" if name == STANDARD else name
        raise OSError(f"can't write {place}: {error.strerror or error}") from error


def _write(name: str, parts: Iterable[str] | Iterable[bytes]) -> None:
    encoded = (part.encode() if isinstance(part, str) else part for part in parts)
    if name == STANDARD:
        sys.stdout.buffer.writelines(encoded)
        sys.stdout.flush()
        return
    path = Path(os.path.realpath(name))  # a link stays a link: its target is replaced
    if path.exists() and not path.is_file():  # a pipe or a device has nothing to replace
        with path.open("wb") as file:
            file.writelines(encoded)
    else:
        _replace(path, encoded)


def _replace(path: Path, parts: Iterable[bytes]) -> None:
    number, temporary = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".tmp")
    try:
        with os.fdopen(number, "wb") as file:
            file.writelines(parts)
        Path(temporary).chmod(_mode(path))
        os.replace(temporary, path)
    finally:
        Path(temporary).unlink(missing_ok=True)


def _mode(path: Path) -> int:
    """Return the permissions that a file of this name has, or would get if it were new."""
    if path.exists():
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
