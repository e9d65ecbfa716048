"""The process in which an export is written: a minute of MCAP takes many seconds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from slidetune.server.compute.apart import answer_once
from slidetune.server.exports.archive import load_recorded
from slidetune.server.exports.formats import written_as


def answered(asked: dict[str, Any]) -> dict[str, Any]:
    """Write what is in an archive as a file; see ``server.exports.apart``."""
    recorded = load_recorded(Path(asked["archive"]))
    try:
        with Path(asked["target"]).open("wb") as file:
            file.writelines(written_as(recorded, asked["format"]))
    except OSError as error:
        return {"refused": error.strerror or str(error)}
    return {}


if __name__ == "__main__":
    answer_once(answered)
