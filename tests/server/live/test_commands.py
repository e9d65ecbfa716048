"""What waits for the live session: in order, sliced, bounded, and dropped by what overrides it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.server.guard.limits import SessionBusyError
from slidetune.server.live.commands import MOST_COMMANDS, MOST_STEPS, Commands
from slidetune.server.live.pacing import Pacer
from slidetune.server.live.session import SLICE, Session
from tests.server.conftest import Served

DRIVES: dict[str, Callable[[Session], None]] = {
    "reset": lambda session: session.reset(),
    "play": lambda session: session.play(),
    "pause": lambda session: session.pause(),
    "load": lambda session: session.load(pack(Experiment()), 2),
}


def slow_session() -> Session:
    """Return a session whose every look at the clock finds its tick's time used up."""
    now = 0.0

    def clock() -> float:
        nonlocal now
        now += 1.0
        return now

    session = Session(pack(Experiment()), pacer=Pacer(clock))
    session.playing = False
    return session


def test_steps_are_made_a_slice_a_tick_and_all_in_the_end() -> None:
    session = slow_session()
    session.step(5)
    made = []
    while session.waiting_steps:
        before = session.loop.number
        session._tick()
        made.append(session.loop.number - before)
    assert sum(made) == 5
    assert 0 < max(made) <= SLICE
    assert len(made) > 1


@pytest.mark.parametrize("name", DRIVES)
def test_what_overrides_waiting_steps_is_heard_at_once(name: str) -> None:
    session = slow_session()
    for _ in range(400):
        session.step(MOST_STEPS)
    session._tick()
    DRIVES[name](session)
    assert session.waiting_steps == 0
    session._tick()
    assert session.loop.number <= 3 * SLICE
    assert session.playing == (name == "play")


def test_steps_asked_for_in_a_row_add_up_to_as_many_as_may_wait() -> None:
    commands = Commands()
    for count in (1, 7, 2):
        commands.add_steps(count)
    assert commands.take(100) == 10
    for _ in range(400):
        commands.add_steps(MOST_STEPS)
    assert commands.steps == MOST_STEPS
    assert commands.take(MOST_STEPS + 1) == MOST_STEPS
    assert commands.take(1) is None


def test_an_edit_takes_force_after_the_steps_that_were_asked_for_before_it() -> None:
    session = slow_session()
    changed = pack(Experiment().patched({"lanes": {"RBFNN-NFTSM": {"nu": 30}}}))
    session.step(3)
    session.adopt(changed, 2)
    assert session.waiting_steps == 3
    while session.revision == 1:
        assert session.loop.number <= 3
        session._tick()
    assert session.loop.number == 3


def test_an_edit_right_after_another_experiment_is_not_lost() -> None:
    session = slow_session()
    session.load(pack(Experiment()), 2)
    session.adopt(pack(Experiment().patched({"lanes": {"RBFNN-NFTSM": {"nu": 30}}})), 3)
    session._tick()
    assert session.revision == 3
    assert session.loop.packed.experiment.lanes["RBFNN-NFTSM"].nu == 30


def test_of_edits_in_a_row_one_waits() -> None:
    commands, done = Commands(), []
    for number in range(5 * MOST_COMMANDS):
        commands.add_latest(lambda number=number: done.append(number))  # type: ignore[misc]
    commands.refuse_if_full()
    while callable(command := commands.take(1)):
        command()
    assert done == [5 * MOST_COMMANDS - 1]


def test_one_command_more_than_may_wait_is_refused_but_reset_is_heard() -> None:
    session = slow_session()
    for _ in range(MOST_COMMANDS // 2):
        session.step(1)
        session.kick((1.0,) * 6, 0.1)
    with pytest.raises(SessionBusyError, match="try again"):
        session.kick((1.0,) * 6, 0.1)
    session.reset()
    session._tick()
    session.kick((1.0,) * 6, 0.1)


def test_an_answer_says_how_many_steps_are_made_before_it_takes_force(served: Served) -> None:
    http = served.http
    assert http.post("/api/session/pause").json()["waiting_steps"] == 0
    asked = http.post("/api/session/step", json={"count": 4000}).json()["waiting_steps"]
    patched = http.patch("/api/experiment", json={"title": "later"}).json()["waiting_steps"]
    assert 4000 >= asked >= patched >= 0
    assert http.post("/api/session/reset").json() == {"accepted": True, "waiting_steps": 0}
    assert http.get("/api/session").json()["waiting_steps"] == 0
