"""What people and programs do to a server all day, each as one short visit.

A visit does something, at random but by seed, and returns. A refusal (4xx, ``error``) is an answer
like any other: visits get into each other's way on purpose. What may not come is a failure of the
server (5xx) or no answer at all.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from random import Random
from socket import SHUT_RDWR
from threading import Event, Lock, Thread
from typing import Any

import httpx
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tests.server.scene.viser_client import ViserClient

GAINS = ("nu", "c", "k1", "k2", "epsilon")
PAGES = (
    "/",
    "/static/api/api.js",
    "/scene/",
    "/api/health",
    "/api/schema",
    "/api/experiment",
    "/api/experiment?format=yaml",
    "/api/session",
    "/api/metrics",
    "/api/presets",
    "/api/presets/realistic?format=yaml",
    "/api/history",
    "/api/session/past",
    "/api/lessons",
    "/openapi.json",
    "/api/nothing",
)
BUSY = 503
"""The one answer above 499 that is a refusal: ask again."""
PATIENCE = 60.0
"""Longest wait for an answer in [s] (*ours*)."""
PLAIN: dict[str, Any] = {"timeout": PATIENCE, "trust_env": False, "verify": False}
"""Of every request: no proxy, and no time for certificates that HTTP never reads."""


@dataclass
class World:
    """The server, and what happened.

    Attributes:
        port: of the server on this machine.
        stop: set when everybody is to leave.
        done: how often each thing was done.
        failures: what may not happen, in words.
    """

    port: int
    stop: Event = field(default_factory=Event)
    done: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    _lock: Lock = field(default_factory=Lock)

    def note(self, what: str) -> None:
        """Count one thing done."""
        with self._lock:
            self.done[what] += 1

    def fail(self, text: str) -> None:
        """Remember what may not happen."""
        with self._lock:
            self.failures.append(text)

    def ask(self, method: str, path: str, document: object = None) -> httpx.Response | None:
        """Ask over HTTP; a failure of the server is remembered, and ``None`` returned."""
        self.note("HTTP requests")
        address = f"http://127.0.0.1:{self.port}{path}"
        try:
            answer = httpx.request(method, address, json=document, **PLAIN)
        except httpx.HTTPError as error:
            self.fail(f"{method} {path}: {type(error).__name__}: {error}")
            return None
        if answer.status_code >= 500 and answer.status_code != BUSY:
            self.fail(f"{method} {path}: {answer.status_code} {answer.text[:200]}")
        if answer.status_code >= 400:
            self.note("HTTP refusals")
        return answer

    def lanes(self) -> list[str]:
        """Return the names of the lanes."""
        answer = self.ask("GET", "/api/experiment")
        return list(answer.json()["experiment"]["lanes"]) if answer is not None else ["?"]

    def live(self) -> ClientConnection:
        """Open the live WebSocket."""
        self.note("live clients")
        address = f"ws://127.0.0.1:{self.port}/api/live"
        return connect(address, compression=None, max_size=None, proxy=None, open_timeout=PATIENCE)


Visit = Callable[[World, Random], None]


def edit(world: World, dice: Random) -> None:
    """Turn knobs for a while, and do what else the page lets one do."""
    with suppress(ConnectionClosed), world.live() as socket:
        lanes = [lane["name"] for lane in json.loads(socket.recv(timeout=PATIENCE))["lanes"]]
        for number in range(dice.randrange(20, 60)):
            if world.stop.is_set():
                return
            socket.send(json.dumps({**_words(dice, lanes), "id": number}))
            world.note("edits and commands")
            _drain(socket, dice.uniform(0.01, 0.1))


def _words(dice: Random, lanes: list[str]) -> dict[str, object]:
    lane = dice.choice(lanes)
    gain = {dice.choice(GAINS): 10.0 ** dice.uniform(-1.0, 1.5)}
    others: list[dict[str, object]] = [
        {"type": "kick"},
        {"type": "select", "lane": lane},
        {"type": "view", "exaggeration": dice.choice([1, 5, 20]), "ghosts": dice.random() < 0.5},
        {"type": "speed", "speed": dice.choice([0.5, 1, 2])},
        {"type": "lane", "origin": lane, "name": f"copy {dice.randrange(100)}"},
        {"type": "patch", "patch": {"lanes": {dice.choice(lanes[1:] or lanes): None}}},
        {"type": "patch", "patch": {"robot": {"payload": {"mass": dice.choice([0, 1, 3])}}}},
        {"type": "patch", "patch": {"trajectory": {"kind": dice.choice(["sine", "quintic"])}}},
        {"type": "patch", "patch": {"lanes": {lane: {"nu": -1}}}},
        {"type": "nonsense"},
    ]
    return dice.choice(others) if dice.random() < 0.2 else _patch(lane, gain)


def _patch(lane: str, gain: dict[str, float]) -> dict[str, object]:
    return {"type": "patch", "patch": {"lanes": {lane: gain}}}


def _drain(socket: ClientConnection, seconds: float) -> None:
    with suppress(TimeoutError):
        while True:
            socket.recv(timeout=seconds)
            seconds *= 0.8


def change_preset(world: World, dice: Random) -> None:
    """Load a preset, replace the document, reset, pause and go on."""
    match dice.randrange(5):
        case 0 | 1:
            presets = ("paper", "realistic", "paper-undisturbed", "experiment-quintic")
            world.ask("POST", f"/api/presets/{dice.choice(presets)}/load")
            world.note("presets loaded")
        case 2:
            answer = world.ask("GET", "/api/presets/chattering-tanh")
            if answer is not None:
                world.ask("PUT", "/api/experiment", answer.json()["experiment"])
                world.note("documents replaced")
        case 3:
            world.ask("POST", "/api/session/reset")
            world.note("resets")
        case _:
            world.ask("POST", "/api/session/pause")
            world.ask("POST", "/api/session/step", {"count": 50})
            world.ask("POST", "/api/session/play")
            world.note("pauses")


def keep_preset(world: World, dice: Random) -> None:
    """Save the live experiment as a preset and delete it again."""
    name = f"soak-{dice.randrange(3)}"
    world.ask("PUT", f"/api/presets/{name}?overwrite=true")
    world.ask("DELETE", f"/api/presets/{name}")
    world.note("presets saved and deleted")


def travel(world: World, dice: Random) -> None:
    """Look back, branch off from the past, go back to an earlier edit."""
    past = world.ask("GET", "/api/session/past")
    if past is None or past.json()["to"] is None:
        return
    begin, end = past.json()["from"], past.json()["to"]
    world.ask("POST", "/api/session/look", {"time": dice.uniform(begin, end)})
    world.ask("POST", "/api/session/look", {"time": None})
    world.ask("POST", "/api/session/play")
    fork = {
        "time": dice.uniform(begin, end),
        "origin": dice.choice(world.lanes()),
        "name": f"fork {dice.randrange(100)}",
        "gains": {"nu": dice.uniform(1.0, 30.0)},
    }
    answer = world.ask("POST", "/api/session/fork", fork)
    if answer is not None and answer.is_success:
        world.note("forks")
    history = world.ask("GET", "/api/history")
    if history is not None and (edits := history.json()["edits"]):
        world.ask("POST", f"/api/history/{dice.choice(edits)['number']}/restore")
        world.note("edits undone")


def come_and_go(world: World, dice: Random) -> None:
    """Connect to the live WebSocket and leave: politely, by breaking off, or after silence."""
    with suppress(ConnectionClosed):
        socket = world.live()
        try:
            for _ in range(dice.randrange(1, 30)):
                socket.recv(timeout=PATIENCE)
            if dice.random() < 0.3:
                world.stop.wait(dice.uniform(0.5, 3.0))  # not reading
        finally:
            if dice.random() < 0.5:
                break_off(socket)
            socket.close()


def break_off(connection: ClientConnection) -> None:
    """End a connection without a word, as a lost network does."""
    with suppress(OSError):
        connection.socket.shutdown(SHUT_RDWR)


def browse(world: World, dice: Random) -> None:
    """Get some pages."""
    for path in dice.sample(PAGES, 4):
        world.ask("GET", path)


def preview(world: World, dice: Random) -> None:
    """Ask for whole responses as a drag does; sometimes for two at once, so that one gives way."""
    lane = dice.choice(world.lanes())
    wanted = {
        "patch": {"lanes": {lane: {"nu": dice.uniform(1.0, 30.0)}}},
        "estimate": dice.random() > 0.7,
        "client": "soak",
        "show": dice.random() < 0.7,
    }
    twin = Thread(target=world.ask, args=("POST", "/api/preview", wanted))
    if dice.random() < 0.4:
        twin.start()
    world.ask("POST", "/api/preview", wanted)
    world.note("previews")
    if twin.ident is not None:
        twin.join()
        world.note("previews")


def study(world: World, dice: Random) -> None:
    """Begin a study and break it off after a few lines."""
    address = f"http://127.0.0.1:{world.port}/api/studies/strip"
    wanted = {"lane": dice.choice(world.lanes()), "field": "nu", "count": 12}
    world.note("studies cancelled")
    with (
        suppress(httpx.TransportError),  # it is we who leave
        httpx.stream("POST", address, json=wanted, **PLAIN) as answer,
    ):
        for number, _ in enumerate(answer.iter_lines()):
            if number >= 1 or world.stop.is_set():
                return


def watch(world: World, dice: Random) -> None:
    """Watch the 3D scene for a moment and pull at the arm, through the relay."""
    world.note("viewers of the 3D scene")
    try:
        viewer = ViserClient(world.port, "/scene/")
    except (OSError, AssertionError, TimeoutError, ConnectionClosed) as error:
        world.fail(f"3D scene: {type(error).__name__}: {error}")
        return
    with suppress(ConnectionClosed):
        if dice.random() < 0.5:
            viewer.drag("start", "/pull")
            for _ in range(5):
                viewer.drag("update", "/pull", [dice.uniform(-0.5, 0.5) for _ in range(3)])
                world.stop.wait(0.1)
            if dice.random() < 0.7:  # otherwise it leaves with the button down
                viewer.drag("end", "/pull")
        world.stop.wait(dice.uniform(0.2, 2.0))
    (viewer.break_off if dice.random() < 0.5 else viewer.close)()
