"""Files that somebody sends stay within their folder, and within limits."""

from __future__ import annotations

import io
import stat
import zipfile
from pathlib import Path

import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.server.arms import unpacked as limits
from slidetune.server.arms.unpacked import Unpacked


def zipped(*entries: tuple[str | zipfile.ZipInfo, bytes]) -> io.BytesIO:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    content.seek(0)
    return content


def test_files_and_zips_lie_as_they_were_sent(tmp_path: Path) -> None:
    unpacked = Unpacked(tmp_path)
    unpacked.take("arm/urdf/arm.urdf", io.BytesIO(b"<robot/>"))
    unpacked.take("meshes.ZIP", zipped(("meshes/a.stl", b"1"), ("meshes/b.stl", b"22")))
    assert unpacked.urdf() == tmp_path / "arm" / "urdf" / "arm.urdf"
    assert (tmp_path / "meshes" / "b.stl").read_bytes() == b"22"


@pytest.mark.parametrize(
    "name",
    ["../out.urdf", "a/../../out.urdf", "/etc/passwd", "C:\\arm.urdf", "..\\out.urdf", "", ".",
     "a\x00b", "a/" * 30 + "b", "x" * 300],
)  # fmt: skip
@pytest.mark.parametrize("as_zip", [False, True])
def test_no_name_leads_out_of_the_folder(tmp_path: Path, name: str, as_zip: bool) -> None:
    root = tmp_path / "root"
    root.mkdir()
    if as_zip and ("\x00" in name or not name):
        pytest.skip("a ZIP can't name a file so")
    path, content = ("arm.zip", zipped((name, b"1"))) if as_zip else (name, io.BytesIO(b"1"))
    with pytest.raises(InvalidExperimentError) as caught:
        Unpacked(root).take(path, content)
    assert "no path of a file within a folder" in str(caught.value)
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_a_link_in_a_zip_is_refused(tmp_path: Path) -> None:
    link = zipfile.ZipInfo("arm.urdf")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with pytest.raises(InvalidExperimentError, match="is a link"):
        Unpacked(tmp_path).take("arm.zip", zipped((link, b"/etc/passwd")))


def test_a_zip_that_grows_beyond_the_limit_is_refused_while_it_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limits, "MOST_BYTES", 3_000_000)
    bomb = zipped(("a.stl", bytes(2_000_000)), ("b.stl", bytes(2_000_000)))
    assert len(bomb.getvalue()) < 10_000
    with pytest.raises(InvalidExperimentError, match="at most 3,000,000 bytes"):
        Unpacked(tmp_path).take("bomb.zip", bomb)


def test_too_many_files_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MOST_FILES", 2)
    with pytest.raises(InvalidExperimentError, match="at most 2 files"):
        Unpacked(tmp_path).take("arm.zip", zipped(*((f"{n}.stl", b"1") for n in range(3))))


def test_what_is_no_zip_is_refused(tmp_path: Path) -> None:
    whole = zipped(("arm.urdf", b"<robot/>" * 500)).getvalue()
    for content in (b"", b"PK", whole[:-30], whole[:60] + b"\0" * 40 + whole[100:]):
        with pytest.raises(InvalidExperimentError, match="no ZIP that can be read"):
            Unpacked(tmp_path / str(len(content))).take("arm.zip", io.BytesIO(content))


def test_which_description_counts_is_asked_where_there_are_several(tmp_path: Path) -> None:
    unpacked = Unpacked(tmp_path)
    with pytest.raises(InvalidExperimentError, match="no URDF among the files"):
        unpacked.urdf()
    unpacked.take("a.urdf", io.BytesIO(b"1"))
    unpacked.take("b/b.urdf", io.BytesIO(b"1"))
    unpacked.take("b/launch.xml", io.BytesIO(b"1"))
    with pytest.raises(InvalidExperimentError) as caught:
        unpacked.urdf()
    (field,) = caught.value.fields
    assert (field.path, field.allowed) == ("urdf", "a.urdf\nb/b.urdf")
    assert unpacked.urdf("b/b.urdf") == tmp_path / "b" / "b.urdf"
    with pytest.raises(InvalidExperimentError, match="among the files"):
        unpacked.urdf("c.urdf")


def test_a_file_that_is_sent_twice_is_refused(tmp_path: Path) -> None:
    unpacked = Unpacked(tmp_path)
    unpacked.take("a.urdf", io.BytesIO(b"1"))
    with pytest.raises(InvalidExperimentError, match="sent twice"):
        unpacked.take("./a.urdf", io.BytesIO(b"1"))
    with pytest.raises(InvalidExperimentError, match="as a file or a folder"):
        unpacked.take("a.urdf/b.stl", io.BytesIO(b"1"))
