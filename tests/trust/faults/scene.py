"""The 3D scene's connections that break: the browser's own, and the one behind the relay."""

from __future__ import annotations

import ctypes
import os
import random
import socket
import sys
import time
from contextlib import closing
from pathlib import Path

import numpy as np

from tests.server.scene.viser_client import ViserClient
from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.live import Follower
from tests.trust.faults.server import Server, served, wait_for

SCENE = "/scene"
PIDFD_GETFD = 438
"""Number of the system call, the same on every processor."""


def _sockets(process: int) -> list[socket.socket]:
    """Return copies of all sockets of another process; none where the system doesn't let us."""
    library = ctypes.CDLL(None, use_errno=True)
    handle = os.pidfd_open(process)
    found = []
    try:
        for path in Path(f"/proc/{process}/fd").iterdir():
            try:
                if not os.readlink(path).startswith("socket:"):
                    continue
            except OSError:  # closed meanwhile
                continue
            number = library.syscall(PIDFD_GETFD, handle, int(path.name), 0)
            if number >= 0:
                found.append(socket.socket(fileno=number))
    finally:
        os.close(handle)
    return found


def cut_upstream(server: Server) -> int:
    """Shut down the server's own connections between relay and scene; return how many."""
    cut = 0
    for copy in _sockets(server.process.pid):
        with closing(copy):
            if copy.family != socket.AF_INET or copy.type != socket.SOCK_STREAM:
                continue
            try:
                ends = copy.getsockname(), copy.getpeername()
            except OSError:  # it listens
                continue
            if server.port not in (ends[0][1], ends[1][1]):
                copy.shutdown(socket.SHUT_RDWR)
                cut += 1
    return cut


def _is_whole(client: ViserClient, nodes: set[str], promises: Promises, what: str) -> None:
    """Check that a client has got the whole scene, and that its arms move."""
    missing = nodes - set(client.nodes)
    promises.hold(not missing, f"after {what} the scene lacks {sorted(missing)[:3]}")
    moving = _places(client)
    wait_for(lambda: _moved(moving, _places(client)) > 5, f"moving arms after {what}", 15.0)


def _places(client: ViserClient) -> dict[str, np.ndarray]:
    """Return where everything is: turned nodes and batches of links."""
    places = {name: pose["wxyz"] for name, pose in tuple(client.poses.items())}
    batched = "batched_wxyzs"
    for name, props in tuple(client.nodes.items()):
        if batched in props:
            places[f"{name}/{batched}"] = np.array(props[batched])
    return places


def _moved(before: dict[str, np.ndarray], after: dict[str, np.ndarray]) -> int:
    return sum(not np.array_equal(value, after.get(name)) for name, value in before.items())


def drop_scene(quick: bool) -> Outcome:
    """Break the scene's connections again and again."""
    promises, dice, times = Promises(), random.Random(4), 2 if quick else 20
    cuts, waits = 0, []
    with served() as server, Follower(server.port) as live:
        first = ViserClient(server.port, SCENE)
        wait_for(lambda: len(first.nodes) > 20, "a scene", 15.0)
        nodes = set(first.nodes)
        _is_whole(first, nodes, promises, "the start")
        client = first
        for number in range(times):
            time.sleep(dice.uniform(0.05, 0.3))
            what = "a client that broke off"
            if number % 2 and sys.platform == "linux":
                what = "a cut behind the relay"
                promises.hold(cut_upstream(server), "nothing to cut behind the relay")
                cuts += 1
                client.wait_closed()
            else:
                client.break_off()
            begin = time.monotonic()
            client = ViserClient(server.port, SCENE)
            waits.append(time.monotonic() - begin)
            _is_whole(client, nodes, promises, what)
        client.close()
        promises.hold(not live.closed and not live.faults, f"the page got {live.faults[:1]}")
        promises.hold(not server.complaints, f"the server wrote: {server.complaints[:1]}")
    measured = (
        f"all {len(nodes)} nodes again, {max(waits):.2f} s after the connection at most; arms "
        "move; the dashboard's connection stayed"
    )
    often = f"{times} times: {times - cuts} by the browser, {cuts} behind the relay"
    return promises.outcome(often, measured)


FAULTS = (
    Fault(
        "scene",
        "The 3D scene's connection breaks",
        "A new connection gets the complete scene, and the arms move",
        drop_scene,
    ),
)
