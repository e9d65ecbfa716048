"""Studies outlive their server: the next one goes on, and two never run the same."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import CancelledError
from slidetune.robot.study.study import Study
from slidetune.server.compute.executor import LocalExecutor, local_executor
from slidetune.server.studies.runner import StudyRunner
from slidetune.server.studies.store import StudyStorageError, StudyStore, UnknownStudyError

LANE = "NFTSM"


def experiment(horizon: float = 0.3) -> Experiment:
    goals = {"near": {"kind": "figure", "figure": "mae", "bound": 0.01}}
    patch = {"simulation": {"horizon": horizon}, "goals": goals}
    return load_preset("paper").patched({**patch, "uncertainty": {"payload": [0.0, 2.0]}})


def study(trials: int = 24, horizon: float = 0.3) -> Study:
    gains = {"nu": {"low": 0.1, "high": 30.0}}
    wanted = {"lane": LANE, "trials": trials, "draws": 0, "gains": gains}
    return Study.from_document("tune", experiment(horizon), wanted)


def runner(folder: Path) -> StudyRunner:
    return StudyRunner(StudyStore(folder), lambda: LocalExecutor(2))


def until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 300.0
    while not true():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


class Halting(LocalExecutor):
    """Makes so many tasks; the next ones wait until they are stopped, however fast the machine."""

    def __init__(self, tasks: int) -> None:
        super().__init__(2)
        self._left = tasks

    def submit(self, function: Any, /, *args: Any, **options: Any) -> Future[Any]:
        self._left -= 1
        return super().submit(function if self._left >= 0 else wait_to_be_stopped, *args, **options)


def wait_to_be_stopped(*_: Any, stop: np.ndarray) -> None:
    while not stop[0]:
        time.sleep(0.01)
    raise CancelledError


def test_the_next_server_goes_on_where_the_last_one_stopped(tmp_path: Path) -> None:
    wanted = study(trials=60, horizon=0.5)
    one = StudyRunner(StudyStore(tmp_path), lambda: Halting(28))
    one.start()
    number = one.begin(wanted)
    until(lambda: one.store.progress(number)[2] >= 25)
    one.close()
    # The present gains and three batches of eight: the fourth was under way.
    assert StudyStore(tmp_path).progress(number) == ("running", "", 25)
    two = runner(tmp_path)
    two.start()
    until(lambda: two.store.progress(number)[0] == "done")
    entries = two.store.entries(number)
    two.close()
    with local_executor(2) as pool:
        assert entries == [one.document() for one in wanted.entries(pool)]


def test_two_servers_never_run_the_same_study(tmp_path: Path) -> None:
    one, two = runner(tmp_path), runner(tmp_path)
    asked: list[int] = []

    def counted(name: int) -> Callable[[], Any]:
        def executor() -> LocalExecutor:
            asked.append(name)
            return LocalExecutor(1)

        return executor

    one, two = (StudyRunner(StudyStore(tmp_path), counted(name)) for name in (1, 2))
    one.start()
    numbers = [one.begin(study(trials=8)) for _ in range(4)]
    two.start()
    until(lambda: all(one.store.progress(number)[0] == "done" for number in numbers))
    assert len(asked) == 4
    assert all(one.store.progress(number)[2] == 8 for number in numbers)
    one.close()
    two.close()


def test_another_version_does_not_go_on_with_entries_that_may_not_fit(tmp_path: Path) -> None:
    store = StudyStore(tmp_path)
    wanted = study(trials=8)
    document = wanted.experiment.document()
    number = store.add("tune", "", 8, document, wanted.wanted.model_dump(mode="json"), "0.0.1")
    with local_executor(1) as pool:
        first = next(wanted.entries(pool))
    store.append(number, 0, [(first.document(), None)])
    server = runner(tmp_path)
    server.start()
    until(lambda: server.store.progress(number)[0] == "failed")
    assert "0.0.1" in server.store.progress(number)[1]
    server.close()


def test_a_study_that_fails_says_why_and_the_next_one_runs(tmp_path: Path) -> None:
    server = runner(tmp_path)
    bad = server.store.add("tune", "", 8, {"lanes": {"A": {"law": "gone"}}}, {"lane": "A"}, "")
    server.start()
    good = server.begin(study(trials=2))
    until(lambda: server.store.progress(good)[0] == "done")
    state, message, _ = server.store.progress(bad)
    assert state == "failed"
    assert "lanes.A.law" in message
    server.close()


def test_a_study_whose_end_can_not_be_kept_is_not_begun_again_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("slidetune.server.studies.runner.LOOK", 0.5)
    server = runner(tmp_path)
    number = server.begin(study(trials=8))
    with server.store._file() as file:  # as on a full disk: it can be read, not written
        file.execute("PRAGMA query_only = ON")
    server.start()
    until(lambda: len(caplog.records) >= 4)
    moments = [record.created for record in caplog.records]
    assert all(later - sooner > 0.4 for sooner, later in pairwise(moments))
    with server.store._file() as file:
        file.execute("PRAGMA query_only = OFF")
    until(lambda: server.store.progress(number)[0] in ("done", "failed"))
    server.close()


def test_an_entry_that_is_there_already_stays(tmp_path: Path) -> None:
    store = StudyStore(tmp_path)
    number = store.add("tune", "", 3, {}, {"lane": "A"}, "")
    store.append(number, 0, [({"a": 1}, None), ({"a": 2}, b"x")])
    store.append(number, 1, [({"a": 9}, None), ({"a": 3}, None)])
    assert store.entries(number) == [{"a": 1}, {"a": 2}, {"a": 3}]
    assert store.entries(number, 1, 1) == [{"a": 2}]
    assert store.curves(number) == [None, b"x", None]
    assert store.progress(number) == ("waiting", "", 3)
    assert not store.change_state(number, ("running",), "done")
    assert store.change_state(number, ("waiting",), "done", "why")
    store.delete(number)
    with pytest.raises(UnknownStudyError):
        store.progress(number)
    store.close()


def test_a_file_that_is_no_database_is_said_to_be_none(tmp_path: Path) -> None:
    (tmp_path / "studies.sqlite").write_text("this is no database " * 100)
    store = StudyStore(tmp_path)
    with pytest.raises(StudyStorageError, match="move it away"):
        store.all()


def test_nothing_is_written_before_the_first_study(tmp_path: Path) -> None:
    server = runner(tmp_path / "studies")
    server.start()
    assert server.store.all() == []
    with pytest.raises(UnknownStudyError):
        server.stop(1)
    server.close()
    assert not (tmp_path / "studies").exists()
