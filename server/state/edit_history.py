"""Who changed what, when: the list of edits, and the way back to each."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from threading import Lock
from time import time
from typing import Any

from slidetune.robot.experiment.document import Experiment
from slidetune.server.state.document import Change

LENGTH = 300
"""Edits that are kept (*ours*)."""
JOIN = 1.5
"""Edits of the same fields by the same author this close in [s] are one: a drag (*ours*)."""


@dataclass(frozen=True)
class Edit:
    """One entry of the history.

    Attributes:
        number: counts entries from 1; that of an entry which is gone never comes again.
        revision: revision that it made, the last of a drag.
        time: when, in [s] since 1970.
        author: who.
        changes: path, value before and value after of every field.
        before: the experiment before it.
        after: the experiment after it.
    """

    number: int
    revision: int
    time: float
    author: str
    changes: tuple[dict[str, Any], ...]
    before: Experiment
    after: Experiment

    def document(self) -> dict[str, Any]:
        """Return the entry as plain JSON values."""
        names = ("number", "revision", "time", "author")
        return {**{name: getattr(self, name) for name in names}, "changes": list(self.changes)}


def _differences(before: Any, after: Any, path: tuple[str, ...] = ()) -> Iterator[dict[str, Any]]:
    if isinstance(before, Mapping) and isinstance(after, Mapping):
        for key in dict.fromkeys([*before, *after]):
            yield from _differences(before.get(key), after.get(key), (*path, str(key)))
    elif before != after:
        whole = isinstance(before, Mapping) or isinstance(after, Mapping)
        names = ("none", "all") if after is not None else ("all", "none")
        values = names if whole else (before, after)
        yield {"path": list(path), "from": values[0], "to": values[1]}


def _paths(changes: tuple[dict[str, Any], ...]) -> list[list[str]]:
    """Return which fields changed; there and back the same, whatever order they are found in."""
    return sorted(change["path"] for change in changes)


class EditHistory:
    """The edits of this session, oldest first."""

    def __init__(self, start: Experiment, clock: Callable[[], float] = time) -> None:
        """Begin with the experiment that the session began with."""
        self._present = start
        self._clock = clock
        self._edits: deque[Edit] = deque(maxlen=LENGTH)
        self._count = 0
        self._lock = Lock()

    def note(self, change: Change) -> None:
        """Take a change in; one more step of the same drag extends the last entry.

        A drag that ends where it began, or an edit that is taken back at once, leaves no entry.
        """
        with self._lock:
            last = self._edits[-1] if self._edits else None
            before, after, now = self._present, change.experiment, self._clock()
            self._present = after
            changes = tuple(_differences(before.document(), after.document()))
            if not changes:
                return
            if (
                last is not None
                and last.author == change.author
                and now - last.time < JOIN
                and _paths(last.changes) == _paths(changes)
            ):
                joined = tuple(_differences(last.before.document(), after.document()))
                if not joined:
                    self._edits.pop()
                    return
                self._edits[-1] = replace(
                    last, revision=change.revision, time=now, changes=joined, after=after
                )
                return
            self._count += 1
            self._edits.append(
                Edit(self._count, change.revision, now, change.author, changes, before, after)
            )

    def entries(self) -> list[dict[str, Any]]:
        """Return all entries, oldest first, as plain JSON values."""
        with self._lock:
            return [edit.document() for edit in self._edits]

    def after(self, number: int) -> Experiment | None:
        """Return the experiment as it was after an entry, or ``None`` if it isn't kept."""
        with self._lock:
            return next((edit.after for edit in self._edits if edit.number == number), None)
