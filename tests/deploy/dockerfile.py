"""A reader of the Dockerfile: as much of its grammar as it uses."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Instruction:
    """One instruction.

    Attributes:
        stage: number of its stage, from 0.
        name: such as ``RUN``.
        text: what stands after it, lines joined.
    """

    stage: int
    name: str
    text: str

    def command(self) -> list[str]:
        """Return the list of an instruction in exec form, the part from its bracket on."""
        command: list[str] = json.loads(self.text[self.text.index("[") :])
        return command


def instructions() -> list[Instruction]:
    """Return all instructions of the Dockerfile, in order."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    joined = re.sub(r"\\\n\s*", " ", "\n".join(lines))
    found: list[Instruction] = []
    stage = -1
    for line in filter(str.strip, joined.splitlines()):
        name, _, rest = line.partition(" ")
        stage += name == "FROM"
        found.append(Instruction(stage, name, rest.strip()))
    return found


def of(name: str, stage: int = 1) -> list[Instruction]:
    """Return the instructions of a name in a stage; the last stage is 1."""
    return [one for one in instructions() if (one.name, one.stage) == (name, stage)]


def environment() -> dict[str, str]:
    """Return what the image sets."""
    pairs = re.findall(r"(\w+)=(\S+)", " ".join(one.text for one in of("ENV")))
    return dict(pairs)
