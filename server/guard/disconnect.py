"""Stops work that nobody waits for any more."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from contextlib import suppress
from typing import Any, TypeVar

from starlette.requests import Request

Result = TypeVar("Result")


async def _gone(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def until_gone(request: Request, work: Coroutine[Any, Any, Result]) -> Result | None:
    """Return what ``work`` returns, or ``None`` as soon as the client has left.

    Args:
        request: the request, whose body has been read.
        work: what to do; cancelled when the client leaves.
    """
    task = asyncio.ensure_future(work)
    watch = asyncio.ensure_future(_gone(request))
    try:
        await asyncio.wait({task, watch}, return_when=asyncio.FIRST_COMPLETED)
        return await task if task.done() else None
    finally:
        watch.cancel()
        task.cancel()
        for each in (watch, task):
            with suppress(asyncio.CancelledError, Exception):
                await each
