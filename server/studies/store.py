"""Where studies are kept: one SQLite file in the user's data folder."""

from __future__ import annotations

import json
import os
import sqlite3
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from threading import Lock
from typing import Any, Literal

import platformdirs

from slidetune.robot.errors import SlidetuneError

FOLDER_VARIABLE = "SLIDETUNE_STUDIES"
"""Environment variable that names another folder for the studies."""

State = Literal["waiting", "running", "stopped", "done", "failed"]
Document = dict[str, Any]

_TABLES = """
CREATE TABLE IF NOT EXISTS studies (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    kind TEXT NOT NULL,
    title TEXT NOT NULL,
    created REAL NOT NULL,
    version TEXT NOT NULL,
    state TEXT NOT NULL,
    message TEXT NOT NULL DEFAULT '',
    total INTEGER NOT NULL,
    experiment TEXT NOT NULL,
    wanted TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS entries (
    study INTEGER NOT NULL REFERENCES studies (id) ON DELETE CASCADE,
    number INTEGER NOT NULL,
    document TEXT NOT NULL,
    curves BLOB,
    PRIMARY KEY (study, number)
) WITHOUT ROWID;
"""
_COLUMNS = (
    "id, kind, title, created, version, state, message, total, experiment, wanted, "
    "(SELECT COUNT(*) FROM entries WHERE study = studies.id)"
)


class UnknownStudyError(SlidetuneError, KeyError):
    """No study of that number."""

    def __str__(self) -> str:
        """Return the text itself (KeyError would quote it)."""
        return str(self.args[0])


class StudyStorageError(SlidetuneError, OSError):
    """The studies' file can't be read or written."""


@dataclass(frozen=True)
class Record:
    """A study as it is kept.

    Attributes:
        id: its number.
        kind: which kind.
        title: what people call it.
        created: when, in seconds since 1970.
        version: of the program that began it, and its sources.
        state: whether it waits, runs, or how it ended.
        message: why it failed.
        total: how many entries it has once it is done.
        experiment: document of its experiment.
        wanted: what it was told.
        made: how many entries there are.
    """

    id: int
    kind: Any
    title: str
    created: float
    version: str
    state: State
    message: str
    total: int
    experiment: Document
    wanted: Document
    made: int


def study_folder() -> Path:
    """Return the folder of the user's studies: ``SLIDETUNE_STUDIES``, or one of the data folder."""
    folder = os.environ.get(FOLDER_VARIABLE)
    return Path(folder) if folder else Path(platformdirs.user_data_dir("slidetune")) / "studies"


class StudyStore:
    """The studies' file; safe to use from many threads and from several servers.

    The file is made with the first study. What was written is there after the process was killed.
    """

    def __init__(self, folder: Path) -> None:
        """Say in which folder the file is."""
        self.folder = folder
        self._path = folder / "studies.sqlite"
        self._lock = Lock()
        self._opened: sqlite3.Connection | None = None

    def add(
        self,
        kind: str,
        title: str,
        total: int,
        experiment: Document,
        wanted: Document,
        version: str,
    ) -> int:
        """Keep a new study that waits; return its number.

        Raises:
            StudyStorageError: if the file can't be written.
        """
        row = (kind, title, time.time(), version, "waiting", total, _text(experiment))
        with self._file(create=True) as file:
            made = file.execute(
                "INSERT INTO studies (kind, title, created, version, state, total, experiment,"
                " wanted) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                (*row, _text(wanted)),
            )
            return int(made.lastrowid or 0)

    def all(self) -> list[Record]:
        """Return all studies, the newest first."""
        if not self._path.exists():
            return []
        with self._file() as file:
            rows = file.execute(f"SELECT {_COLUMNS} FROM studies ORDER BY id DESC").fetchall()
        return [_record(row) for row in rows]

    def one(self, number: int) -> Record:
        """Return a study.

        Raises:
            UnknownStudyError: if there is none of that number.
        """
        rows = []
        if self._path.exists():
            with self._file() as file:
                query = f"SELECT {_COLUMNS} FROM studies WHERE id = ?"
                rows = file.execute(query, (number,)).fetchall()
        if not rows:
            raise UnknownStudyError(f"there is no study {number}")
        return _record(rows[0])

    def append(
        self, number: int, first: int, entries: Sequence[tuple[Document, bytes | None]]
    ) -> None:
        """Keep entries, the first of them at that place; one that is there already stays."""
        rows = [
            (number, place, _text(document), curves)
            for place, (document, curves) in enumerate(entries, first)
        ]
        with self._file() as file:
            file.executemany("INSERT OR IGNORE INTO entries VALUES (?, ?, ?, ?)", rows)

    def entries(self, number: int, first: int = 0, most: int = -1) -> list[Document]:
        """Return entries of a study in their order: from one on, and how many at most."""
        return [json.loads(text) for text in self.texts(number, first, most)]

    def texts(self, number: int, first: int = 0, most: int = -1) -> list[str]:
        """Return the same as ``entries``, each as the JSON that was kept."""
        query = (
            "SELECT document FROM entries WHERE study = ? AND number >= ? ORDER BY number LIMIT ?"
        )
        return [text for (text,) in self._select(query, (number, first, most))]

    def curves(self, number: int) -> list[bytes | None]:
        """Return the curves of a study's entries, in their order."""
        query = "SELECT curves FROM entries WHERE study = ? ORDER BY number"
        return [curves for (curves,) in self._select(query, (number,))]

    def change_state(
        self, number: int, before: Sequence[State], state: State, message: str = ""
    ) -> bool:
        """Say whether a study waits or runs, or how it ended.

        Args:
            number: which study.
            before: states of which it must have one; else nothing is changed.
            state: the new one.
            message: why it failed.

        Returns:
            Whether it was changed.
        """
        places = ", ".join("?" * len(before))
        query = f"UPDATE studies SET state = ?, message = ? WHERE id = ? AND state IN ({places})"
        with self._file() as file:
            return file.execute(query, (state, message, number, *before)).rowcount > 0

    def progress(self, number: int) -> tuple[State, str, int]:
        """Return the state of a study, its message, and how many entries there are.

        Raises:
            UnknownStudyError: if there is none of that number.
        """
        query = (
            "SELECT state, message, (SELECT COUNT(*) FROM entries WHERE study = studies.id)"
            " FROM studies WHERE id = ?"
        )
        for state, message, made in self._select(query, (number,)):
            return state, message, made
        raise UnknownStudyError(f"there is no study {number}")

    def delete(self, number: int) -> None:
        """Forget a study and its entries.

        Raises:
            UnknownStudyError: if there is none of that number.
        """
        self.one(number)
        with self._file() as file:
            file.execute("DELETE FROM studies WHERE id = ?", (number,))

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            if self._opened is not None:
                self._opened.close()
                self._opened = None

    def _select(self, query: str, values: Sequence[Any]) -> list[tuple[Any, ...]]:
        if not self._path.exists():
            return []
        with self._file() as file:
            return file.execute(query, values).fetchall()

    @contextmanager
    def _file(self, create: bool = False) -> Iterator[sqlite3.Connection]:
        """Hold the file for one transaction."""
        with self._lock:
            try:
                if self._opened is None:
                    self._opened = self._open(create)
                with self._opened as file:
                    yield file
            except (sqlite3.Error, OSError) as error:
                text = f"can't use the studies' file {self._path}: {error}"
                damaged = type(error) is sqlite3.DatabaseError
                way_out = (
                    "it is damaged or no database: move it away to begin with a new one"
                    if damaged
                    else f"free some space, allow writing there, or set {FOLDER_VARIABLE}"
                )
                raise StudyStorageError(f"{text}; {way_out}") from error

    def _open(self, create: bool) -> sqlite3.Connection:
        if create:
            self.folder.mkdir(parents=True, exist_ok=True)
        # Our own lock lets one thread in at a time; another server's writes are waited for.
        file = sqlite3.connect(self._path, timeout=30.0, check_same_thread=False)
        file.execute("PRAGMA journal_mode = WAL")
        file.execute("PRAGMA synchronous = NORMAL")
        file.execute("PRAGMA foreign_keys = ON")
        file.executescript(_TABLES)
        return file


def _text(document: Mapping[str, Any]) -> str:
    return json.dumps(document, allow_nan=False, ensure_ascii=False, separators=(",", ":"))


def _record(row: Sequence[Any]) -> Record:
    names = [one.name for one in fields(Record)]
    told = dict(zip(names, row, strict=True))
    documents = {name: json.loads(told[name]) for name in ("experiment", "wanted")}
    return Record(**{**told, **documents})
