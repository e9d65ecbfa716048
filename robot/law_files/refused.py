"""What is wrong with a law's own file, with the lines of it that led there."""

from __future__ import annotations

import linecache
import traceback
from pathlib import Path

from slidetune.robot.errors import SlidetuneError

MOST_LINES = 60
"""Most lines of a traceback that are told (*ours*): numba writes hundreds."""


class LawFileError(SlidetuneError, ValueError):
    """A law's own file that can't be used.

    Attributes:
        file: its name.
        message: what is wrong, in one line.
        trace: the way there through its lines, empty where no line is to blame.
    """

    def __init__(self, file: str, message: str, trace: str = "") -> None:
        """Make one text of them."""
        self.file, self.message, self.trace = file, message, trace
        super().__init__(f"{trace}\n{file}: {message}" if trace else f"{file}: {message}")

    def __reduce__(self) -> tuple[object, ...]:
        """Travel between processes whole."""
        return type(self), (self.file, self.message, self.trace)


def refused_by(error: Exception, file: str, copy: Path) -> LawFileError:
    """Return what an exception means for a law's own file.

    Args:
        error: what was raised while it was read or run.
        file: the file's own name.
        copy: the copy of it that was run.
    """
    if isinstance(error, LawFileError):
        return error
    lines = trace_of(error, {str(copy): file})
    last = lines[-1] if lines else type(error).__name__
    return LawFileError(file, _one_line(error, file, copy), "\n".join([*lines[:-1], last]))


def trace_of(error: BaseException, names: dict[str, str]) -> list[str]:
    """Return the lines of a traceback, as far as it goes through some files.

    Args:
        error: what was raised.
        names: names of files as people know them, by the path under which they are run.
    """
    frames = [
        frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename in names
    ]
    told = []
    for frame in frames:
        told.append(f'File "{names[frame.filename]}", line {frame.lineno}, in {frame.name}')
        line = linecache.getline(frame.filename, frame.lineno or 0).strip()
        told += [f"    {line}"] if line else []
    text = "".join(traceback.format_exception_only(error))
    for path, name in names.items():
        text = text.replace(path, name)
    told += [line.rstrip() for line in text.splitlines() if line.strip()]
    if len(told) > MOST_LINES:
        told = [*told[:MOST_LINES], "…"]
    return told


def _one_line(error: Exception, file: str, copy: Path) -> str:
    """Return the exception itself in one line, with the line of the file to blame."""
    place: int | None = None
    if isinstance(error, SyntaxError):
        place, text = error.lineno, f"{type(error).__name__}: {error.msg}"
    else:
        frames = traceback.extract_tb(error.__traceback__)
        ours = [frame.lineno for frame in frames if frame.filename == str(copy)]
        place = ours[-1] if ours else None
        first = str(error).replace(str(copy), file).strip().partition("\n")[0]
        text = f"{type(error).__name__}: {first}" if first else type(error).__name__
    return f"line {place}: {text}" if place else text
