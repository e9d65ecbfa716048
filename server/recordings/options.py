"""How a recording is to be read, as the command line says it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from slidetune.robot.recordings.recording import Wanted
from slidetune.robot.recordings.refused import RecordingError

RecordingArgument = Annotated[
    Path, typer.Argument(metavar="FILE", help="CSV, or MCAP with joint states of ROS 2.")
]
MapOption = Annotated[
    list[str] | None,
    typer.Option(
        "--map",
        metavar="WHAT=COLUMN",
        help="Which column holds what: time, a joint, joint.velocity, joint.torque, joint.current "
        "or joint.desired; a joint is its name or its number. May be given several times.",
    ),
]
SourceOption = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Topic that counts, or what stands before the columns."),
]
AnglesOption = Annotated[
    str,
    typer.Option(
        metavar="UNIT",
        help="Unit of angles (and, per s, of velocities) whose header has none: rad or deg.",
    ),
]
TimeOption = Annotated[
    str, typer.Option("--time", metavar="UNIT", help="Unit of a time without one: s, ms, us or ns.")
]


def wanted_of(mapped: Sequence[str] | None, source: str | None, angles: str, time: str) -> Wanted:
    """Return how files are to be read.

    Raises:
        RecordingError: for a mapping without an equals sign, or a unit that isn't known.
    """
    mapping = {}
    for text in mapped or []:
        what, equals, column = text.partition("=")
        if not equals or not what.strip() or not column.strip():
            raise RecordingError(f"--map must be WHAT=COLUMN, such as joint_1=pos1, got {text!r}")
        mapping[what.strip()] = column.strip()
    if angles not in ("", "rad", "deg"):
        raise RecordingError(f"--angles must be rad or deg, got {angles!r}")
    return Wanted(mapping, source, angles, time)


def shifts_of(texts: Sequence[str] | None, count: int) -> list[float | None]:
    """Return the shift of each log in [s], ``None`` where it is to be found.

    Raises:
        RecordingError: for what is no number, or as many as neither one nor the logs.
    """
    given = list(texts or ["auto"])
    if len(given) not in (1, count):
        raise RecordingError(
            f"--shift may be given once, or for each of the {count} logs, got {len(given)}"
        )
    shifts = [_shift(text) for text in given]
    return shifts * count if len(shifts) == 1 else shifts


def _shift(text: str) -> float | None:
    if text == "auto":
        return None
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise RecordingError(f"--shift must be auto or seconds, got {text!r}")
    return value
