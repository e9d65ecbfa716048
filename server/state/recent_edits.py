"""Every single edit of the last minutes, as merge patches to and fro."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.merge_patch import difference, merged_values
from slidetune.server.state.document import Change

LENGTH = 4096
"""Edits that are kept (*ours*): a minute of dragging at 60 a second."""


@dataclass(frozen=True)
class RecentEdit:
    """One accepted change.

    Attributes:
        revision: the revision that it made.
        author: id of the client that asked, or an empty text.
        patch: merge patch from the experiment before it to the one after it.
        back: merge patch the other way.
    """

    revision: int
    author: str
    patch: Mapping[str, Any]
    back: Mapping[str, Any]


class RecentEdits:
    """The latest edits since an experiment was loaded."""

    def __init__(self, start: Experiment, revision: int) -> None:
        """Begin with the experiment that the session began with."""
        self._present, self._oldest = start.document(), revision
        self._edits: deque[RecentEdit] = deque()
        self._lock = Lock()

    def note(self, change: Change) -> None:
        """Take a change in; what was before another experiment, or version of a law, is gone."""
        with self._lock:
            before, after = self._present, change.experiment.document()
            self._present = after
            if change.patch is None or change.law:
                self._edits.clear()
                self._oldest = change.revision
                return
            patch, back = difference(before, after), difference(after, before)
            self._edits.append(RecentEdit(change.revision, change.author, patch, back))
            if len(self._edits) > LENGTH:
                self._oldest = self._edits.popleft().revision

    def since(self, revision: int) -> tuple[int, dict[str, Any], list[RecentEdit]]:
        """Return what was in force at a revision, and what came after it.

        Returns:
            The revision, or the oldest that is known; the experiment in force there, as plain
            values; the edits after it, oldest first.
        """
        with self._lock:
            begin = max(revision, self._oldest)
            document = self._present
            later = [edit for edit in self._edits if edit.revision > begin]
        for edit in reversed(later):
            document = merged_values(document, edit.back)
        return begin, document, later
