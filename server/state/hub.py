"""The clients of the live WebSocket, and what is told to all of them."""

from __future__ import annotations

import asyncio
import json
import logging
from collections import deque
from collections.abc import Callable
from typing import Any

from starlette.websockets import WebSocket

from slidetune.server.guard.access_policy import Role
from slidetune.server.guard.limits import TOTAL_BURST, TOTAL_RATE
from slidetune.server.guard.token_bucket import TokenBucket
from slidetune.server.state.app_state import AppState
from slidetune.server.state.document import Change

log = logging.getLogger("slidetune.hub")

FRAME = 1.0 / 30.0
"""Time between two telemetry frames to one client in [s] (*ours*)."""
SOONEST = 1.0 / 60.0
"""Least time between two frames, where a slider's effect is waiting, in [s] (*ours*)."""
OUTBOX = 256
"""Messages that wait for a slow client before it is resynchronised instead (*ours*)."""


def encode(message: dict[str, Any]) -> str:
    """Return a message as JSON; a number that isn't finite is a mistake of ours."""
    return json.dumps(message, allow_nan=False, ensure_ascii=False, separators=(",", ":"))


class Client:
    """One browser or script: its own outbox, its own place in the telemetry."""

    def __init__(
        self, name: str, socket: WebSocket, app_state: AppState, role: Role = "owner"
    ) -> None:
        """Begin at the present."""
        self.name = name
        self.role = role
        self._socket = socket
        self._app_state = app_state
        self._outbox: deque[str] = deque()
        self._wake = asyncio.Event()
        self._telemetry: Any = None
        self._cursor = 0
        self._lags = True

    def tell(self, text: str) -> None:
        """Put a message into the outbox; a client that lags too far gets a fresh start instead."""
        if len(self._outbox) >= OUTBOX:
            self._outbox.clear()
            self._lags = True
        self._outbox.append(text)
        self._wake.set()

    def wake(self) -> None:
        """Send what there is, now."""
        self._wake.set()

    async def send(self) -> None:
        """Send messages and frames for as long as the client is there, at its own pace."""
        while True:
            await self._send_messages()
            await self._send_frames()
            self._wake.clear()
            await asyncio.sleep(SOONEST)
            try:
                await asyncio.wait_for(self._wake.wait(), FRAME - SOONEST)
            except TimeoutError:
                continue

    async def _send_messages(self) -> None:
        if self._lags or self._telemetry is not self._app_state.session.telemetry:
            # Before the wait: what is too much meanwhile asks for one more fresh start.
            self._lags = False
            self._telemetry = self._app_state.session.telemetry
            self._cursor = max(0, self._telemetry.written - 1)
            hello = {**self._app_state.hello(self.name, self._telemetry), "role": self.role}
            await self._socket.send_text(encode(hello))
        while self._outbox and not self._lags:
            await self._socket.send_text(self._outbox.popleft())

    async def _send_frames(self) -> None:
        while not self._lags and (frame := self._telemetry.frame(self._cursor)) is not None:
            payload, self._cursor = frame
            await self._socket.send_bytes(payload)


class Hub:
    """All clients, and the news that go to each."""

    def __init__(self, app_state: AppState) -> None:
        """Listen to the document and to the session."""
        self.clients: set[Client] = set()
        self.patches = TokenBucket(TOTAL_RATE, TOTAL_BURST)
        self._app_state = app_state
        self._count = 0
        self._changed = asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None

    def start(self) -> asyncio.Task[None]:
        """Begin to publish, on the running event loop; return the task to cancel at the end."""
        self._loop = asyncio.get_running_loop()
        self._app_state.document.listeners.append(self._on_change)
        self._app_state.session.on_change = lambda: self._soon(self._changed.set)
        self._app_state.session.on_swap = lambda: self._soon(self._wake)
        self._app_state.session.on_notice = self._notice
        self._app_state.law_files.on_change = lambda: self._soon(self._tell_laws)
        return self._loop.create_task(self._publish(), name="slidetune-publish")

    def new_name(self) -> str:
        """Return a name for one more client."""
        self._count += 1
        return f"client-{self._count}"

    def broadcast(self, message: dict[str, Any]) -> None:
        """Tell every client."""
        if self.clients:
            text = encode(message)
            for client in self.clients:
                client.tell(text)

    async def _publish(self) -> None:
        """Tell the state five times a second and on every change, the metrics twice a second."""
        count = 0
        while True:
            try:
                await asyncio.wait_for(self._changed.wait(), 0.2)
            except TimeoutError:
                count += 1
            self._changed.clear()
            if not self.clients:
                continue
            try:
                self.broadcast(self._app_state.state())
                if count >= 3:
                    count = 0
                    self.broadcast(await asyncio.to_thread(self._app_state.metrics))
            except Exception:
                # Whatever it was, the next state is news again; nobody's screen stands still.
                log.exception("could not send the state and metrics to the clients")

    def _soon(self, action: Callable[[], None]) -> None:
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(action)

    def _notice(self, text: str) -> None:
        self._soon(lambda: self.broadcast({"type": "notice", "message": text}))

    def _tell_laws(self, with_schema: bool = False) -> None:
        self.broadcast(self._app_state.laws(with_schema))

    def _wake(self) -> None:
        for client in self.clients:
            client.wake()

    def _on_change(self, change: Change) -> None:
        if change.patch is None:
            return  # a whole new experiment brings new telemetry, and with it a hello
        if change.law:
            self._soon(lambda: self._tell_laws(with_schema=True))
        message = {
            "type": "patch",
            "revision": change.revision,
            "author": change.author,
            "id": change.request,
            "patch": change.patch,
            "experiment": change.experiment.document(),
        }
        self._soon(lambda: self.broadcast(message))
