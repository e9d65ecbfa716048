"""The headers that tell a browser what our pages may do and who may frame them."""

from __future__ import annotations

import re

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.types import Message, Send

PAGE_POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "connect-src {connect}; frame-src 'self'; frame-ancestors 'self'; base-uri 'none'; "
    "form-action 'self'"
)
# Viser's page is one file of inline script and style, so this can't say where script comes
# from. It does say where to connect: with `/scene/?websocket=` a link could otherwise put a
# foreign Viser server, and with it foreign script, into a page of our origin.
SCENE_POLICY = (
    "connect-src {connect} data: blob:; object-src 'none'; frame-ancestors 'self'; "
    "base-uri 'none'; form-action 'self'"
)

RAW_HEADERS = {
    "content-security-policy": "default-src 'none'; frame-ancestors 'none'",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
}
"""Headers of an answer that no page is in."""

_NAME_AND_PORT = re.compile(r"[A-Za-z0-9._-]+(:[0-9]{1,5})?")


def with_security_headers(connection: HTTPConnection, send: Send) -> Send:
    """Return `send` with the security headers added to the start of every HTTP response.

    A header that the application has set itself stays as it is.

    Args:
        connection: the request that is answered; its path and Host decide the policy.
        send: the ASGI callable to wrap.
    """
    security = {
        "content-security-policy": _content_policy(connection),
        "cross-origin-resource-policy": "same-origin",
        "referrer-policy": "no-referrer",
        "x-content-type-options": "nosniff",
    }

    async def send_secured(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(raw=list(message.get("headers", ())))
            for name, value in security.items():
                headers.setdefault(name, value)
            message = {**message, "headers": headers.raw}
        await send(message)

    return send_secured


def _content_policy(connection: HTTPConnection) -> str:
    host = connection.headers.get("host", "")
    # By name as well, because not every browser counts ws: as 'self'. An IPv6 address has no
    # spelling in a content policy.
    named = _NAME_AND_PORT.fullmatch(host)
    connect = f"'self' ws://{host} wss://{host}" if named else "'self'"
    in_scene = (connection["path"] + "/").startswith("/scene/")
    return (SCENE_POLICY if in_scene else PAGE_POLICY).format(connect=connect)
