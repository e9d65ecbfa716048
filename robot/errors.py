"""Every error that this project raises on purpose."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any


class SlidetuneError(Exception):
    """Root of all errors raised on purpose; its text is written for the person at the screen."""


@dataclass(frozen=True)
class FieldError:
    """One refused value.

    Attributes:
        path: where it stands, dotted, such as ``lanes.NFTSM.nu``.
        message: what is wrong, the value, what is allowed and the unit.
        value: what was given (shortened when long).
        allowed: the permitted values in words, or an empty text.
        line: line of the file it came from, counted from 1, where there is one.
    """

    path: str
    message: str
    value: object = None
    allowed: str = ""
    line: int | None = None

    def __str__(self) -> str:
        """Return ``line 12: lanes.NFTSM.nu: …``."""
        where = f"line {self.line}: " if self.line is not None else ""
        return f"{where}{self.path}: {self.message}" if self.path else f"{where}{self.message}"


def unknown_lane(path: str, name: str, known: Iterable[str], way_out: str = "") -> FieldError:
    """Return the refusal of a lane's name that stands at ``path``; lists those that there are."""
    return FieldError(
        path, f"no lane is named {name}; there are: {', '.join(known)}{way_out}", name
    )


class InvalidExperimentError(SlidetuneError, ValueError):
    """Values that an experiment can't take; ``fields`` names each."""

    def __init__(self, fields: Sequence[FieldError]) -> None:
        """Keep the refused fields and make one text of them."""
        self.fields = tuple(fields)
        super().__init__("\n".join(str(field) for field in self.fields))

    def __reduce__(self) -> tuple[Any, ...]:
        """Travel between processes whole."""
        return type(self), (self.fields,), {"args": self.args}


class LawChangedError(SlidetuneError, ValueError):
    """The file of a law was read again while something went on with the version before."""

    def __init__(self, lane: str, law: str) -> None:
        """Make the text."""
        super().__init__(
            f"the file of {law}, the law of {lane}, was read again meanwhile: begin anew with the "
            "present version"
        )


class PresetSyntaxError(InvalidExperimentError):
    """A preset's text that isn't a plain YAML mapping within the size limits."""


class UnknownPresetError(SlidetuneError, KeyError):
    """No preset of that name; the message lists the known ones."""

    def __str__(self) -> str:
        """Return the text itself (KeyError would quote it)."""
        return str(self.args[0])


class InvalidLessonError(InvalidExperimentError):
    """Values that a lesson can't take; ``fields`` names each."""


class UnknownLessonError(SlidetuneError, KeyError):
    """No lesson of that name; the message lists the known ones."""

    def __str__(self) -> str:
        """Return the text itself (KeyError would quote it)."""
        return str(self.args[0])


class PresetConflictError(SlidetuneError, ValueError):
    """A preset of that name exists already, or ships with the program and is read-only."""


class PresetStorageError(SlidetuneError, OSError):
    """The folder of the user's presets can't be written."""


class RefusedArmError(SlidetuneError, ValueError):
    """A description that holds no arm that can be loaded; the text is the doctor's report."""


class UnknownArmError(SlidetuneError, KeyError):
    """No arm of that name; the message lists the known ones."""

    def __str__(self) -> str:
        """Return the text itself (KeyError would quote it)."""
        return str(self.args[0])


class ArmStorageError(SlidetuneError, OSError):
    """An arm of the user's own that can't be kept."""


class UnreachableError(SlidetuneError, ValueError):
    """A flange path that the arm can't follow; ``field`` names what to change about it."""

    def __init__(self, text: str, field: str = "radius") -> None:
        """Keep the text and the field to blame."""
        super().__init__(text)
        self.field = field
