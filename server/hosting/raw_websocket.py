"""WebSockets below the application: small bites, a limit on frames, refusals with our headers."""

from __future__ import annotations

import logging
from typing import Any

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame
from websockets.http11 import Request

from slidetune.server.guard.limits import CLIENT_BURST, CLIENT_RATE
from slidetune.server.guard.security_headers import RAW_HEADERS
from slidetune.server.guard.token_bucket import TokenBucket

BITE = 4096
"""Bytes of one connection that are parsed before others have their turn (*ours*): some 700 frames
at most, a few milliseconds."""
LINGER = 1.0
"""Time in which a client that is hung up on may read why, in [s] (*ours*)."""
POLICY_VIOLATION = 1008
_FOREIGN_TEXT = "Invalid UTF-8 sequence received from client."


class RawWebSocket(WebSocketsSansIOProtocol):
    """Uvicorn's protocol, but no client takes the event loop for itself.

    Uvicorn reads up to 256 KiB at once and answers every ping in them before anybody else has a
    turn: 40,000 pings, a second, and the next 256 KiB may be there already. Here others have a turn
    after each bite, and frames that bring no whole message (pings, pongs, pieces) may come no
    faster than messages may. A WebSocket that isn't opened is refused with the headers of all.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """Begin with nothing read."""
        super().__init__(*args, **kwargs)
        self._unread = bytearray()
        self._is_due = False
        self._has_hung_up = False
        self._bucket = TokenBucket(CLIENT_RATE, CLIENT_BURST)

    def data_received(self, data: bytes) -> None:
        """Parse the first bite now, unless earlier ones wait, and the others later."""
        if self._has_hung_up:
            return
        self._unread += data
        if not self._is_due:
            self._bite()

    def _bite(self) -> None:
        if self.disconnected or self.transport.is_closing():
            self._unread.clear()
            return
        bite = bytes(self._unread[:BITE])
        del self._unread[:BITE]
        super().data_received(bite)
        if self._unread:
            self._is_due = True
            self.transport.pause_reading()
            self.loop.call_soon(self._bite)
        elif self._is_due:
            self._is_due = False
            if not (self.read_paused or self.disconnected or self.transport.is_closing()):
                self.transport.resume_reading()

    def handle_connect(self, event: Request) -> None:
        """Answer a request to open a WebSocket."""
        reject = self.conn.reject

        def rejected(*args: Any) -> Any:
            response = reject(*args)
            response.headers.update(RAW_HEADERS)
            return response

        self.conn.reject = rejected  # type: ignore[method-assign, assignment]
        super().handle_connect(event)

    def handle_ping(self) -> None:
        """Answer a ping, or hang up where they come too fast."""
        if self._may_pass():
            super().handle_ping()

    def handle_pong(self, event: Frame) -> None:
        """Take the answer to a ping."""
        if self._may_pass():
            super().handle_pong(event)

    def handle_text(self, event: Frame) -> None:
        """Take a text message or its first piece."""
        if event.fin or self._may_pass():
            super().handle_text(event)

    def handle_bytes(self, event: Frame) -> None:
        """Take a binary message or its first piece."""
        if event.fin or self._may_pass():
            super().handle_bytes(event)

    def handle_cont(self, event: Frame) -> None:
        """Take one more piece of a message."""
        if event.fin or self._may_pass():
            super().handle_cont(event)

    def _may_pass(self) -> bool:
        """Count a frame that brings no whole message; hang up where it is one too many."""
        if not self._has_hung_up and not self._bucket.take():
            self._hang_up(f"more than {CLIENT_RATE:g} pings or message fragments per second")
        return not self._has_hung_up

    def _hang_up(self, reason: str) -> None:
        self._has_hung_up = True
        self._unread.clear()
        self.disconnected = True
        self.transport.pause_reading()
        end = {"type": "websocket.disconnect", "code": POLICY_VIOLATION, "reason": reason}
        self.queue.put_nowait(end)  # type: ignore[arg-type]
        self.conn.fail(POLICY_VIOLATION, reason)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.close_sent = True
        # What it sent is never read: closed at once, its side might drop our last words unread too.
        self.close_timer = self.loop.call_later(LINGER, self.transport.abort)


def _is_news(record: logging.LogRecord) -> bool:
    return record.msg != _FOREIGN_TEXT


def leave_foreign_text_out_of_the_log() -> None:
    """Log no traceback of ours where a client's WebSocket message isn't UTF-8: it is closed."""
    logging.getLogger("uvicorn.error").addFilter(_is_news)
