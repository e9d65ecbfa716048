"""Whatever is done to a file, it gets words or is an arm; it never raises anything."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin
from hypothesis import given, settings
from hypothesis import strategies as st

from slidetune.robot.doctor.examine import Examined, examine
from tests.robot.doctor.arm_text import GOOD, agrees, examined

NASTY = st.sampled_from(
    ["", " ", "nan", "inf", "1e400", "1e-320", "-1", "0", "0 0 0", "1 2", "1_0", "٣", "abc", "${x}",
     "1e200", "1e-200", "-0.0", "base", "upper", "fore", "tool", "universe", "shoulder", "planar",
     "floating", "fixed", "continuous", "prismatic", "9" * 400, "package://a/b.stl", "../..", "0x1"]
)  # fmt: skip


@st.composite
def damaged(draw: st.DrawFn) -> str:
    """Draw the sound arm with values put for others, and lines left out, doubled or swapped."""
    lines = GOOD.splitlines()
    for _ in range(draw(st.integers(1, 3))):
        first = draw(st.integers(1, len(lines) - 1))
        way = draw(st.sampled_from(["value", "value", "value", "out", "twice", "swap"]))
        if way == "out":
            del lines[first]
        elif way == "twice":
            lines.insert(first, lines[first])
        elif way == "swap":
            second = draw(st.integers(1, len(lines) - 1))
            lines[first], lines[second] = lines[second], lines[first]
        else:
            parts = lines[first].split('"')
            if len(parts) > 2:
                parts[draw(st.integers(0, len(parts) // 2 - 1)) * 2 + 1] = draw(NASTY)
            lines[first] = '"'.join(parts)
    return "\n".join(lines)


def assert_sound(found: Examined, lines: int) -> None:
    """Assert that there is an arm exactly where nothing is refused, and that it can move."""
    assert agrees(found)
    for finding in found.findings:
        assert finding.line is None or 1 <= finding.line <= lines
        assert finding.text
        assert finding.remedy
    if found.arm is not None:
        model = found.arm.model
        assert 1 <= model.nv == model.nq == len(found.arm.joints) <= 12
        upper = np.triu(pin.crba(model, model.createData(), np.full(model.nq, 0.3)))
        assert np.linalg.eigvalsh(upper + np.triu(upper, 1).T)[0] > 0.0


@given(text=damaged())
@settings(max_examples=150)
def test_a_damaged_file_gets_words_or_is_an_arm(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        assert_sound(examined(Path(folder), text), text.count("\n") + 1)


@given(place=st.integers(0, len(GOOD) - 1), byte=st.binary(min_size=0, max_size=3))
@settings(max_examples=50)
def test_foreign_bytes_get_words_or_are_an_arm(place: int, byte: bytes) -> None:
    data = GOOD.encode()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.urdf"
        path.write_bytes(data[:place] + byte + data[place + 1 :])
        assert_sound(examine(path), GOOD.count("\n") + 4)
