"""What those who have left leave behind: nothing."""

from __future__ import annotations

import base64
import gc
import os
import socket
import struct
import sys
import threading
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.sync.client import connect

from tests.server.conftest import Served
from tests.server.routes.test_live import text
from tests.server.scene.viser_client import ViserClient, until

POOLS = ("AnyIO worker thread", "asyncio_", "ThreadPoolExecutor")
"""Threads that stay for the next request, whoever that comes from."""
PATCHES = 100
"""As many as take the server longer than the time between two frames."""


def sockets() -> int:
    found = 0
    for link in Path("/proc/self/fd").iterdir():
        with suppress(OSError):  # closed meanwhile
            found += os.readlink(link).startswith("socket:")
    return found


def threads() -> int:
    return sum(not thread.name.startswith(POOLS) for thread in threading.enumerate())


def visit(served: Served) -> set[str]:
    """Come politely and break off, watch the scene; return the nodes that were seen."""
    with connect(served.live) as polite, connect(served.live) as rude:
        text(polite, "hello")
        text(rude, "hello")
        rude.socket.shutdown(socket.SHUT_RDWR)
    with ViserClient(urlsplit(served.url).port or 0, "/scene/") as viewer:
        return set(viewer.nodes)


@pytest.mark.skipif(sys.platform != "linux", reason="counts sockets in /proc")
def test_visitors_leave_no_thread_socket_or_node_behind(served: Served) -> None:
    nodes = visit(served)
    before = sockets(), threads()
    for _ in range(5):
        assert visit(served) == nodes
    until(lambda: sockets() <= before[0] and threads() <= before[1])


@contextmanager
def without_collector() -> Iterator[None]:
    """Leave it to the counts of references to free what is left."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def ask_and_break_off(served: Served) -> None:
    """Send many patches and reset the connection, so that the server finds out while it writes."""
    port = urlsplit(served.url).port
    head = f"GET /api/live HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
    key = "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {}\r\n\r\n"
    patch = b'{"type":"patch","patch":{"lanes":{"NFTSM":{"nu":30}}}}'
    with socket.create_connection(("127.0.0.1", port)) as plain:
        plain.sendall((head + key.format(base64.b64encode(bytes(16)).decode())).encode())
        assert plain.recv(1024).startswith(b"HTTP/1.1 101 ")
        # One text frame each, masked with zeros as it must be masked with something.
        plain.sendall((bytes([0x81, 0x80 | len(patch), 0, 0, 0, 0]) + patch) * PATCHES)
        plain.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


def test_a_ring_is_freed_at_once_when_its_readers_have_gone_or_gone_on(served: Served) -> None:
    with without_collector(), connect(served.live) as reader:
        text(reader, "hello")
        for _ in range(5):
            ask_and_break_off(served)
        ring = weakref.ref(served.app_state.session.telemetry)
        served.http.patch("/api/experiment", json={"lanes": {"Rival": {"law": "smc"}}})
        while not any(lane["name"] == "Rival" for lane in text(reader, "hello")["lanes"]):
            pass
        until(lambda: ring() is None)
