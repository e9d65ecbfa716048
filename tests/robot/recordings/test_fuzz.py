"""Whatever a file holds, it becomes a recording of finite numbers and rising time, or words."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slidetune.robot.arm.known import arm_named
from slidetune.robot.recordings.headers import meaning_of
from slidetune.robot.recordings.recording import Wanted, read_recording
from slidetune.robot.recordings.refused import RecordingError

HEADERS = [
    "t",
    "time [ms]",
    "hinge",
    "q1",
    "q1 [deg]",
    "v1",
    "tau1 [Nm]",
    "A/q1",
    "x",
    "",
    "1",
    "é",
]
CELLS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True).map(repr),
    st.integers(-5, 50).map(str),
    st.sampled_from(
        ["", " ", "nan", "1,5", "1e3", "abc", '"', '"2"', "-", "1 2", "\x00", "é", "1e999"]
    ),
)


def outcome(content: bytes, wanted: Wanted | None = None) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.csv"
        path.write_bytes(content)
        try:
            found = read_recording(path, arm_named("pendulum"), wanted)
        except RecordingError as error:
            said = str(error)
            found = None
    if found is None:
        assert said.startswith("a.csv: ")
        assert len(said) < 5000
        return
    assert (np.diff(found.time) > 0.0).all()
    assert found.time[0] == 0.0
    for block in (found.q, found.v, found.tau, found.current, found.q_d, found.v_d):
        assert block is None or (block.shape == (len(found.time), 1) and np.isfinite(block).all())


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=400))
def test_any_bytes(content: bytes) -> None:
    outcome(content)


@settings(max_examples=300, deadline=None)
@given(
    headers=st.lists(st.sampled_from(HEADERS), min_size=1, max_size=5),
    rows=st.lists(st.lists(CELLS, min_size=1, max_size=6), max_size=14),
    separator=st.sampled_from([",", ";", "\t", " "]),
    end=st.sampled_from(["\n", "\r\n", "\r"]),
)
def test_any_table(headers: list[str], rows: list[list[str]], separator: str, end: str) -> None:
    lines = [separator.join(headers), *(separator.join(row) for row in rows)]
    outcome(end.join(lines).encode(), Wanted(time="s"))


@settings(max_examples=200, deadline=None)
@given(
    rows=st.lists(st.tuples(st.floats(-1e9, 1e9), st.floats(-10.0, 10.0)), min_size=8, max_size=30),
    risen=st.booleans(),
)
def test_any_times(rows: list[tuple[float, float]], risen: bool) -> None:
    ordered = sorted(rows) if risen else rows
    text = "\n".join(f"{time!r},{angle!r}" for time, angle in ordered)
    outcome(f"time [s],q1\n{text}\n".encode())


@settings(max_examples=500, deadline=None)
@given(st.text(max_size=60))
def test_any_header(header: str) -> None:
    found = meaning_of(header, ("hinge", "joint.1", "q[2"))
    assert found is None or found.joint is not None or found.index is not None
