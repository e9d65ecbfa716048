"""The recording of a run: how many pictures it has, what is in it, and what it leaves behind."""

from __future__ import annotations

import socket
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
import pytest
import zstandard

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.run_report import recording
from slidetune.server.run_report.child import asked_of, film_from
from slidetune.server.run_report.recording import MOST_PICTURES, Film, film_of, record
from slidetune.server.run_report.replay_part import replay_part
from slidetune.server.scene.scene import Scene


def run_of(**changes: Any) -> Run:
    lanes = {"A": {"law": "nftsm"}, "calm": {"law": "computed_torque", "kp": 1, "kd": 1}}
    simulation = {"mode": "sampled", "horizon": 0.5}
    document = {"lanes": lanes, "simulation": simulation, **changes}
    return simulate(Experiment.from_document(document), estimate=False)


@pytest.fixture(scope="module")
def run() -> Run:
    return run_of(robot={"payload": {"mass": 3.0}})


def messages(recorded: bytes) -> list[Any]:
    size = int.from_bytes(recorded[:8], "little")
    inner = zstandard.ZstdDecompressor().decompress(recorded[8:], size)
    length = int.from_bytes(inner[:8], "little")
    return list(msgspec.msgpack.decode(inner[8 : 8 + length])["messages"])


def test_a_second_has_thirty_pictures_and_a_long_run_no_more_than_there_may_be(run: Run) -> None:
    film = film_of(run)
    assert film.rate == pytest.approx(30.0, rel=0.05)
    assert film.rate <= 30.0
    rows = 120_001
    time, nothing = np.arange(rows) * 1e-3, np.zeros((rows, 6))
    long = replace(run, time=time, q_d=nothing, v_d=nothing)
    film = film_of(long)
    assert time[-1] * film.rate <= MOST_PICTURES
    assert film.rate == pytest.approx(5.0, rel=0.05)
    assert film.replay.period <= 0.025


def test_fewer_pictures_have_their_own_reason(run: Run) -> None:
    def said(rows: int, row: float) -> str:
        nothing = np.zeros((rows, 6))
        other = replace(run, time=np.arange(rows) * row, q_d=nothing, v_d=nothing)
        return replay_part(other, film_of(other), "")

    assert "pictures for each second of the run." in said(2001, 1e-3)
    assert "15.2 pictures for each second of the run (fewer than usual, because its rows" in said(
        123, 1 / 61
    )
    assert "(fewer than usual, because the run is long)" in said(120_001, 1e-3)


def test_all_lanes_move_and_one_that_diverged_stands_still(run: Run) -> None:
    assert run.lanes["A"].freeze is not None
    told = messages(record(film_of(run)))
    assert [time for time, _ in told] == sorted(time for time, _ in told)
    turned: dict[str, int] = {}
    for time, message in told:
        if time > 0.1 and message["type"] == "SetOrientationMessage":
            arm = message["name"].split("/")[1]
            turned[arm] = turned.get(arm, 0) + 1
    assert turned.get("ghost_1", 0) > 0
    assert turned.get("arm", 0) == turned.get("ghost_0", 0) == 0
    names = {message["name"] for _, message in told if "name" in message}
    assert {"/desired/path", "/desired/now", "/trail_0", "/trail_1"} <= names
    assert any(name.endswith("/flange/payload") for name in names)
    assert not any(name.startswith("/pull") for name in names)


def test_the_last_picture_is_of_the_end(run: Run) -> None:
    film = film_of(run)
    rows = len(film.replay.q_d) - 1
    assert rows % film.rows, "this run ends between two pictures"
    told = messages(record(film))
    moved = [(t, m) for t, m in told if m["type"] == "SetPositionMessage"]
    time, place = [(t, m["position"]) for t, m in moved if m["name"] == "/desired/now"][-1]
    assert time == pytest.approx(rows * film.replay.period)
    assert place == pytest.approx(film.replay.desired[-1], abs=1e-6)


def test_no_port_stays_open(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    ports: list[int] = []

    class Seen(Scene):
        def close(self) -> None:
            ports.append(self.port)
            with socket.create_connection(("127.0.0.1", self.port), 5.0):
                pass  # until then it is open
            super().close()

    monkeypatch.setattr(recording, "Scene", Seen)
    record(film_of(run))
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", ports[0]), 5.0)


def test_a_film_reaches_the_process_that_records_it_as_it_is(run: Run) -> None:
    film = film_of(run)
    there: Film = film_from(asked_of(film))
    assert (there.rows, there.replay.robot) == (film.rows, film.replay.robot)
    assert there.replay.styles == film.replay.styles
    for name, angles in film.replay.q.items():
        assert np.allclose(there.replay.q[name], angles, rtol=1e-6, atol=1e-7, equal_nan=True)
        assert there.replay.flange[name].shape == film.replay.flange[name].shape
    assert np.allclose(there.replay.q_d, film.replay.q_d, rtol=1e-6, atol=1e-7)


def test_another_arm_is_drawn_and_no_other() -> None:
    lane = {"A": {"law": "smc", "k1": 5.0, "k2": 1.0, "epsilon": 0.1}}
    film = film_of(run_of(robot={"model": "pendulum"}, lanes=lane))
    looks = [m for _, m in messages(record(film)) if m["type"] == "GlbMessage"]
    assert 0 < len(looks) <= 2  # a base and one joint
