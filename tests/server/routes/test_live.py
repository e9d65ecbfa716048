"""The live WebSocket, through a real socket."""

from __future__ import annotations

import json
import struct
import time
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tests.server.conftest import Served

Message = dict[str, Any]


def text(socket: ClientConnection, kind: str, seconds: float = 15.0) -> Message:
    """Return the next message of a kind."""
    end = time.monotonic() + seconds
    while True:
        raw = socket.recv(timeout=max(0.1, end - time.monotonic()))
        if isinstance(raw, str):
            message: Message = json.loads(raw)
            if message["type"] == kind:
                return message
        assert time.monotonic() < end, f"no {kind} message came"


def frame(socket: ClientConnection) -> tuple[int, int, int, float, np.ndarray]:
    """Return revision, columns, dropped, time and data of the next frame."""
    while True:
        raw = socket.recv(timeout=15.0)
        if isinstance(raw, bytes):
            revision, rows, columns, dropped, t, _ = struct.unpack_from("<IIIIdd", raw)
            data = np.frombuffer(raw, np.float32, offset=32).reshape(columns, rows)
            return revision, columns, dropped, t, data


def say(socket: ClientConnection, **message: Any) -> None:
    socket.send(json.dumps(message))


def flood(socket: ClientConnection) -> None:
    """Send more than a message may hold, and listen until the server hangs up."""
    socket.send("x" * 1_000_000)
    while True:
        socket.recv(timeout=15.0)


def test_hello_comes_first_and_describes_the_frames(served: Served) -> None:
    with connect(served.live) as socket:
        hello = json.loads(socket.recv())
        assert hello["type"] == "hello"
        assert [lane["name"] for lane in hello["lanes"]] == ["RBFNN-NFTSM", "RBFNN-SMC", "NFTSM"]
        assert len({lane["color"] for lane in hello["lanes"]}) == 3
        assert hello["experiment"] == served.app_state.document.experiment.document()
        _, columns, dropped, _, data = frame(socket)
        assert columns == len(hello["channels"])
        assert dropped == 0
        assert np.isfinite(data).all()


def test_a_patch_is_echoed_to_all_and_marks_the_frames_that_follow(served: Served) -> None:
    before = served.app_state.document.revision
    with connect(served.live) as author, connect(served.live) as other:
        name = text(author, "hello")["client"]
        text(other, "hello")
        say(author, type="patch", id=41, patch={"lanes": {"NFTSM": {"nu": 30}}})
        echoes = [text(author, "patch"), text(other, "patch")]
        for echo in echoes:
            assert echo["author"] == name
            assert echo["id"] == 41
            assert echo["experiment"]["lanes"]["NFTSM"]["nu"] == 30
        revision = echoes[0]["revision"]
        assert revision == echoes[1]["revision"] == before + 1
        while frame(other)[0] != revision:
            pass


@pytest.mark.parametrize(
    ("message", "path", "said"),
    [
        ({"type": "patch", "patch": {"lanes": {"NFTSM": {"nu": -1}}}}, "lanes.NFTSM.nu", "0.01"),
        ({"type": "patch", "patch": {"lanes": {"NFTSM": {"nuu": 1}}}}, "lanes.NFTSM.nuu", "nu?"),
        ({"type": "patch", "patch": {"lanes": {"NFTSM": None}, "x": 1}}, "x", "unknown"),
        ({"type": "lane", "origin": "nobody", "name": "B"}, "origin", "NFTSM"),
        ({"type": "lane", "origin": "NFTSM", "name": "RBFNN-SMC"}, "name", "already"),
        ({"type": "select", "lane": "nobody"}, "lane", "NFTSM"),
        ({"type": "speed", "speed": 99}, "speed", "10"),
        ({"type": "view", "exaggeration": 0}, "exaggeration", "1"),
        ({"type": "kick", "torque": [1, 2]}, "torque", "6 joints"),
        ({"type": "dance"}, "type", "dance"),
    ],
)
def test_a_bad_message_is_refused_to_its_sender_and_changes_nothing(
    served: Served, message: Message, path: str, said: str
) -> None:
    before, revision = served.app_state.document.experiment, served.app_state.document.revision
    with connect(served.live) as socket:
        text(socket, "hello")
        say(socket, **message, id="mine")
        refusal = text(socket, "error")
        assert refusal["id"] == "mine"
        fields = {field["path"]: field["message"] for field in refusal["error"]["fields"]}
        assert path in fields
        assert said in fields[path]
    assert served.app_state.document.experiment is before
    assert served.app_state.document.revision == revision


@pytest.mark.parametrize(
    "raw", ["", "{", "null", "[]", '{"type":"patch","patch":{"a":NaN}}', "[" * 5000]
)
def test_text_that_is_no_message_is_refused_in_words(served: Served, raw: str) -> None:
    with connect(served.live) as socket:
        text(socket, "hello")
        socket.send(raw)
        assert text(socket, "error")["error"]["message"]


def test_an_oversized_message_closes_that_connection_only(served: Served) -> None:
    with connect(served.live) as other:
        text(other, "hello")
        with connect(served.live) as socket:
            text(socket, "hello")
            with pytest.raises(ConnectionClosed):
                flood(socket)
        assert text(other, "state")["playing"]


def test_commands_act(served: Served) -> None:
    with connect(served.live) as socket:
        text(socket, "hello")
        say(socket, type="pause")
        while text(socket, "state")["playing"]:
            pass
        say(socket, type="reset")
        say(socket, type="step", count=5)
        while text(socket, "state")["time"] != pytest.approx(0.005):
            pass
        say(socket, type="speed", speed=0.5)
        while text(socket, "state")["speed"] != 0.5:
            pass
        say(socket, type="select", lane="NFTSM")
        say(socket, type="view", exaggeration=20, ghosts=False)
        while (state := text(socket, "state"))["view"] != {"exaggeration": 20, "ghosts": False}:
            pass
        assert state["selected"] == "NFTSM"


def test_a_duplicated_lane_brings_a_fresh_start_with_its_channels(served: Served) -> None:
    with connect(served.live) as socket:
        first = text(socket, "hello")
        say(socket, type="lane", origin="NFTSM", name="NFTSM 2")
        second = text(socket, "hello")
        assert [lane["name"] for lane in second["lanes"]][-1] == "NFTSM 2"
        own = [c for c in first["channels"] if c["lane"] == "NFTSM"]
        assert len(second["channels"]) == len(first["channels"]) + len(own)
        assert second["experiment"]["lanes"]["NFTSM 2"] == second["experiment"]["lanes"]["NFTSM"]
        while frame(socket)[1] != len(second["channels"]):
            pass


def test_a_renamed_lane_keeps_its_colour_place_and_state(served: Served) -> None:
    with connect(served.live) as socket:
        hello = text(socket, "hello")
        gains = hello["experiment"]["lanes"]["RBFNN-SMC"]
        patch = {"lanes": {"RBFNN-SMC": None, "Rival": gains}}
        say(socket, type="patch", id=1, patch=patch)
        renamed = text(socket, "hello")
        assert renamed["lanes"][1] == {"name": "Rival", "color": hello["lanes"][1]["color"]}
        assert renamed["state"]["time"] > 0.0
        assert renamed["baseline"]["lanes"]["Rival"] == gains


def test_metrics_come_with_margins_and_remarks(served: Served) -> None:
    with connect(served.live) as socket:
        text(socket, "hello")
        lanes = text(socket, "metrics")["lanes"]
        assert set(lanes) == {"RBFNN-NFTSM", "RBFNN-SMC", "NFTSM"}
        assert lanes["NFTSM"]["gamma"] is None
        assert any("c/ν" in note["message"] for note in lanes["NFTSM"]["notes"])
        assert len(lanes["NFTSM"]["total"]["mae"]) == 6
        say(socket, type="patch", patch={"simulation": {"mode": "sampled"}})
        while (gamma := text(socket, "metrics")["lanes"]["NFTSM"]["gamma"]) is None:
            pass
        assert gamma > 1000


def test_clients_that_leave_are_forgotten(served: Served) -> None:
    for _ in range(5):
        with connect(served.live) as socket:
            text(socket, "hello")
    with connect(served.live) as socket:
        text(socket, "hello")
        served.http.get("/api/health").raise_for_status()


def test_concurrent_patches_are_all_applied_in_one_order(served: Served) -> None:
    before = served.app_state.document.revision
    with connect(served.live) as one, connect(served.live) as two:
        text(one, "hello")
        text(two, "hello")
        for index in range(50):
            say(one, type="patch", id=index, patch={"lanes": {"NFTSM": {"nu": 1 + index}}})
            say(two, type="patch", id=index, patch={"lanes": {"RBFNN-SMC": {"k1": 100 + index}}})
        seen = [[text(socket, "patch")["revision"] for _ in range(100)] for socket in (one, two)]
        assert seen[0] == seen[1] == list(range(before + 1, before + 101))
    lanes = served.app_state.document.experiment.lanes
    assert (lanes["NFTSM"].nu, lanes["RBFNN-SMC"].k1) == (50, 149)
