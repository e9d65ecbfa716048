"""Results that are written whole or not at all."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from slidetune.server.report.output_file import OutputError, check_outputs, write_output


def breaking() -> Iterator[str]:
    yield "half"
    raise RuntimeError("out of ink")


def test_a_new_file_takes_the_place_of_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a much longer text than before")
    write_output(str(path), ["τ,", "e\n"])
    assert path.read_text(encoding="utf-8") == "τ,e\n"


def test_a_failed_write_leaves_what_was_there_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("old")
    with pytest.raises(RuntimeError, match="out of ink"):
        write_output(str(path), breaking())
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(os.name != "posix", reason="permissions and links of Unix")
def test_permissions_and_links_stay_as_other_tools_leave_them(tmp_path: Path) -> None:
    new, old, link = tmp_path / "new", tmp_path / "old", tmp_path / "link"
    plain = tmp_path / "plain"
    plain.write_text("")
    old.write_text("")
    old.chmod(0o640)
    link.symlink_to(old)
    write_output(str(new), ["1"])
    write_output(str(link), ["2"])
    assert new.stat().st_mode == plain.stat().st_mode
    assert stat.S_IMODE(old.stat().st_mode) == 0o640
    assert link.is_symlink()
    assert old.read_text() == "2"


@pytest.mark.skipif(os.name != "posix", reason="devices of Unix")
def test_a_device_is_written_to_and_not_replaced() -> None:
    write_output(os.devnull, ["gone"])
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


def test_a_dash_is_standard_output(capsys: pytest.CaptureFixture[str]) -> None:
    write_output("-", ["a", "b"])
    assert capsys.readouterr().out == "ab"


@pytest.mark.parametrize(
    "names",
    [
        ("nowhere/a",),
        (".",),
        ("a", "a"),
        ("-", "-"),
        ("a", "./a"),
        ("there", "hard"),
        ("later", "soft"),
    ],
)
def test_bad_places_are_refused(
    names: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("there").write_text("")
    os.link("there", "hard")
    Path("soft").symlink_to("later")
    check_outputs("a", "-", "", "")
    check_outputs("b", "there", "soft")
    with pytest.raises(OutputError):
        check_outputs(*names)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device of Linux")
def test_what_cannot_be_written_is_named() -> None:
    with pytest.raises(OSError, match=r"^can't write /dev/full: No space left on device$"):
        write_output("/dev/full", ["1"])


def test_a_folder_that_cannot_be_written_is_named_by_the_file(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"can't write .*gone/a\.csv: No such file"):
        write_output(str(tmp_path / "gone" / "a.csv"), ["1"])
