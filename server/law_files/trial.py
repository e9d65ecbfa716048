"""Tries a law's own file in a process of its own, which is ended where it doesn't come back."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from typing import Any

from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.law_files.source import Source

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
    paths = os.pathsep.join(path for path in sys.path if path)
    with subprocess.Popen(
        [sys.executable, "-m", _MODULE],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": paths},
        start_new_session=True,  # an interrupt of the server's terminal is not meant for it
    ) as process:
        try:
            answer, said = process.communicate(json.dumps(asked).encode(), limit)
        except BaseException as error:
            process.kill()
            if not isinstance(error, subprocess.TimeoutExpired):
                raise
            text = f"did not come back within {limit:g} s when it was tried, and was ended"
            raise LawFileError(source.name, text) from error
    try:
        refused = json.loads(answer)
    except ValueError as error:
        text = f"its trial {_end_of(process.returncode)}"
        lines = said.decode(errors="replace").strip().splitlines()[-10:]
        raise LawFileError(source.name, text, "\n".join(lines)) from error
    if refused is not None:
        raise LawFileError(**refused)


def _end_of(code: int) -> str:
    if code >= 0:
        return f"ended the process with exit status {code}"
    try:
        return f"ended the process by {signal.Signals(-code).name}"
    except ValueError:
        return f"ended the process by signal {-code}"
