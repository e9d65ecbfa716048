"""A law's own file is taken when it is saved, and its errors leave the last good one in use."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.law_files.refused import LawFileError
from slidetune.robot.laws import LAWS
from slidetune.server.law_files.law_files import LawFiles
from slidetune.server.state.app_state import AppState
from tests.own_laws import EXAMPLE, before_torque, own_laws

PATIENCE = 300.0
RENAMED = EXAMPLE.replace("kp: PerJoint", "stiffness: PerJoint").replace(
    "self.kp", "self.stiffness"
)


def until(what: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not what():
        assert time.monotonic() < end, what
        time.sleep(0.05)


@pytest.fixture
def file(tmp_path: Path) -> Iterator[Path]:
    path = tmp_path / "pd.py"
    path.write_text(EXAMPLE)
    with own_laws():
        yield path


@pytest.fixture
def state(file: Path) -> Iterator[AppState]:
    files = LawFiles([file])
    files.take()
    lanes = {"A": {"law": "pd_gravity", "kp": 500.0}, "B": {"law": "smc"}}
    state = AppState(Experiment.from_document({"lanes": lanes}), law_files=files)
    state.start()
    yield state
    state.stop()


def told(state: AppState) -> dict[str, str]:
    return state.law_files.documents()[0]


def test_a_saved_file_is_taken_and_a_wrong_one_told_while_the_last_good_one_stays(
    file: Path, state: AppState
) -> None:
    first = LAWS["pd_gravity"]
    file.write_text(before_torque("e.bad"))
    until(lambda: told(state)["state"] == "refused")
    assert LAWS["pd_gravity"] is first
    assert "e.bad" in told(state)["trace"]
    assert str(file.parent) not in str(told(state))
    file.unlink()
    until(lambda: "can't be read" in told(state)["message"])
    file.write_text(RENAMED)
    until(lambda: told(state)["state"] == "good")
    assert "A.kp" in told(state)["message"]
    lane = state.document.experiment.lanes["A"]
    assert (lane.stiffness, lane.kd) == (400.0, 40.0)
    assert "kp" not in state.document.baseline.lanes["A"].model_dump()
    until(lambda: state.session.revision == state.document.revision)
    assert state.session.state()["lanes"]["A"]["status"] == "running"


def test_a_lane_whose_law_fails_is_frozen_with_its_lines_and_begins_anew_when_mended(
    file: Path, state: AppState
) -> None:
    file.write_text(before_torque("while kp > 900.0:", "    e += 1.0"))
    first = LAWS["pd_gravity"]
    until(lambda: LAWS["pd_gravity"] is not first and told(state)["state"] == "good")
    state.document.patch({"lanes": {"A": {"kp": 950.0}}})

    def lane(name: str) -> dict[str, str]:
        found: dict[str, str] = state.session.state()["lanes"][name]
        return found

    until(lambda: lane("A")["status"] == "frozen")
    assert "while kp > 900.0:" in lane("A")["trace"]
    assert "EndlessLoopError" in lane("A")["cause"]
    assert lane("B")["status"] == "running"
    file.write_text(EXAMPLE)
    until(lambda: lane("A")["status"] == "running")
    assert state.document.experiment.lanes["A"].kp == 950.0


def test_a_file_that_is_wrong_at_the_start_is_refused(file: Path) -> None:
    file.write_text("import numpi\n")
    with pytest.raises(LawFileError, match="numpi"):
        LawFiles([file]).take()
    with pytest.raises(LawFileError, match="can't be read"):
        LawFiles([file.parent / "none.py"]).take()
