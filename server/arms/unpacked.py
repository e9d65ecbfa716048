"""Files that somebody has sent, laid out in a folder: a URDF, its meshes, or a ZIP of them."""

from __future__ import annotations

import stat
import zipfile
import zlib
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from typing import IO

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.fields.written_value import written

MOST_FILES = 2000
"""Most files of one arm (*ours*)."""
MOST_BYTES = 500_000_000
"""Most bytes of them, unpacked (*ours*)."""
_PIECE = 1 << 20
_MOST_NAMES = 12
"""Most names that a text lists (*ours*)."""
_NO_ZIP = (zipfile.BadZipFile, zlib.error, NotImplementedError, EOFError, ValueError, RuntimeError)
_DEEPEST = 20
"""Most folders in each other (*ours*)."""


def refused(text: str, value: object = None, field: str = "files") -> InvalidExperimentError:
    """Return a refusal of what was sent."""
    return InvalidExperimentError([FieldError(field, text, value)])


class Unpacked:
    """A folder that is filled, within limits and with nothing outside of it."""

    def __init__(self, root: Path) -> None:
        """Begin with nothing in ``root``."""
        self.root = root
        self._files = 0
        self._bytes = 0

    def take(self, name: str, content: IO[bytes]) -> None:
        """Write one file, or all of a ZIP.

        Args:
            name: path that it is sent under.
            content: what is in it.

        Raises:
            InvalidExperimentError: if its name leads elsewhere, or there is too much of it.
        """
        if name.lower().endswith(".zip"):
            self._take_zip(name, content)
        else:
            self._write(name, content)

    def _take_zip(self, name: str, content: IO[bytes]) -> None:
        try:
            with zipfile.ZipFile(content) as archive:
                for entry in archive.infolist():
                    if entry.is_dir():
                        continue
                    if stat.S_ISLNK(entry.external_attr >> 16):
                        raise refused(f"{written(entry.filename)} in {written(name)} is a link")
                    with archive.open(entry) as file:
                        self._write(entry.filename, file)
        except InvalidExperimentError:
            raise
        except _NO_ZIP as error:
            text = f"{written(name)} is no ZIP that can be read: {written(str(error))}"
            raise refused(text) from error

    def _write(self, name: str, content: IO[bytes]) -> None:
        place = self.root.joinpath(*_parts(name))
        self._files += 1
        if self._files > MOST_FILES:
            raise refused(f"an arm may have at most {MOST_FILES} files")
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            with place.open("xb") as file:
                while piece := content.read(_PIECE):
                    self._bytes += len(piece)
                    if self._bytes > MOST_BYTES:
                        raise refused(f"an arm may have at most {MOST_BYTES:,} bytes, unpacked")
                    file.write(piece)
        except (FileExistsError, NotADirectoryError, IsADirectoryError) as error:
            raise refused(f"{written(name)} was sent twice, as a file or a folder") from error

    def urdf(self, chosen: str = "") -> Path:
        """Return the description among the files.

        Args:
            chosen: its path where there are several.

        Raises:
            InvalidExperimentError: if there is none, or which one isn't clear; says the names.
        """
        found = {
            path.relative_to(self.root).as_posix(): path
            for path in sorted(self.root.rglob("*"))
            if path.suffix.lower() in _DESCRIPTIONS and path.is_file()
        }
        urdfs = {name: path for name, path in found.items() if name.lower().endswith(".urdf")}
        known = urdfs or found
        if chosen:
            if chosen in found:
                return found[chosen]
            raise refused(f"no {written(chosen)} among the files: {_names(found)}", chosen, "urdf")
        if len(known) == 1:
            return next(iter(known.values()))
        if not known:
            raise refused("no URDF among the files: send a .urdf file, or a ZIP with it")
        text = f"choose one of the descriptions: {_names(known)}"
        raise InvalidExperimentError([FieldError("urdf", text, "", "\n".join(known))])


_DESCRIPTIONS = (".urdf", ".xml", ".xacro", ".sdf", ".mjcf")


def _parts(name: str) -> list[str]:
    """Return the folders and the file that a name consists of; none of them leads out."""
    path = PurePosixPath(name.replace("\\", "/"))
    parts = [part for part in path.parts if part not in (".", "/")]
    bad = not parts or len(parts) > _DEEPEST or any(_is_bad(part) for part in parts)
    if bad or path.is_absolute():
        raise refused(f"{written(name)} is no path of a file within a folder")
    return parts


def _is_bad(part: str) -> bool:
    return part == ".." or len(part.encode()) > 255 or not part.isprintable() or ":" in part


def _names(known: Iterable[str]) -> str:
    names = [written(name) for name in known]
    more = len(names) - _MOST_NAMES
    shown = ", ".join(names[:_MOST_NAMES])
    return f"{shown} and {more} more" if more > 0 else shown
