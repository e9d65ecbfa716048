"""What is wrong with a file of one's own, where, and the way out."""

from __future__ import annotations

from slidetune.robot.errors import SlidetuneError

_LISTED = 40
"""Names that a refusal lists at most (*ours*)."""
_LONGEST = 60
"""Characters of a name or a value that a refusal quotes (*ours*)."""


class RecordingError(SlidetuneError, ValueError):
    """A recording that can't be used.

    Attributes:
        row: line of the file, or message of the topic, from 1, where one is to blame.
        column: name of the column, where one is to blame.
        value: what stands there.
        names: the columns that there are, where a mapping is the way out.
    """

    def __init__(
        self,
        text: str,
        row: int | None = None,
        column: str = "",
        value: str = "",
        names: tuple[str, ...] = (),
    ) -> None:
        """Make one text of where it is and what is wrong."""
        self.row, self.column, self.value, self.names = row, column, value, names
        self.reason = text
        places = [f"row {row}"] if row is not None else []
        places += [f"column {quoted(column)}"] if column else []
        super().__init__(f"{', '.join(places)}: {text}" if places else text)

    def within(self, file: str) -> RecordingError:
        """Return the same error with the file's name before it."""
        named = RecordingError(self.reason, self.row, self.column, self.value, self.names)
        named.args = (f"{file}: {self}",)
        return named


def quoted(text: str) -> str:
    """Return a name or a value as a refusal quotes it, shortened."""
    shown = text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
    return repr(shown)


def listed(names: tuple[str, ...] | list[str]) -> str:
    """Return names as a refusal lists them; how many more there are."""
    shown = ", ".join(quoted(name)[1:-1] for name in names[:_LISTED])
    rest = len(names) - _LISTED
    return f"{shown} and {rest} more" if rest > 0 else shown
