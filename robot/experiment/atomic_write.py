"""Writes a file whole or not at all, and takes nobody else's name unless told to."""

from __future__ import annotations

import errno
import os
import tempfile
from pathlib import Path

_NO_HARD_LINKS = (errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK)


def atomic_write(path: Path, content: bytes, overwrite: bool) -> None:
    """Write a file so that a reader sees the old content or the new one, never a part.

    Args:
        path: the file; its folder exists.
        content: all of it.
        overwrite: whether an existing file gives way. Without it, one of two writers at the same
            moment wins and the other is refused.

    Raises:
        FileExistsError: if the name is taken and ``overwrite`` is off.
        OSError: if the folder can't be written.
    """
    number, temporary = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".tmp")
    try:
        with os.fdopen(number, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if overwrite:
            os.replace(temporary, path)
        else:
            _take_free_name(temporary, path)
    finally:
        Path(temporary).unlink(missing_ok=True)


def _take_free_name(temporary: str, path: Path) -> None:
    try:
        os.link(temporary, path)
    except FileExistsError:
        raise
    except OSError as error:
        # Memory cards and some network folders know no hard links.
        if error.errno not in _NO_HARD_LINKS:
            raise
        # The name is taken empty, so that only one writer gets it, and filled at one stroke.
        path.open("xb").close()
        try:
            os.replace(temporary, path)
        except OSError:
            path.unlink(missing_ok=True)
            raise
