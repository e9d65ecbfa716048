"""Named experiments: those that ship, read-only, and the user's own."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path

import platformdirs

from slidetune.robot.errors import (
    InvalidExperimentError,
    PresetConflictError,
    PresetStorageError,
    SlidetuneError,
    UnknownPresetError,
)
from slidetune.robot.experiment.atomic_write import atomic_write
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.permalink import Linked, is_permalink, permalink, read_permalink
from slidetune.robot.experiment.plain_yaml import LARGEST_TEXT
from slidetune.robot.experiment.preset_name import (
    LONGEST_NAME,
    is_preset_name,
    name_rule,
    refused_name,
)
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.laws import LAWS

USER_FOLDER_VARIABLE = "SLIDETUNE_PRESETS"
"""Environment variable that names another folder for the user's presets."""
SHIPPED_FOLDER = Path(__file__).resolve().parents[2] / "presets"
"""Beside this package, in a checkout and in an installed wheel alike."""
KEPT = 512
"""Presets that are kept as they were read (*ours*), about 30 kB each: more than one list shows."""
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_CLOSED = (errno.EACCES, errno.EPERM, errno.EROFS)


@dataclass(frozen=True)
class PresetInfo:
    """What a list of presets shows.

    Attributes:
        name: name to load it by.
        title: name on the screen.
        description: what to look at.
        shipped: whether it ships with the program and is read-only.
        problem: why it can't be loaded, or an empty text.
    """

    name: str
    title: str
    description: str
    shipped: bool
    problem: str = ""


@lru_cache(maxsize=KEPT)
def _parsed(content: bytes, origin: str, _: tuple[str, ...]) -> Experiment | InvalidExperimentError:
    try:
        return experiment_from_yaml(content, origin)
    except InvalidExperimentError as error:
        return error  # kept as well: a list shows why each broken file can't be loaded


def info_of(name: str, experiment: Experiment, shipped: bool) -> PresetInfo:
    """Return what a list shows of a preset that can be loaded."""
    return PresetInfo(name, experiment.title or name, experiment.description, shipped)


def read_preset(path: Path) -> Experiment:
    """Read an experiment from a YAML file.

    Raises:
        UnknownPresetError: if there is no such file, or it can't be read.
        InvalidExperimentError: naming every refused field with its line.
    """
    try:
        if not path.is_file():
            raise UnknownPresetError(f"no preset file {path}")
        with path.open("rb") as file:
            content = file.read(LARGEST_TEXT + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UnknownPresetError(f"can't read preset file {str(path)[:200]!r}: {reason}") from error
    # What a law's own file makes of it is another experiment when the file is another one.
    parsed = _parsed(content, path.name, tuple(law.version for law in LAWS.values()))
    if isinstance(parsed, InvalidExperimentError):
        raise copy(parsed)  # a fresh one: every raise adds to its traceback
    return parsed


@dataclass(frozen=True)
class PresetStore:
    """Presets in two folders, one YAML file each.

    Attributes:
        shipped: folder of those that ship; never written.
        user: folder of the user's own; made when the first one is saved.
    """

    shipped: Path
    user: Path

    def infos(self) -> list[PresetInfo]:
        """Return all presets: the shipped ones first, each kind by name.

        A file that can't be read is listed with its ``problem``.
        """
        return [
            *(self._info(path, True) for path in _files(self.shipped)),
            *(self._info(path, False) for path in _files(self.user)),
        ]

    def load(self, name: str) -> Experiment:
        """Return the preset of a name; never a file outside the two folders.

        Raises:
            UnknownPresetError: listing the known ones.
            InvalidExperimentError: if its file is broken.
        """
        return read_preset(self._find(name))

    def save(self, name: str, experiment: Experiment, overwrite: bool = False) -> Path:
        """Write one of the user's presets, whole or not at all.

        Args:
            name: its name; see ``preset_name`` for making one of a title.
            experiment: what to save.
            overwrite: whether it may take the place of another of the user's.

        Returns:
            The file.

        Raises:
            InvalidExperimentError: for a name that can't be a file's.
            PresetConflictError: if a preset of that name ships, or exists and may not be
                overwritten.
            PresetStorageError: if the folder can't be written.
        """
        if not is_preset_name(name):
            raise refused_name(name)
        if self.is_shipped(name):
            text = f"preset {name} ships with Slidetune and is read-only: choose another name"
            raise PresetConflictError(text)
        path = self.user / f"{name}.yaml"
        content = experiment_to_yaml(experiment).encode()
        with self._writing(f"save preset {name}"):
            self.user.mkdir(parents=True, exist_ok=True)
        with self._writing(f"save preset {name}"):
            try:
                atomic_write(path, content, overwrite)
            except FileExistsError as error:
                text = f"preset {name} exists: choose another name, or overwrite it on purpose"
                raise PresetConflictError(text) from error
        return path

    def delete(self, name: str) -> None:
        """Remove one of the user's presets.

        Raises:
            PresetConflictError: if it ships.
            UnknownPresetError: listing the known ones.
            PresetStorageError: if the folder can't be written.
        """
        path = self._find(name)
        if path.parent == self.shipped:
            raise PresetConflictError(f"preset {name} ships with Slidetune and is read-only")
        with self._writing(f"delete preset {name}"):
            path.unlink(missing_ok=True)

    def is_shipped(self, name: str) -> bool:
        """Whether a preset of that name ships with the program."""
        return is_preset_name(name) and (self.shipped / f"{name}.yaml").is_file()

    @contextmanager
    def _writing(self, action: str) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            text = f"can't {action} in {self.user}: {error.strerror or error}"
            raise PresetStorageError(f"{text}{_way_out(error)}") from error

    def _find(self, name: str) -> Path:
        if is_preset_name(name):
            for folder in (self.shipped, self.user):
                if (path := folder / f"{name}.yaml").is_file():
                    return path
        known = sorted({path.stem for path in (*_files(self.shipped), *_files(self.user))})
        close = get_close_matches(name[:LONGEST_NAME].lower(), known, n=1)
        hint = f"; did you mean {close[0]}?" if close else "."
        text = f"no preset {name[:LONGEST_NAME]!r}{hint} Known: {', '.join(known)}"
        raise UnknownPresetError(text)

    def _info(self, path: Path, shipped: bool) -> PresetInfo:
        name, problem = path.stem, ""
        if not is_preset_name(name):
            problem = f"rename the file: {name_rule(name)}"
        elif not shipped and self.is_shipped(name):
            problem = "rename the file: a preset of that name ships with Slidetune"
        if not problem:
            try:
                experiment = read_preset(path)
            except SlidetuneError as error:
                problem = str(error)
            else:
                return info_of(name, experiment, shipped)
        return PresetInfo(name, name, "", shipped, problem)


def _way_out(error: OSError) -> str:
    """Return what to do about a folder that can't be written, if that is known."""
    if error.errno in _FULL:
        return "; nothing was changed: free some space and try again"
    if error.errno in _CLOSED:
        return (
            "; nothing was changed: allow writing there, or name another folder with "
            f"{USER_FOLDER_VARIABLE}"
        )
    return ""


def _files(folder: Path) -> Iterator[Path]:
    files = sorted(folder.glob("*.yaml"), key=lambda path: path.stem)
    return (path for path in files if not path.name.startswith("."))


def preset_store() -> PresetStore:
    """Return the store of this user: ``SLIDETUNE_PRESETS``, or the user's data folder."""
    folder = os.environ.get(USER_FOLDER_VARIABLE)
    user = Path(folder) if folder else Path(platformdirs.user_data_dir("slidetune")) / "presets"
    return PresetStore(SHIPPED_FOLDER, user)


def load_preset(name_or_path: str | os.PathLike[str]) -> Experiment:
    """Return a preset by name, an experiment from a YAML file by path, or that of a link.

    Args:
        name_or_path: a name such as ``paper``, shipped or the user's own; a text with a slash or a
            ``.yaml`` is a path; an address with ``#x=`` is a link, see ``link_to``.

    Raises:
        UnknownPresetError: listing the known names.
        InvalidExperimentError: naming every refused field with its line.
    """
    text = os.fspath(name_or_path)
    if isinstance(name_or_path, str) and is_permalink(text):
        return read_link(text).experiment
    is_path = not isinstance(name_or_path, str) or re.search(r"[/\\]|\.ya?ml$", text)
    return read_preset(Path(text)) if is_path else preset_store().load(text)


def link_to(experiment: Experiment) -> str:
    """Return a text that stands for an experiment wherever this version of Slidetune runs.

    Raises:
        InvalidExperimentError: if it would be too long.
    """
    names = [path.stem for path in _files(SHIPPED_FOLDER)]
    return permalink(experiment, [(name, _shipped(name)) for name in names])


def read_link(link: str, despite: bool = False) -> Linked:
    """Return what a link, or an address with one, stands for; see ``read_permalink``."""
    return read_permalink(link, _shipped, despite)


def _shipped(name: str) -> Experiment:
    return PresetStore(SHIPPED_FOLDER, SHIPPED_FOLDER).load(name)


def presets() -> list[PresetInfo]:
    """Return all presets: the shipped ones first, each kind by name."""
    return preset_store().infos()


def save_preset(name: str, experiment: Experiment, overwrite: bool = False) -> Path:
    """Write one of the user's presets, whole or not at all.

    Args:
        name: made of a to z, 0 to 9 and ``-``.
        experiment: what to save.
        overwrite: whether it may take the place of another of the user's.

    Returns:
        The file.

    Raises:
        InvalidExperimentError: for a name that can't be a file's.
        PresetConflictError: if a preset of that name ships, or exists and may not be overwritten.
        PresetStorageError: if the folder can't be written.
    """
    return preset_store().save(name, experiment, overwrite)


def delete_preset(name: str) -> None:
    """Remove one of the user's presets; see ``PresetStore.delete``."""
    preset_store().delete(name)
