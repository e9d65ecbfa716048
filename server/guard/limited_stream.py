"""An answer that takes long, of which there may be only so many at once."""

from __future__ import annotations

from collections.abc import AsyncIterator

from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from slidetune.server.guard.concurrency_limit import ConcurrencyLimit


class LimitedStream(StreamingResponse):
    """An answer that counts as under way until all of it is sent, or its client has gone."""

    def __init__(
        self, running: ConcurrencyLimit, parts: AsyncIterator[str], media_type: str
    ) -> None:
        """Say what is sent, and what it counts for."""
        super().__init__(parts, media_type=media_type, headers={"cache-control": "no-store"})
        self._running = running

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send it, or refuse before anything is sent."""
        with self._running.one():
            await super().__call__(scope, receive, send)
