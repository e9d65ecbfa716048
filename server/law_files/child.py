"""The process in which a law's own file is tried before the server takes it.

Reads what to try as JSON from standard input and writes what is wrong with it, if anything is, as
JSON to standard output. Whatever the file does, nothing but this process can be lost.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.law_files.source import Source
from slidetune.robot.loop.law_trial import take_law


def tried(asked: dict[str, Any]) -> dict[str, str] | None:
    """Return what is wrong with a file, or ``None``; see ``trial.refusal_of``."""
    try:
        take_law(Source(asked["file"], asked["text"]), asked["name"], asked["document"])
    except LawFileError as error:
        return {"file": error.file, "message": error.message, "trace": error.trace}
    return None


def main() -> None:
    """Answer once."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what the file prints is no answer
    answers.write(json.dumps(tried(json.load(sys.stdin))))
    answers.flush()


if __name__ == "__main__":
    main()
