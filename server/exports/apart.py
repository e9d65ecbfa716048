"""An export of the server, written in a process of its own."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from slidetune.robot.errors import SlidetuneError
from slidetune.server.compute.apart import LostProcessError, ask_apart
from slidetune.server.exports.archive import save_recorded
from slidetune.server.exports.formats import Format
from slidetune.server.exports.recorded import Recorded
from slidetune.server.exports.refused import ExportError

_MODULE = "slidetune.server.exports.child"
_LIMIT = 300.0
"""Longest time that one may take in [s] (*ours*): a minute of six lanes as MCAP took 66
on a busy machine."""


def export_apart(recorded: Recorded, format: Format) -> Path:
    """Return a new file, which the caller removes.

    Args:
        recorded: what to write.
        format: as what.

    Raises:
        ExportError: if there is no room for it, or it took too long.
    """
    target: Path | None = None
    try:
        with tempfile.TemporaryDirectory(prefix="slidetune-export-") as folder:
            archive = Path(folder) / "recorded.npz"
            save_recorded(archive, recorded)
            number, name = tempfile.mkstemp(prefix="slidetune-export-", suffix=f".{format}")
            os.close(number)
            target = Path(name)
            asked = {"archive": str(archive), "target": name, "format": format}
            answer = ask_apart(_MODULE, asked, _LIMIT)
        if "refused" in answer:
            raise ExportError(f"the export can't be written: {answer['refused']}")
    except BaseException as error:
        if target is not None:
            target.unlink(missing_ok=True)
        if isinstance(error, LostProcessError):
            text = f"the export can't be written: what writes it {error.text}"
            raise ExportError(text) from error
        if isinstance(error, OSError) and not isinstance(error, SlidetuneError):
            raise ExportError(f"the export can't be written: {error.strerror or error}") from error
        raise
    return target
