"""Fills all that is bounded, so that what grows after it is a leak and not a cache."""

from __future__ import annotations

import json
from random import Random
from threading import Thread

from slidetune.server.compute.preview import KEPT
from slidetune.server.state.edit_history import LENGTH
from tests.trust.bar import Bar
from tests.trust.soak.visitors import PATIENCE, World, watch

LANES = 6
"""As many as an experiment may have: each has nodes of its own in the 3D scene."""
AT_ONCE = 8
"""Requests at once, so that pools of threads reach the size that they keep (*ours*)."""
MOVES = 20
"""Patches that each of them sends at once (*ours*)."""
ANSWERS = ('{"type":"patch"', '{"type":"error"', '{"type":"hello"')
"""How an answer begins; a client that lags too far gets a fresh start for one."""


def fill(world: World, bar: Bar) -> None:
    """Make every lane, edit and preview that the server remembers, and use every pool."""
    bar.show("Soak: filling what is bounded: lanes", 0.0)
    world.ask("POST", "/api/presets/paper/load")
    law = {"law": "nftsm"}
    lanes = {f"lane {number}": law for number in range(LANES - 3)}
    world.ask("PATCH", "/api/experiment", {"lanes": lanes})
    world.ask("POST", "/api/preview", {"estimate": False, "show": True})
    for seed in range(3):
        watch(world, Random(seed))
    edits = LENGTH + 20
    for number in range(edits):
        bar.show("Soak: filling what is bounded: edits", number / edits)
        name = ("nu", "c")[number % 2]  # by turns, so that they aren't joined into one
        world.ask("PATCH", "/api/experiment", {"lanes": {"NFTSM": {name: 1.0 + 0.01 * number}}})
    for number in range(KEPT):
        bar.show("Soak: filling what is bounded: previews", number / KEPT)
        patch = {"lanes": {"NFTSM": {"nu": 2.0 + number}}}
        world.ask("POST", "/api/preview", {"estimate": number % 2 == 1, "patch": patch})
    bar.show("Soak: filling what is bounded: pools of threads", 0.9)
    _crowd(world)


def _crowd(world: World) -> None:
    crowd = [
        Thread(target=visit, args=(world, number))
        for number in range(AT_ONCE)
        for visit in (_drag, _reset)
    ]
    for visitor in crowd:
        visitor.start()
    for visitor in crowd:
        visitor.join()


def _drag(world: World, number: int) -> None:
    """Send many patches at once over the live WebSocket, and wait for all answers."""
    with world.live() as socket:
        for index in range(MOVES):
            patch = {"lanes": {"NFTSM": {"mu": 1.0 + 0.01 * index + 0.001 * number}}}
            socket.send(json.dumps({"type": "patch", "patch": patch, "id": index}))
        answers = 0
        while answers < MOVES:
            message = socket.recv(timeout=PATIENCE)
            if isinstance(message, str) and message.startswith(ANSWERS):
                answers += 1


def _reset(world: World, number: int) -> None:
    del number
    for _ in range(MOVES // 4):
        world.ask("POST", "/api/session/reset")
        world.ask("GET", "/api/metrics")
