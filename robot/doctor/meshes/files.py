"""Finds the files of meshes, also where a description names the folders of another machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

FORMATS = (".stl", ".obj", ".dae", ".glb")
"""Formats of meshes that are read."""
_NO_FILE = ("http:", "https:", "ftp:", "data:")


@dataclass(frozen=True)
class Found:
    """What became of a search.

    Attributes:
        path: the file, ``None`` if there is none.
        how: plainly as named, in another case of letters, or elsewhere than named.
        looked: the folders it was looked for in, first ones first.
    """

    path: Path | None
    how: Literal["named", "other case", "elsewhere"] = "named"
    looked: tuple[Path, ...] = ()


@dataclass(frozen=True)
class _Reference:
    """A mesh's name taken apart: whether the path is absolute, its package, its parts."""

    absolute: Path | None
    package: str
    parts: tuple[str, ...]


def _reference(filename: str) -> _Reference:
    name, package = filename.strip().replace("\\", "/"), ""
    for scheme in ("package://", "model://"):
        if name.startswith(scheme):
            # Three slashes are a common slip.
            package, _, name = name[len(scheme) :].lstrip("/").partition("/")
            return _Reference(None, package, _parts(name))
    name = name.removeprefix("file://")
    drive = len(name) > 2 and name[1:3] == ":/"
    absolute = Path(name) if name.startswith("/") else None
    return _Reference(absolute, "", _parts(name[3:] if drive else name))


def _parts(name: str) -> tuple[str, ...]:
    return tuple(part for part in name.split("/") if part not in ("", "."))


class MeshFiles:
    """The folders in which meshes are looked for."""

    def __init__(
        self, urdf: Path, package_dirs: Sequence[Path], within: Path | None = None
    ) -> None:
        """Look in the package folders and their parents, and in the URDF's own ancestors.

        Args:
            urdf: the description.
            package_dirs: folders in which, or beside which, packages lie.
            within: the folder outside of which no file is looked for, whatever a mesh names.
        """
        self._within = None if within is None else within.resolve()
        folder = urdf.absolute().parent
        given = [path.absolute() for path in package_dirs]
        roots = [*given, *(path.parent for path in given), folder, *folder.parents]
        self._folder = folder
        self._near = dict.fromkeys([*given, folder])
        # A whole disk is no place to look for what is called alike.
        self._roots = [
            root for root in dict.fromkeys(roots) if root.parent != root and self._allows(root)
        ]
        self._listing = cache(_listing)

    def find(self, filename: str) -> Found:
        """Return where a mesh is, as a URDF names it."""
        if filename.strip().lower().startswith(_NO_FILE) or "\0" in filename:
            return Found(None)
        reference = _reference(filename)
        if not reference.parts:
            return Found(None)
        plain = list(self._plain(reference))
        for path in plain:
            if self._is_file(path):
                return Found(path)
        for path in plain:
            found = self._in_any_case(path)
            if found is not None:
                return Found(found, "other case")
        for path in self._elsewhere(reference):
            found = path if self._is_file(path) else self._in_any_case(path)
            if found is not None:
                return Found(found, "elsewhere")
        return Found(None, looked=tuple(dict.fromkeys(self._looked(reference))))

    def _plain(self, reference: _Reference) -> Iterator[Path]:
        """Yield where the file is if all is as it should be."""
        if reference.absolute is not None:
            yield reference.absolute
        elif not reference.package:
            yield self._folder.joinpath(*reference.parts)
        else:
            for root in self._roots:
                yield root.joinpath(reference.package, *reference.parts)
                if root.name == reference.package:
                    yield root.joinpath(*reference.parts)

    def _elsewhere(self, reference: _Reference) -> Iterator[Path]:
        """Yield places whose last folders are called as in the file, most of them first."""
        parts = reference.parts
        if ".." in parts:
            parts = parts[len(parts) - parts[::-1].index("..") :]
        for first in range(len(parts)):
            # The bare name of a file tells little: taken only from the arm's own folders.
            for root in self._roots if first < len(parts) - 1 else self._near:
                yield root.joinpath(*parts[first:])

    def _looked(self, reference: _Reference) -> Iterator[Path]:
        for path in self._plain(reference):
            if self._allows(path):
                yield path.parent
        yield from self._near

    def _in_any_case(self, path: Path) -> Path | None:
        """Return a file whose path differs in capitals only, below the folders of the search."""
        root = next((root for root in self._roots if path.is_relative_to(root)), None)
        if root is None or ".." in path.parts:
            return None
        found = root
        for part in path.relative_to(root).parts:
            names = self._listing(found)
            name = part if part in names else names.get(part.lower(), "")
            if not name:
                return None
            found = found / name
        return found if self._is_file(found) else None

    def _allows(self, path: Path) -> bool:
        """Whether a path, with all links and dots followed, lies where it may be looked for."""
        try:
            return self._within is None or path.resolve().is_relative_to(self._within)
        except (OSError, ValueError):
            return False

    def _is_file(self, path: Path) -> bool:
        try:
            return self._allows(path) and path.is_file()
        except (OSError, ValueError):
            return False


def _listing(folder: Path) -> dict[str, str]:
    """Return what a folder holds, by its name and by its name in small letters."""
    try:
        names = sorted(entry.name for entry in folder.iterdir())
    except OSError:
        return {}
    return {name.lower(): name for name in names} | {name: name for name in names}
