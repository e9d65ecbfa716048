"""Tries a law's own file in a process of its own, which is ended where it doesn't come back."""

from __future__ import annotations

from typing import Any

from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.law_files.source import Source
from slidetune.server.compute.apart import LostProcessError, ask_apart

LIMIT = 120.0
"""Longest time that a trial may take in [s] (*ours*): to compile a law takes some seconds, on a
machine that is busy many."""
_MODULE = "slidetune.server.law_files.child"


def try_apart(
    source: Source, name: str = "", document: dict[str, Any] | None = None, limit: float = LIMIT
) -> None:
    """Try a law's own file in another process; what it compiles there is kept for this one.

    Args:
        source: the content of the file.
        name: name of its law so far, where the file is read again.
        document: an experiment in which it has to do as well; all lanes of it have laws that ship
            with the program, or this one.
        limit: time after which the process is ended in [s].

    Raises:
        LawFileError: with the lines of the file that are to blame.
    """
    asked = {"file": source.name, "text": source.text, "name": name, "document": document}
    try:
        refused = ask_apart(_MODULE, asked, limit)
    except LostProcessError as error:
        raise LawFileError(source.name, f"its trial {error.text}", error.lines) from error
    if refused is not None:
        raise LawFileError(**refused)
