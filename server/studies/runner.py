"""Runs studies one after the other, beside the live session, and goes on with those of before."""

from __future__ import annotations

import fcntl
import logging
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError as NeverBegunError
from concurrent.futures import Executor, Future
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slidetune.robot.errors import SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import CancelledError
from slidetune.robot.study.curves import curve_names
from slidetune.robot.study.robustness import Draw
from slidetune.robot.study.study import Entry, Study
from slidetune.server.compute.build import version_of
from slidetune.server.studies.store import Record, State, StudyStore, UnknownStudyError

log = logging.getLogger("slidetune.studies")

LOOK = 5.0
"""Time between two looks for studies that another server left behind in [s] (*ours*)."""
UNDER_WAY: tuple[State, ...] = ("waiting", "running")


@dataclass
class _Pace:
    """How fast the study that runs is: what was there when it began, and when that was."""

    number: int
    made: int
    started: float
    executor: Executor
    tasks: int = 0

    def count(self, task: Future[Any]) -> None:
        """Note that one more task has ended; one that was cancelled has made nothing."""
        self.tasks += not task.cancelled()


class _Counted(Executor):
    """An executor whose tasks are counted as they end: a sign of life between entries."""

    def __init__(self, executor: Executor, pace: _Pace) -> None:
        self._executor, self._pace = executor, pace

    def submit(self, function: Any, /, *args: Any, **options: Any) -> Future[Any]:
        task = self._executor.submit(function, *args, **options)
        task.add_done_callback(self._pace.count)
        return task


class StudyRunner:
    """One thread that runs what waits in the store, the oldest first.

    The store's state is the truth: what it says waits or runs is run, by this server or, once it
    has ended, by the next; a lock file keeps two from the same study.
    """

    def __init__(
        self, store: StudyStore, executor: Callable[[], AbstractContextManager[Executor]]
    ) -> None:
        """Say where studies are kept, and where their runs are made."""
        self.store = store
        self._executor = executor
        self._wake = threading.Event()
        self._closing = False
        self._pace: _Pace | None = None
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._work, name="slidetune-studies", daemon=True)

    def start(self) -> None:
        """Begin, with what was under way when the last server ended."""
        self._thread.start()

    def close(self) -> None:
        """Stop; what is under way goes on with the next server."""
        self._closing = True
        self._interrupt(None)
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join()
        self.store.close()

    def begin(self, study: Study, title: str = "") -> int:
        """Take a study; return its number.

        Raises:
            InvalidExperimentError: before anything is kept, naming every refused field.
            StudyStorageError: if it can't be kept.
        """
        study.check()
        wanted = study.wanted.model_dump(mode="json")
        document = study.experiment.document()
        version = version_of(study.experiment)
        number = self.store.add(study.kind, title, study.total, document, wanted, version)
        self._wake.set()
        return number

    def stop(self, number: int) -> None:
        """End a study early; what is done is kept.

        Raises:
            UnknownStudyError: if there is none of that number.
        """
        self.store.one(number)
        if self.store.change_state(number, UNDER_WAY, "stopped"):
            self._interrupt(number)

    def resume(self, number: int) -> None:
        """Go on with a study that was stopped or has failed.

        Raises:
            UnknownStudyError: if there is none of that number.
        """
        self.store.one(number)
        if self.store.change_state(number, ("stopped", "failed"), "waiting"):
            self._wake.set()

    def delete(self, number: int) -> None:
        """Forget a study, whatever it does.

        Raises:
            UnknownStudyError: if there is none of that number.
        """
        self.store.delete(number)
        self._interrupt(number)
        self._lock_file(number).unlink(missing_ok=True)

    def seconds_left(self, number: int, made: int, total: int) -> float | None:
        """Return how long a study will still take, ``None`` while that isn't known."""
        pace = self._pace
        if pace is None or pace.number != number or made <= pace.made:
            return None
        return (time.monotonic() - pace.started) / (made - pace.made) * (total - made)

    def tasks_done(self, number: int) -> int:
        """Return how many tasks of a study have ended since this server goes on with it."""
        pace = self._pace
        return 0 if pace is None or pace.number != number else pace.tasks

    def _interrupt(self, number: int | None) -> None:
        """Stop the runs that are under way, of one study or of any."""
        with self._lock:
            if self._pace is not None and number in (None, self._pace.number):
                self._pace.executor.shutdown(wait=False, cancel_futures=True)

    def _work(self) -> None:
        while not self._closing:
            self._wake.clear()
            try:
                ran = self._next()
            except Exception:
                # Where not even a study's end can be kept it is not begun again at once.
                log.exception("the studies can't be read or kept")
                ran = False
            if not ran:
                self._wake.wait(LOOK)

    def _next(self) -> bool:
        """Run the oldest study that nobody runs; return whether there was one."""
        for record in reversed(self.store.all()):
            if record.state in UNDER_WAY and not self._closing:
                with self._claim(record.id) as mine:
                    # Another server may have gone on with it since.
                    if mine and (now := self.store.one(record.id)).state in UNDER_WAY:
                        self._run(now)
                        return True
        return False

    def _run(self, record: Record) -> None:
        number = record.id
        state: State
        try:
            state, message = self._finish(record)
        except (CancelledError, NeverBegunError, UnknownStudyError):
            return  # stopped, deleted, or the server ends: the store says which
        except SlidetuneError as error:
            state, message = "failed", str(error)
        except Exception as error:
            if self._closing:
                return  # an executor that is being shut down fails in its own ways
            log.exception("study %s failed", number)
            state, message = "failed", f"{type(error).__name__}: {error}; the server's log has more"
        finally:
            with self._lock:
                self._pace = None
        self.store.change_state(number, UNDER_WAY, state, message)

    def _finish(self, record: Record) -> tuple[State, str]:
        """Run a study to its end; return how it ended."""
        number, made = record.id, record.made
        experiment = Experiment.from_document(record.experiment)
        present = version_of(experiment)
        if made and record.version != present:
            text = (
                f"begun by version {record.version}, this is {present}: its entries may not go "
                "with what this version would add. Begin it anew."
            )
            return "failed", text
        study = Study.from_document(record.kind, experiment, record.wanted)
        known = self._known(study, number)
        if not self.store.change_state(number, UNDER_WAY, "running"):
            raise CancelledError
        with self._executor() as executor:
            pace = _Pace(number, made, time.monotonic(), executor)
            with self._lock:
                self._pace = pace
            try:
                for entry in study.entries(_Counted(executor, pace), known):
                    self.store.append(number, made, [_row(entry)])
                    made += 1
                    if self._closing or self.store.progress(number)[0] != "running":
                        raise CancelledError
            except BaseException:
                executor.shutdown(wait=False, cancel_futures=True)
                raise
        return "done", ""

    def _known(self, study: Study, number: int) -> list[Entry]:
        return study.read(self.store.texts(number))

    def _lock_file(self, number: int) -> Path:
        return self.store.folder / f"study-{number}.lock"

    @contextmanager
    def _claim(self, number: int) -> Iterator[bool]:
        """Hold a study for the time of a block, unless another server does: tell which."""
        with self._lock_file(number).open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                yield False
                return
            yield True


def _row(entry: Entry) -> tuple[dict[str, Any], bytes | None]:
    curves = entry.curves if isinstance(entry, Draw) else None
    return entry.document(), None if curves is None else curves.tobytes()


def curves_from(kept: bytes | None, joints: int) -> np.ndarray | None:
    """Return curves of an arm of so many joints from the bytes that were kept of them."""
    if kept is None:
        return None
    return np.frombuffer(kept, np.float32).reshape(len(curve_names(joints)), 2, -1)
