"""Refuses request bodies that are too large, on every route and before they are read."""

from __future__ import annotations

from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from slidetune.server.guard.errors import error_body
from slidetune.server.guard.limits import MAX_ARM, MAX_BODY, MAX_LOG

_MORE = {("POST", "/api/arms"): MAX_ARM, ("POST", "/api/logs"): MAX_LOG}
"""Routes that take files."""
# What is left of the body is not read: the connection can't carry another request.
_CLOSE = {"connection": "close"}


def too_large(most: int) -> str:
    """Return the refusal of a body of more than so many bytes."""
    return f"The body may have at most {most // 1024} KiB."


class BodyLimit:
    """ASGI middleware: at most ``MAX_BODY`` bytes a request, announced or not.

    An arm with its meshes may have ``MAX_ARM``, a log of a real arm ``MAX_LOG``.
    """

    def __init__(self, app: ASGIApp) -> None:
        """Guard ``app``."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 413 at once where its length is announced."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        most = _MORE.get((scope["method"], scope["path"]), MAX_BODY)
        announced = dict(scope["headers"]).get(b"content-length", b"")
        if announced.isdigit() and int(announced[:20]) > most:
            answer = JSONResponse(error_body("too_large", too_large(most)), 413, _CLOSE)
            await answer(scope, receive, send)
            return
        await self._app(scope, _counted(receive, most), send)


def _counted(receive: Receive, most: int) -> Receive:
    """Return ``receive`` that breaks off, as a refusal, where a body of unknown length grows."""
    count = 0

    async def counted() -> Message:
        nonlocal count
        message = await receive()
        if message["type"] == "http.request":
            count += len(message.get("body", b""))
            if count > most:
                raise HTTPException(413, too_large(most), _CLOSE)
        return message

    return counted
