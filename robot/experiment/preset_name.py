"""What a preset may be called: a file's name on every system, and never a path."""

from __future__ import annotations

import re
import unicodedata

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.fields.written_value import written

LONGEST_NAME = 60
_NAME = re.compile(rf"[a-z0-9][a-z0-9-]{{0,{LONGEST_NAME - 1}}}")
# Windows takes these for devices, whatever their ending.
_DEVICES = re.compile(r"con|prn|aux|nul|(com|lpt)[0-9]")


def is_preset_name(text: str) -> bool:
    """Whether a preset may have this name."""
    return bool(_NAME.fullmatch(text)) and not _DEVICES.fullmatch(text)


def preset_name(title: str) -> str:
    """Return the name that a title gives a preset: ``My gains`` becomes ``my-gains``.

    Raises:
        InvalidExperimentError: if no letter or digit of the title fits into a name.
    """
    plain = unicodedata.normalize("NFKD", title[:400]).encode("ascii", "ignore").decode().lower()
    name = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:LONGEST_NAME].rstrip("-")
    if not name:
        raise refused_name(title)
    return f"{name}-preset" if _DEVICES.fullmatch(name) else name


def refused_name(text: str) -> InvalidExperimentError:
    """Return the error for a text that can't be a preset's name."""
    return InvalidExperimentError(
        [FieldError("name", name_rule(text), written(text[:LONGEST_NAME]))]
    )


def name_rule(text: str) -> str:
    """Say what a name may be, and what was given."""
    rule = f"a preset's name has 1 to {LONGEST_NAME} of a-z, 0-9 and -, such as my-gains"
    return f"{rule}, got {written(text[:LONGEST_NAME])}"
