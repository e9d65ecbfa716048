"""Viser under the server's own origin, at /scene/.

Viser listens on a loopback port of its own, which a browser elsewhere can't reach and which
checks nobody. This relay carries its page and its WebSocket through the server's one address:
one port to forward, one place where access is checked. Viser's own port is locked with a key that
only the relay knows (``server.scene.lock``).

Messages to Viser wait where they come faster than they may. Of a viewer's messages only the
camera's pass: everything else that a browser can say to Viser pulls at the arm or presses a button.

Viser's page opens its WebSocket at its own address without the last slash, so `/scene` and
`/scene/` both take WebSockets, while a plain `GET /scene` is sent on to `/scene/`.
"""

from __future__ import annotations

import asyncio
from contextlib import aclosing, suppress
from urllib.parse import quote

import httpx
import msgspec
from fastapi import APIRouter
from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import JSONResponse, RedirectResponse
from starlette.routing import Route, WebSocketRoute
from starlette.types import Receive, Scope, Send
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.frames import Close
from websockets.typing import Subprotocol

from slidetune.server.guard.access import role_in
from slidetune.server.guard.concurrency_limit import ConcurrencyLimit
from slidetune.server.guard.errors import error_body
from slidetune.server.guard.limits import MAX_CLIENTS, SCENE_BURST, SCENE_RATE
from slidetune.server.guard.token_bucket import TokenBucket
from slidetune.server.scene.lock import KEY_HEADER

# Ours: far above any scene of this project, so that it only stops a runaway message [byte].
MAX_MESSAGE = 64 * 2**20
# Ours: longest path of a file in bytes; Viser's have 40, and it fails on what no disk can hold.
LONGEST_PATH = 255
# Ours: messages held for a browser that reads more slowly than Viser writes.
MAX_QUEUE = 16
# Ours: time for Viser to answer [s]: one that is gone refuses at once, a busy one is late.
PATIENCE = 30.0
# Ours: below the 5 s after which Viser's page gives an attempt up, so that it gets a reason [s].
OPEN_TIMEOUT = 3.0
# Ours: how long Viser may take to answer a close before it is cut off [s].
CLOSE_TIMEOUT = 1.0

# What a file server can act on. Cookie and Authorization are left out on purpose: they hold
# this server's token, which is no business of another process.
_READING = ("accept", "accept-encoding", "cache-control", "range", "user-agent")
_CONDITIONS = ("if-modified-since", "if-none-match", "if-range")
RELAYED_REQUEST_HEADERS = _READING + _CONDITIONS
# Hop-by-hop (RFC 9110, section 7.6.1), and the two that our own server writes itself.
_HOP_BY_HOP = ("connection", "keep-alive", "proxy-authenticate", "te", "trailer", "upgrade")
DROPPED_RESPONSE_HEADERS = (*_HOP_BY_HOP, "transfer-encoding", "date", "server")
_LEFT = Close(1001, "The browser has left.")
_SCENE_IS_DOWN = Close(1013, "The 3D scene does not answer; restart Slidetune if this persists.")
_SCENE_IS_FULL = Close(1013, f"{MAX_CLIENTS} browsers are showing the 3D scene already.")
VIEWERS_MESSAGES = ("ViewerCameraMessage",)
"""What a viewer may say to Viser: where its camera is, without which Viser shows it nothing."""


class SceneIsFullError(Exception):
    """As many browsers show the scene as may."""


def scene_router(port: int, key: str = "") -> APIRouter:
    """Return the routes that relay a Viser server; include them without a prefix.

    Args:
        port: the TCP port on 127.0.0.1 that Viser listens on.
        key: what ``server.scene.lock.lock_scene`` returned, where that port is locked.

    Returns:
        `GET` and `HEAD` of `/scene` and `/scene/...`, WebSockets at `/scene` and `/scene/`.
    """
    relay = SceneRelay(port, key)
    return APIRouter(
        routes=[
            Route("/scene", _add_slash, methods=["GET"], include_in_schema=False),
            Route("/scene/{path:path}", relay, methods=["GET"], include_in_schema=False),
            WebSocketRoute("/scene", relay),
            WebSocketRoute("/scene/", relay),
        ]
    )


async def _add_slash(request: Request) -> RedirectResponse:
    # Relative, so that it also holds behind a proxy that puts a prefix before our paths.
    query = f"?{request.url.query}" if request.url.query else ""
    return RedirectResponse(f"scene/{query}")


class SceneRelay:
    """ASGI application that relays one request or WebSocket a call and keeps nothing after it."""

    def __init__(self, port: int, key: str = "") -> None:
        """Relay to this TCP port on 127.0.0.1, with the key that opens it."""
        self._address = f"127.0.0.1:{port}"
        self._key = {KEY_HEADER: key} if key else {}
        self._connections = ConcurrencyLimit(MAX_CLIENTS, SceneIsFullError)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Relay the request or the WebSocket that the scope describes."""
        relay = self._relay_http if scope["type"] == "http" else self._relay_websocket
        await relay(scope, receive, send)

    async def _relay_http(self, scope: Scope, receive: Receive, send: Send) -> None:
        if len(scope["path_params"]["path"].encode("utf-8", "replace")) > LONGEST_PATH:
            body = error_body("address_refused", "The scene has no address that long.")
            await JSONResponse(body, 404)(scope, receive, send)
            return
        # No proxy of the user's for loopback; no 30 ms for certificates that HTTP never reads.
        async with httpx.AsyncClient(trust_env=False, verify=False, timeout=PATIENCE) as client:
            try:
                upstream = await client.send(self._upstream_request(client, scope), stream=True)
            except httpx.InvalidURL as invalid:
                body = error_body("address_refused", f"The scene has no such address: {invalid}.")
                await JSONResponse(body, 404)(scope, receive, send)
                return
            except httpx.TransportError:
                body = error_body("scene_unavailable", _SCENE_IS_DOWN.reason)
                await JSONResponse(body, 502)(scope, receive, send)
                return
            async with aclosing(upstream):
                await _send_response(upstream, scope["method"] == "HEAD", send)

    def _upstream_request(self, client: httpx.AsyncClient, scope: Scope) -> httpx.Request:
        # Only path and query come from the browser; the host can't be changed by either.
        path = quote("/" + scope["path_params"]["path"], errors="replace")
        query = quote(scope["query_string"], safe="!$%&'()*+,/:;=?@").encode()
        url = httpx.URL(f"http://{self._address}").copy_with(path=path, query=query)
        given = Headers(scope=scope)
        headers = {name: given[name] for name in RELAYED_REQUEST_HEADERS if name in given}
        headers.setdefault("accept-encoding", "identity")
        # Viser answers nothing but GET; for HEAD its body is left unread.
        return client.build_request("GET", url, headers=headers)

    async def _relay_websocket(self, scope: Scope, receive: Receive, send: Send) -> None:
        await receive()  # websocket.connect
        offered = [Subprotocol(name) for name in scope["subprotocols"]]
        try:
            with self._connections.one():
                await self._converse(scope, offered, receive, send)
        except SceneIsFullError:
            await _turn_away(offered, _SCENE_IS_FULL, send)

    async def _converse(
        self, scope: Scope, offered: list[Subprotocol], receive: Receive, send: Send
    ) -> None:
        try:
            upstream = await connect(
                f"ws://{self._address}/",
                additional_headers=self._key,
                subprotocols=offered or None,
                compression=None,  # Viser's messages are compressed already
                proxy=None,
                open_timeout=OPEN_TIMEOUT,
                close_timeout=CLOSE_TIMEOUT,
                ping_interval=None,  # each end keeps its own leg alive
                max_size=MAX_MESSAGE,
                max_queue=MAX_QUEUE,
            )
        except (OSError, TimeoutError, InvalidHandshake):
            await _turn_away(offered, _SCENE_IS_DOWN, send)
            return
        watching = role_in(scope) == "viewer"
        async with upstream:
            await send({"type": "websocket.accept", "subprotocol": upstream.subprotocol})
            await _pump_both_ways(upstream, receive, send, watching)


async def _turn_away(offered: list[Subprotocol], close: Close, send: Send) -> None:
    # A close code only reaches a browser after an accept, and a browser only takes an accept
    # that names one of the subprotocols it offered.
    await send({"type": "websocket.accept", "subprotocol": offered[0] if offered else None})
    await _close_browser(send, close)


def viewer_may_say(data: str | bytes) -> bool:
    """Say whether a message to Viser is one that a viewer may send.

    Read by the very decoder that Viser reads with, so that both see the same message.
    """
    if isinstance(data, str):
        return False
    try:
        message = msgspec.msgpack.decode(data)
    except (msgspec.DecodeError, RecursionError):
        return False
    return isinstance(message, dict) and message.get("type") in VIEWERS_MESSAGES


async def _send_response(upstream: httpx.Response, head_only: bool, send: Send) -> None:
    for name in DROPPED_RESPONSE_HEADERS:
        upstream.headers.pop(name, None)
    headers = [(name.lower(), value) for name, value in upstream.headers.raw]
    await send({"type": "http.response.start", "status": upstream.status_code, "headers": headers})
    if not head_only:
        # Raw: the bytes stay as compressed as Content-Encoding says.
        async for chunk in upstream.aiter_raw():
            await send({"type": "http.response.body", "body": chunk, "more_body": True})
    await send({"type": "http.response.body", "body": b""})


async def _pump_both_ways(
    upstream: ClientConnection, receive: Receive, send: Send, watching: bool
) -> None:
    async with asyncio.TaskGroup() as pumps:
        down = pumps.create_task(_scene_to_browser(upstream, send))
        up = pumps.create_task(_browser_to_scene(receive, upstream, watching))
        down.add_done_callback(lambda _: up.cancel())
        up.add_done_callback(lambda _: down.cancel())
    if upstream.close_code is None:
        left = _LEFT if up.cancelled() else up.result()
        await upstream.close(left.code, left.reason)
    else:
        reason = upstream.close_reason or ""
        await _close_browser(send, _sendable(upstream.close_code, reason, _SCENE_IS_DOWN))


async def _scene_to_browser(upstream: ClientConnection, send: Send) -> None:
    # OSError is ASGI's word for a browser that has just gone; RuntimeError that of a server
    # whose own keep-alive has given it up. Awaiting each send is what bounds the backlog.
    with suppress(ConnectionClosed, OSError, RuntimeError):
        while True:
            data = await upstream.recv()
            kind = "text" if isinstance(data, str) else "bytes"
            await send({"type": "websocket.send", kind: data})


async def _browser_to_scene(receive: Receive, upstream: ClientConnection, watching: bool) -> Close:
    bucket = TokenBucket(SCENE_RATE, SCENE_BURST)
    with suppress(ConnectionClosed):
        while (message := await receive())["type"] == "websocket.receive":
            data = message.get("bytes")
            said: str | bytes = message["text"] if data is None else data
            await asyncio.sleep(bucket.wait())
            if not watching or viewer_may_say(said):
                await upstream.send(said)
        return _sendable(message.get("code", 1000), message.get("reason") or "", _LEFT)
    return _LEFT


async def _close_browser(send: Send, close: Close) -> None:
    with suppress(OSError, RuntimeError):
        await send({"type": "websocket.close", "code": close.code, "reason": close.reason})


def _sendable(code: int, reason: str, otherwise: Close) -> Close:
    # 1004 to 1006 and 1015 stand for a close that named no code; they may not be sent.
    if 1000 <= code <= 1003 or 1007 <= code <= 1014 or 3000 <= code <= 4999:
        return Close(code, reason)
    return otherwise
