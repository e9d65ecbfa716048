"""How large a recording may be, and what a file is that is none."""

from __future__ import annotations

from pathlib import Path

from slidetune.robot.recordings.refused import RecordingError

LARGEST_FILE = 200 * 1024 * 1024
"""Most bytes of a file (*ours*)."""
MOST_ROWS = 1_000_000
"""Most rows (*ours*): a quarter of an hour at 1 kHz; with six joints 50 MB a quantity."""
MOST_COLUMNS = 2000
"""Most columns (*ours*)."""
FEWEST_ROWS = 8
"""Fewest rows (*ours*): a spline of degree five takes six."""

MCAP_MAGIC = b"\x89MCAP0\r\n"
_OTHERS = {
    b"PK\x03\x04": "a ZIP or Excel file: save the sheet as CSV",
    b"SQLite format 3": "a ROS 2 bag in SQLite: turn it into MCAP by ros2 bag convert",
    b"#ROSBAG": "a bag of ROS 1: turn it into MCAP by mcap convert",
    b"\x89HDF": "HDF5 or a MATLAB file: write the columns as CSV",
    b"MATLAB": "a MATLAB file: write the columns as CSV, by writetable",
    b"PAR1": "a Parquet file: write the columns as CSV",
    b"ARROW1": "an Arrow file: write the columns as CSV",
    b"\x93NUMPY": "a NumPy file: write the columns as CSV, by numpy.savetxt with a header",
    b"\x1f\x8b": "compressed by gzip: unpack it first",
    b"\x28\xb5\x2f\xfd": "compressed by zstd: unpack it first",
    b"\xff\xfe": "text in UTF-16: save it as UTF-8",
    b"\xfe\xff": "text in UTF-16: save it as UTF-8",
}


def beginning_of(path: Path) -> bytes:
    """Return the first bytes of a file that may be a recording.

    Raises:
        RecordingError: if it isn't there, is empty, too large, or of another kind.
    """
    try:
        if not path.is_file():
            raise RecordingError("there is no such file" if not path.exists() else "is no file")
        size = path.stat().st_size
        with path.open("rb") as file:
            begin = file.read(4096)
    except RecordingError:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise RecordingError(f"can't be read: {reason}") from error
    if not begin:
        raise RecordingError("is empty")
    if size > LARGEST_FILE:
        raise RecordingError(
            f"has {size / 2**20:.0f} MB, at most {LARGEST_FILE // 2**20} MB are read: cut it, or "
            "write every tenth row"
        )
    if begin.startswith(MCAP_MAGIC):
        return begin
    for magic, words in _OTHERS.items():
        if begin.startswith(magic):
            raise RecordingError(f"is {words}; CSV and MCAP are read")
    if b"\0" in begin:
        raise RecordingError("is binary and no MCAP: CSV and MCAP are read")
    return begin
