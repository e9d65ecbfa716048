"""Where a package goes: a folder or an archive, whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from slidetune.robot.handover.package import zipped
from slidetune.server.report.output_file import OutputError

ARCHIVE = ".zip"


def check_package_target(name: str) -> None:
    """Refuse a bad place before the work begins.

    Raises:
        OutputError: if the folder around it is missing, a folder has files in it already, or the
            name of an archive is a folder's.
    """
    path = Path(name)
    if not path.absolute().parent.is_dir():
        raise OutputError(f"can't write {name}: there is no folder {path.absolute().parent}")
    if path.suffix == ARCHIVE:
        if path.is_dir():
            raise OutputError(f"can't write to {name}: it is a folder, name a file")
    elif path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise OutputError(
            f"can't write to {name}: name a new or an empty folder, or a file ending in {ARCHIVE}"
        )


def write_package(name: str, files: Mapping[str, str]) -> None:
    """Write a package's files.

    Args:
        name: a folder, new or empty, or a file that ends in ``.zip``, which is replaced.
        files: texts by name.

    Raises:
        OutputError: as of ``check_package_target``.
        OSError: if it can't be written; what was there is as before.
    """
    check_package_target(name)
    path = Path(name).absolute()
    made = Path(tempfile.mkdtemp(dir=path.parent, prefix="."))
    try:
        if path.suffix == ARCHIVE:
            archive = made / path.name
            archive.write_bytes(zipped(files, path.stem))
            os.replace(archive, path)
            return
        folder = made / path.name
        folder.mkdir()
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8", newline="")
        os.replace(folder, path)
    finally:
        shutil.rmtree(made)
