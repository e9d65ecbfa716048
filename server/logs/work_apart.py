"""What is done with a log in a process of its own: read, smoothed, fitted."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath
from shutil import copyfileobj
from typing import IO, Any

from slidetune.robot.errors import FieldError, InvalidExperimentError, SlidetuneError
from slidetune.robot.fields.written_value import written
from slidetune.server.compute.apart import LostProcessError, ask_apart

_LIMIT = 180.0
"""Longest time that one may take in [s] (*ours*): 200 MB of CSV take some 40."""
_MODULE = "slidetune.server.logs.child"
_LONGEST_NAME = 200
"""Most bytes of a file's name (*ours*)."""


class LogStorageError(SlidetuneError, OSError):
    """A log that can't be kept."""


class RefusedLogError(SlidetuneError, ValueError):
    """A log that can't be used, with row and column where one of them is to blame."""

    def __init__(self, reason: Mapping[str, Any]) -> None:
        """Keep what was said of it."""
        text = str(reason["message"])
        super().__init__(text)
        place = str(reason["column"]) or "file"
        self.fields = (FieldError(place, text, reason["value"], line=reason["row"]),)


def read_apart(
    name: str, content: IO[bytes], arm: str, wanted: Mapping[str, Any], archive: Path
) -> dict[str, Any]:
    """Read a file that was sent, in a process of its own.

    Args:
        name: under which it was sent.
        content: what is in it.
        arm: the arm whose joints its columns are.
        wanted: see ``Wanted``, as plain values.
        archive: where the numbers go.

    Returns:
        ``columns``, ``sources``, ``joints``, ``mapping`` and either ``log`` or ``reason``.

    Raises:
        RefusedLogError: if it is no recording, whatever is said of it.
        LogStorageError: if there is no room for it.
    """
    try:
        with tempfile.TemporaryDirectory(prefix="slidetune-log-") as folder:
            path = Path(folder) / _file_name(name)
            with path.open("wb") as file:
                copyfileobj(content, file, 1 << 20)
            asked = {"path": str(path), "arm": arm, "wanted": dict(wanted)}
            return _ask("read", archive, asked)
    except OSError as error:
        if isinstance(error, SlidetuneError):
            raise
        raise LogStorageError(f"the log can't be written: {error.strerror or error}") from error


def trajectory_apart(archive: Path, arm: str, spacing: float | None) -> dict[str, Any]:
    """Return a log as desired motion, made in a process of its own; see ``reference_of``.

    Raises:
        RefusedLogError: if it can't be one.
    """
    return _ask("trajectory", archive, {"arm": arm, "spacing": spacing})


def identify_apart(
    archive: Path,
    arm: str,
    robot: Mapping[str, Any],
    parts: Sequence[str],
    constants: Sequence[float] | None,
    load: Sequence[float] | float,
) -> dict[str, Any]:
    """Return what a log says of the arm, fitted in a process of its own; see ``identify``.

    Raises:
        RefusedLogError: if it can't tell anything.
    """
    asked = {"arm": arm, "robot": robot, "parts": list(parts), "constants": constants, "load": load}
    return _ask("identify", archive, asked)


def _ask(kind: str, archive: Path, asked: Mapping[str, Any]) -> dict[str, Any]:
    try:
        answer: dict[str, Any] = ask_apart(
            _MODULE, {"kind": kind, "archive": str(archive), **asked}, _LIMIT
        )
    except LostProcessError as error:
        text = f"the log can't be used: what works on it {error.text}"
        raise RefusedLogError({"message": text, "row": None, "column": "", "value": ""}) from error
    if "refused" in answer:
        raise RefusedLogError(answer["refused"])
    return answer


def _file_name(sent: str) -> str:
    """Return the last part of the path that a file was sent under, as a plain file name."""
    name = PurePosixPath(sent.replace("\\", "/")).name
    if not name or name == ".." or not name.isprintable() or len(name.encode()) > _LONGEST_NAME:
        text = f"{written(sent)} is no name of a file"
        raise InvalidExperimentError([FieldError("file", text, sent)])
    return name
