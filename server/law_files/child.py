"""The process in which a law's own file is tried before the server takes it.

Reads what to try as JSON from standard input and writes what is wrong with it, if anything is, as
JSON to standard output. Whatever the file does, nothing but this process can be lost.
"""

from __future__ import annotations

from typing import Any

from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.law_files.source import Source
from slidetune.robot.loop.law_trial import take_law
from slidetune.server.compute.apart import answer_once


def tried(asked: dict[str, Any]) -> dict[str, str] | None:
    """Return what is wrong with a file, or ``None``; see ``trial.refusal_of``."""
    try:
        take_law(Source(asked["file"], asked["text"]), asked["name"], asked["document"])
    except LawFileError as error:
        return {"file": error.file, "message": error.message, "trace": error.trace}
    return None


if __name__ == "__main__":
    answer_once(tried)
