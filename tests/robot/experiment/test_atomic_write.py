"""Files that are written whole or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from slidetune.robot.experiment.atomic_write import atomic_write


def refuse_links(source: str, target: Path) -> None:
    raise PermissionError(errno.EPERM, "Operation not permitted")


@pytest.mark.parametrize("links", [True, False])
@pytest.mark.parametrize("overwrite", [True, False])
def test_a_file_appears_with_all_of_its_content(
    links: bool, overwrite: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not links:
        monkeypatch.setattr(os, "link", refuse_links)
    atomic_write(tmp_path / "one", b"content", overwrite)
    assert [path.name for path in tmp_path.iterdir()] == ["one"]
    assert (tmp_path / "one").read_bytes() == b"content"


@pytest.mark.parametrize("links", [True, False])
def test_a_name_that_is_taken_keeps_its_content(
    links: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not links:
        monkeypatch.setattr(os, "link", refuse_links)
    (tmp_path / "one").write_bytes(b"old")
    with pytest.raises(FileExistsError):
        atomic_write(tmp_path / "one", b"new", overwrite=False)
    assert [path.name for path in tmp_path.iterdir()] == ["one"]
    assert (tmp_path / "one").read_bytes() == b"old"


@pytest.mark.parametrize("overwrite", [True, False])
def test_a_disk_that_fails_leaves_what_was_there(
    overwrite: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    if overwrite:
        (tmp_path / "one").write_bytes(b"old")
    monkeypatch.setattr(os, "link", refuse_links)
    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="No space left"):
        atomic_write(tmp_path / "one", b"new", overwrite)
    left = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert left == ({"one": b"old"} if overwrite else {})


def test_without_hard_links_a_reader_never_meets_a_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[bytes] = []
    replace = os.replace

    def look_first(source: str, target: Path) -> None:
        seen.append(target.read_bytes())
        replace(source, target)

    monkeypatch.setattr(os, "link", refuse_links)
    monkeypatch.setattr(os, "replace", look_first)
    atomic_write(tmp_path / "one", b"content" * 1000, overwrite=False)
    assert seen == [b""]
