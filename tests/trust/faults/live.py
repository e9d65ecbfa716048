"""A client of the live WebSocket that checks every frame and every message that it gets."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from typing import Any, Self

import numpy as np
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from slidetune.server.live.telemetry import HEADER
from tests.trust.faults.server import wait_for

Message = dict[str, Any]


def strict_json(text: str | bytes) -> Any:
    """Return what a JSON text says.

    Raises:
        ValueError: if it is no JSON, or holds NaN or infinity.
    """

    def refuse(name: str) -> float:
        raise ValueError(f"{name} in a JSON text")

    return json.loads(text, parse_constant=refuse)


class Follower:
    """Listens until it is closed.

    Attributes:
        faults: what was wrong with frames and messages, in words.
        messages: last message of each type.
        states: arrival [s] and simulated time [s] of every ``state``.
        notices: texts of all notices.
        frames: how many frames came.
        rows: how many rows they held.
        last: arrival [s] of the last frame and simulated time of its last row [s].
        closed: whether the server ended the connection.
    """

    def __init__(self, port: int) -> None:
        """Connect to the server on a port of this machine."""
        self.faults: list[str] = []
        self.messages: dict[str, Message] = {}
        self.states: list[tuple[float, float]] = []
        self.notices: list[str] = []
        self.frames = self.rows = 0
        self.last = (0.0, 0.0)
        self.closed = False
        self._leaving = False
        self._socket = connect(
            f"ws://127.0.0.1:{port}/api/live",
            proxy=None,
            compression=None,
            max_size=None,
            open_timeout=30.0,
            ping_interval=None,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        wait_for(lambda: "hello" in self.messages, "a hello")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._leaving = True
        self._socket.close()
        self._reader.join(10.0)

    def send(self, message: Message) -> None:
        """Send one message."""
        self._socket.send(json.dumps(message))

    @property
    def state(self) -> Message:
        """The last ``state``."""
        return self.messages.get("state") or self.messages["hello"]["state"]

    def wait(self, condition: Callable[[], object], what: str, seconds: float = 30.0) -> None:
        """Wait until something that it heard makes a condition hold."""
        wait_for(lambda: self.closed or condition(), what, seconds)

    def _read(self) -> None:
        try:
            while True:
                message = self._socket.recv()
                if isinstance(message, bytes):
                    self._frame(message)
                else:
                    self._text(message)
        except ConnectionClosed:
            self.closed = not self._leaving

    def _text(self, text: str) -> None:
        arrival = time.monotonic()
        try:
            message = strict_json(text)
        except ValueError as error:
            self.faults.append(str(error))
            return
        self.messages[message["type"]] = message
        if message["type"] == "state":
            self.states.append((arrival, message["time"]))
        elif message["type"] == "notice":
            self.notices.append(message["message"])

    def _frame(self, content: bytes) -> None:
        arrival = time.monotonic()
        _, rows, columns, _, first, period = HEADER.unpack_from(content)
        numbers = np.frombuffer(content, "<f4", offset=HEADER.size)
        if len(numbers) != rows * columns:
            self.faults.append(f"a frame of {len(numbers)} numbers for {rows} × {columns}")
        elif not (np.isfinite(numbers).all() and np.isfinite([first, period]).all()):
            bad = int(np.argmax(~np.isfinite(numbers))) // max(rows, 1)
            channels = self.messages["hello"]["channels"]
            name = channels[bad]["name"] if bad < len(channels) else f"column {bad}"
            self.faults.append(f"a number that is not finite in {name}")
        self.frames += 1
        self.rows += rows
        self.last = (arrival, first + (rows - 1) * period)
