"""A client of the live WebSocket that costs next to nothing: it reads the heads of frames."""

from __future__ import annotations

import asyncio
import json
import re
import socket
from bisect import bisect_left
from contextlib import suppress
from time import perf_counter
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from slidetune.server.live.telemetry import HEADER

SMALL = 64 * 1024
"""Bytes that the kernel holds for a client that doesn't read (*ours*)."""
_ECHO = re.compile(r'\{"type":"patch","revision":(\d+),"author":"([^"]*)","id":(\d+|null)')


async def opened(port: int, silent: bool = False) -> ClientConnection:
    """Connect to the live WebSocket.

    Args:
        port: of the server on this machine.
        silent: whether it is for somebody who won't read: then little is held here.
    """
    plain = socket.socket()
    if silent:
        plain.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SMALL)
    plain.connect(("127.0.0.1", port))
    plain.setblocking(False)
    return await connect(
        f"ws://127.0.0.1:{port}/api/live",
        sock=plain,
        compression=None,
        max_size=None,
        max_queue=1 if silent else 64,
        ping_interval=None,
        proxy=None,
    )


class Listener:
    """One client that reads.

    Attributes:
        name: its id, as the server calls it.
        frames: how many it got.
        dropped: rows that it missed.
        span: arrival [s] and simulated time [s] of its first and its last frame.
        revisions: of all patches that it was told of, in the order in which it was told.
        answers: when each of its own patches was echoed or refused in [s], by number.
        own: revision of each of its own patches that was taken, by number.
        refused: numbers of its own patches that were refused.
        last: the last patch message, as text.
        hellos: how often it was given a fresh start.
        ended: whether the server hung up.
    """

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection
        self.ended = False
        self.name = ""
        self._effects: list[tuple[int, float]] = [(0, 0.0)]
        self.hellos = 0
        self.forget()

    def forget(self) -> None:
        """Count from 0 again."""
        self.frames = self.dropped = 0
        self.span: list[tuple[float, float]] = []
        self.revisions: list[int] = []
        self.answers: dict[int, float] = {}
        self.own: dict[int, int] = {}
        self.refused: set[int] = set()
        self.last = ""

    def effect(self, revision: int) -> float | None:
        """Return when the first frame under a revision or a later one came in [s]."""
        index = bisect_left(self._effects, (revision, 0.0))
        return self._effects[index][1] if index < len(self._effects) else None

    async def say(self, **message: Any) -> None:
        """Send a message."""
        await self.connection.send(json.dumps(message))

    async def listen(self) -> None:
        """Read until the connection ends."""
        with suppress(ConnectionClosed):
            async for message in self.connection:
                if isinstance(message, bytes):
                    self._frame(message)
                else:
                    self._text(message)
        self.ended = True

    def _frame(self, message: bytes) -> None:
        arrival = perf_counter()
        revision, rows, _, dropped, first, period = HEADER.unpack_from(message)
        self.frames += 1
        self.dropped += dropped
        if revision > self._effects[-1][0]:
            self._effects.append((revision, arrival))
        self.span = [*self.span[:1], (arrival, first + rows * period)]

    def _text(self, message: str) -> None:
        if echo := _ECHO.match(message):
            revision, author, number = echo.groups()
            self.revisions.append(int(revision))
            self.last = message
            if author == self.name and number != "null":
                self.answers[int(number)] = perf_counter()
                self.own[int(number)] = int(revision)
        elif message.startswith('{"type":"error"'):
            number = json.loads(message)["id"]
            self.answers[number] = perf_counter()
            self.refused.add(number)
        elif message.startswith('{"type":"hello"'):
            self.name = json.loads(message)["client"]
            self.hellos += 1


async def woken(connection: ClientConnection, seconds: float) -> int:
    """Let somebody who hasn't read begin to; return how many rows the server skipped for it."""
    skipped = 0
    with suppress(ConnectionClosed, TimeoutError):
        async with asyncio.timeout(seconds):
            async for message in connection:
                if isinstance(message, bytes):
                    skipped += HEADER.unpack_from(message)[3]
    return skipped
