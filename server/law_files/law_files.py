"""Laws of one's own: the files that the command line names, and no others, and what became of them.

Each is read again when it is saved: tried in a process of its own, then taken by the live document.
Until it does the last good version goes on.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread
from typing import Any, Literal

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.law_files.law_file import law_from
from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.law_files.source import Source, read_source
from slidetune.robot.laws.law import Law
from slidetune.robot.loop.horizon import load_law
from slidetune.robot.loop.law_trial import take_law
from slidetune.server.law_files.trial import try_apart

log = logging.getLogger("slidetune.law_files")

POLL = 0.5
"""Time between two looks at the files in [s] (*ours*)."""

Taken = Callable[[Law], list[str]]
"""Takes another version of a law; returns the gains that were left out."""


@dataclass
class LawFile:
    """One file.

    Attributes:
        path: where it is.
        law: name of its law.
        state: whether its present content is in use, is being tried, or was refused.
        message: what is wrong with it, or what was left out when it was taken.
        trace: the lines of the file that led there.
    """

    path: Path
    law: str = ""
    state: Literal["good", "trying", "refused"] = "good"
    message: str = ""
    trace: str = ""
    _stamp: tuple[int, int] = (0, 0)
    _digest: str = ""

    def document(self) -> dict[str, str]:
        """Return it as plain JSON values; its folder is nobody's concern."""
        return {
            "file": self.path.name,
            "law": self.law,
            "state": self.state,
            "message": self.message,
            "trace": self.trace,
        }

    def take(self, apart: bool) -> None:
        """Read it for the first time, and add its law.

        Args:
            apart: whether it is tried in a process of its own before.

        Raises:
            LawFileError: if it can't be used.
        """
        source = self._read()
        if apart:
            try_apart(source)
        self.law = take_law(source).name

    def changed(self) -> Source | None:
        """Return what is in it if that is another content than at the last look.

        Raises:
            LawFileError: if it can't be read now, the first time that it can't.
        """
        try:
            about = self.path.stat()
            stamp = (about.st_mtime_ns, about.st_size)
        except OSError:
            stamp = (-1, -1)
        if stamp == self._stamp:
            return None
        self._stamp, before = stamp, self._digest
        source = self._read()
        return None if source.digest == before else source

    def _read(self) -> Source:
        self._digest = ""
        if self._stamp == (0, 0) and self.path.exists():
            about = self.path.stat()
            self._stamp = (about.st_mtime_ns, about.st_size)
        source = read_source(self.path)
        self._digest = source.digest
        return source


class LawFiles:
    """The files that the command line names."""

    def __init__(self, paths: Sequence[Path] = ()) -> None:
        """Say which files there are."""
        self.files = [LawFile(path) for path in dict.fromkeys(path.absolute() for path in paths)]
        self.on_change: Callable[[], None] = lambda: None
        self._present: Callable[[str], dict[str, Any] | None] = lambda _: None
        self._taken: Taken = lambda _: []
        self._closing = Event()
        self._thread = Thread(target=self._follow, name="slidetune-laws", daemon=True)

    def take(self, apart: bool = False) -> None:
        """Add the laws of all files; see ``LawFile.take``.

        Raises:
            LawFileError: if one of them can't be used.
        """
        for file in self.files:
            file.take(apart)

    def follow(self, present: Callable[[str], dict[str, Any] | None], taken: Taken) -> None:
        """Begin to look whether they are saved.

        Args:
            present: returns the document of an experiment in which a law has to do, by its name.
            taken: takes another version of a law.
        """
        self._present, self._taken = present, taken
        if self.files:
            self._thread.start()

    def close(self) -> None:
        """Look no more."""
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def documents(self) -> list[dict[str, str]]:
        """Return all files as plain JSON values."""
        return [file.document() for file in self.files]

    def _follow(self) -> None:
        while not self._closing.wait(POLL):
            for file in self.files:
                try:
                    self._look(file)
                except Exception as error:
                    log.exception("%s could not be taken", file.path.name)
                    self._say(file, "refused", f"{type(error).__name__}: {error}")

    def _look(self, file: LawFile) -> None:
        try:
            source = file.changed()
            if source is None:
                return
            self._say(file, "trying")
            document = self._present(file.law)
            try_apart(source, file.law, document)
            law = law_from(source, file.law)
            arm = document["robot"]["model"] if document else SHIPPED
            load_law(law, arm_named(arm).joints)
            left_out = self._taken(law)
        except LawFileError as error:
            self._say(file, "refused", error.message, error.trace)
            return
        text = f"back to their defaults, as they are no longer allowed: {', '.join(left_out)}"
        self._say(file, "good", text if left_out else "")

    def _say(
        self,
        file: LawFile,
        state: Literal["good", "trying", "refused"],
        message: str = "",
        trace: str = "",
    ) -> None:
        if state == "trying" and file.state == "refused":
            # What was wrong stays in sight until it is known to be mended.
            message, trace = file.message, file.trace
        file.state, file.message, file.trace = state, message, trace
        self.on_change()
