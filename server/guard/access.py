"""Who may talk to the server.

Five checks, in this order, on every HTTP request and every WebSocket:

1. *Host.* A server bound to loopback answers only to `localhost`, `127.0.0.1`, `[::1]` (and the
   loopback address it is bound to) at its own port. A page whose name was re-pointed at
   127.0.0.1 (DNS rebinding) sends its own name and is refused. A server that asks for a token
   can't know the names, addresses and forwarded ports that it is reached by, so it accepts any
   well-formed Host: there the token guards, which such a page neither knows nor gets a cookie
   for.
2. *Origin.* Where a browser sends one it must be the host and port that Host names. Browsers
   always send it with WebSockets and with methods that change something; scripts need none.
3. *Site.* Where a browser says that another site's page asks (Sec-Fetch-Site), it may follow a
   link to a page of ours; it may load nothing of ours into its own, nor frame it.
4. *Token.* A server bound to anything but loopback wants a token with every request:
   `?token=` (once: a browser gets a cookie for it and goes on without it), the cookie, or
   `Authorization: Bearer`. There are two: the owner's and the viewers'.
5. *Role.* A viewer reads: `GET`, `HEAD`, `OPTIONS`. Whatever else there is changes something or
   takes the processor, and is refused here for all routes at once. What a viewer may send over a
   WebSocket is the business of ``server.routes.live`` and ``server.scene.relay``, which find the
   role in the scope.
"""

from __future__ import annotations

from urllib.parse import unquote_plus

from starlette.requests import HTTPConnection
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from slidetune.server.guard.access_policy import WATCH_ONLY, AccessPolicy, Role, same_origin
from slidetune.server.guard.access_refusal import Refusal, is_navigation, own_url, refused
from slidetune.server.guard.security_headers import with_security_headers

READING = ("GET", "HEAD", "OPTIONS")
"""Methods of a viewer."""
_TOKEN_MESSAGE = (
    "This server requires a token: open the address that it printed when it started (ending in "
    "?token=…). A program sends the token as Authorization: Bearer …"
)
_FRAMES = ("frame", "iframe", "embed", "object")


def role_in(scope: Scope) -> Role:
    """Return the role that a request was admitted in; the owner's where nobody guards."""
    role: Role = scope.get("slidetune.role", "owner")
    return role


class Access:
    """ASGI middleware that holds an application to a policy; put it outermost."""

    def __init__(self, app: ASGIApp, policy: AccessPolicy) -> None:
        """Guard `app` with `policy`."""
        self._app = app
        self._policy = policy

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer it here: refused, or rid of the token in its URL."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        given = _take_token(scope) if self._policy.token is not None else None
        connection = HTTPConnection(scope)
        secret = self._valid(connection, given)
        refusal = self._refusal(connection, secret)
        app: ASGIApp = self._app
        if scope["type"] == "websocket":
            if refusal is not None:
                await send({"type": "websocket.close", "code": 1008, "reason": refusal.code})
                return
        elif refusal is not None:
            app = refused(connection, refusal)
        elif given is not None and secret == given and is_navigation(connection):
            app = self._settled(connection, given)
        scope["slidetune.role"] = self._policy.role_of(secret)
        await app(scope, receive, with_security_headers(connection, send))

    def _valid(self, connection: HTTPConnection, given: str | None) -> str | None:
        """Return the first token of a request that opens anything."""
        candidates = (given, _bearer(connection), connection.cookies.get(self._policy.cookie))
        return next((each for each in candidates if each and self._policy.role_of(each)), None)

    def _refusal(self, connection: HTTPConnection, secret: str | None) -> Refusal | None:
        foreign = self._foreign(connection)
        if foreign is not None:
            return foreign
        role = self._policy.role_of(secret)
        if role is None:
            return Refusal(401, "token_required", _TOKEN_MESSAGE)
        if role == "viewer" and connection.scope.get("method", "GET") not in READING:
            return Refusal(403, "watch_only", WATCH_ONLY)
        return None

    def _foreign(self, connection: HTTPConnection) -> Refusal | None:
        """Return why a request comes from, or is meant for, somewhere else (rules 1 to 3)."""
        hosts = connection.headers.getlist("host")
        if len(hosts) != 1 or not self._policy.allows_host(hosts[0], connection["scheme"]):
            message = (
                f"The request names the host {', '.join(hosts) or '(none)'}, which is not this "
                f"server. Open http://localhost:{self._policy.port}/ on this machine; a forwarded "
                "port must have the same number at both ends."
            )
            return Refusal(403, "host_refused", message)
        for origin in connection.headers.getlist("origin"):
            if not same_origin(origin, hosts[0]):
                message = f"A page of {origin} may not use the server at {hosts[0]}."
                return Refusal(403, "origin_refused", message)
        if _is_embedded_elsewhere(connection):
            message = f"A page of another site may not load or embed anything of {hosts[0]}."
            return Refusal(403, "site_refused", message)
        return None

    def _settled(self, connection: HTTPConnection, token: str) -> Response:
        response = RedirectResponse(own_url(connection), 303)
        response.set_cookie(
            self._policy.cookie,
            token,
            httponly=True,
            samesite="strict",
            secure=connection["scheme"] == "https",
        )
        response.headers["cache-control"] = "no-store"
        return response


def _is_embedded_elsewhere(connection: HTTPConnection) -> bool:
    headers = connection.headers
    if headers.get("sec-fetch-site") not in ("cross-site", "same-site"):
        return False
    # Another port of this machine is the same site and still another program.
    mode, destination = headers.get("sec-fetch-mode"), headers.get("sec-fetch-dest")
    return mode != "navigate" or destination in _FRAMES


def _take_token(scope: Scope) -> str | None:
    # In place, because the server writes its access log from this very mapping.
    given, kept = None, []
    for pair in scope["query_string"].split(b"&"):
        name, _, value = pair.decode("latin-1").partition("=")
        if unquote_plus(name) == "token":
            given = unquote_plus(value)
        else:
            kept.append(pair)
    scope["query_string"] = b"&".join(kept)
    return given


def _bearer(connection: HTTPConnection) -> str | None:
    scheme, _, value = connection.headers.get("authorization", "").partition(" ")
    return value.strip() if scheme.lower() == "bearer" else None
