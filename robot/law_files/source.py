"""A law's own file as it was read, and the copy of it that is run.

The copy lies beside the compiled kernels, under the digest of its content: so what numba has kept
of it always belongs to it, however fast the file itself is saved again, and every process that runs
the same content shares it.
"""

from __future__ import annotations

import hashlib
import shutil
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from slidetune.robot.experiment.atomic_write import atomic_write
from slidetune.robot.kernels.compiler import CACHE
from slidetune.robot.law_files.refused import LawFileError

LONGEST = 256 * 1024
"""Most bytes of a law's own file (*ours*)."""
KEPT = 20
"""Versions of files that are kept, some 0.1 MB each (*ours*)."""
_FOLDER = CACHE / "own"
_NAME = "law.py"


@dataclass(frozen=True)
class Source:
    """The content of a law's own file.

    Attributes:
        name: the file's own name, as people are told of it.
        text: what is in it.
    """

    name: str
    text: str

    @cached_property
    def digest(self) -> str:
        """A name of the content that no other content has."""
        return hashlib.sha256(self.text.encode()).hexdigest()[:16]

    @property
    def path(self) -> Path:
        """Where the copy lies that is run."""
        return _FOLDER / self.digest / _NAME

    def keep(self) -> None:
        """Write the copy, and remove those of long ago."""
        if not self.path.exists():
            self.path.parent.mkdir(parents=True, exist_ok=True)
            atomic_write(self.path, self.text.encode(), overwrite=True)
        self.path.parent.touch()
        others = sorted(_FOLDER.iterdir(), key=lambda folder: folder.stat().st_mtime)
        for old in others[:-KEPT]:
            for folder in (old, *CACHE.glob(f"{old.name}_*")):  # numba's is named for that one
                shutil.rmtree(folder, ignore_errors=True)


def read_source(path: Path) -> Source:
    """Read a law's own file.

    Raises:
        LawFileError: if it can't be read, is too long, or is not UTF-8.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise LawFileError(path.name, f"can't be read: {error.strerror}") from error
    if len(content) > LONGEST:
        raise LawFileError(path.name, f"is longer than {LONGEST // 1024} KiB")
    with suppress(UnicodeDecodeError):
        return Source(path.name, content.decode())
    raise LawFileError(path.name, "is not text in UTF-8")
