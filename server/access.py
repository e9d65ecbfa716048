"""Who may talk to the server.

Three checks, in this order, on every HTTP request and every WebSocket:

1. *Host.* A server bound to loopback answers only to `localhost`, `127.0.0.1`, `[::1]` (and the
   loopback address it is bound to) at its own port. A page whose name was re-pointed at
   127.0.0.1 (DNS rebinding) sends its own name and is refused. A server bound to anything else
   can't know the names, addresses and forwarded ports that it is reached by, so it accepts any
   well-formed Host: there the token guards, which such a page neither knows nor gets a cookie
   for.
2. *Origin.* Where a browser sends one it must be the host and port that Host names. Browsers
   always send it with WebSockets and with methods that change something; scripts need none.
3. *Token.* A server bound to anything but loopback wants its token with every request:
   `?token=` (once: a browser gets a cookie for it and goes on without it), the cookie, or
   `Authorization: Bearer`.
"""

from __future__ import annotations

import html
import ipaddress
import re
import secrets
import socket
from dataclasses import dataclass, field
from hmac import compare_digest
from typing import NamedTuple
from urllib.parse import quote, unquote_plus

from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from server.errors import error_body
from server.security_headers import with_security_headers

_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8">{refresh}<title>Slidetune</title>
<body style="font:1rem/1.5 system-ui;max-width:40rem;margin:4rem auto;padding:0 1rem">
<h1>Slidetune</h1><p>{message}</p></body></html>"""
_TOKEN_MESSAGE = (
    "This server asks for its token: open the address that the server printed when it started "
    "(it ends in ?token=…). A program sends the token as Authorization: Bearer …"
)
_HOST = re.compile(r"([A-Za-z0-9._-]+|\[[0-9A-Fa-f:.]+\])(?::([0-9]{1,5}))?")
_DEFAULT_PORTS = {"http": 80, "ws": 80, "https": 443, "wss": 443}


@dataclass(frozen=True)
class AccessPolicy:
    """What a request must bring.

    Attributes:
        host: the name or address that the server is bound to.
        port: the TCP port that it is bound to.
        token: the secret, or None where no token is asked for; left out of the repr.
    """

    host: str
    port: int
    token: str | None = field(default=None, repr=False)

    @property
    def cookie(self) -> str:
        """Name of the cookie; it holds the port because all ports of a host share cookies."""
        return f"slidetune_{self.port}"

    def address(self) -> str:
        """Return the address to open, token included: print it, never log it."""
        host = socket.gethostname() if self.host in ("", "0.0.0.0", "::") else self.host
        query = "" if self.token is None else f"?token={quote(self.token, safe='')}"
        return f"http://{_bracketed(host)}:{self.port}/{query}"

    def allows_host(self, host: str, scheme: str) -> bool:
        """Say whether a Host header may name this server (rule 1 of the module)."""
        if not _is_loopback(self.host):
            return _HOST.fullmatch(host) is not None
        names = ("localhost", "127.0.0.1", "[::1]", _bracketed(self.host).lower())
        return _split_host(host, scheme) in [(name, self.port) for name in names]

    def allows_token(self, given: str | None) -> bool:
        """Compare with the token in constant time; always True where there is none."""
        if self.token is None:
            return True
        return given is not None and compare_digest(given.encode(), self.token.encode())


def policy_for(host: str, port: int) -> AccessPolicy:
    """Return the policy of a server that binds this address, with a new token if it needs one.

    Args:
        host: the name or address to bind. `localhost` and loopback addresses need no token;
            every other name does, and so does the empty one, which binds all interfaces.
        port: the TCP port to bind.
    """
    return AccessPolicy(host, port, None if _is_loopback(host) else secrets.token_urlsafe(32))


class _Refusal(NamedTuple):
    status: int
    code: str
    message: str


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
        refusal = self._refusal(connection, given)
        app: ASGIApp = self._app
        if scope["type"] == "websocket":
            if refusal is not None:
                await send({"type": "websocket.close", "code": 1008, "reason": refusal.code})
                return
        elif refusal is not None:
            app = _refused(connection, refusal)
        elif given is not None and _is_navigation(connection):
            app = self._settled(connection)
        await app(scope, receive, with_security_headers(connection, send))

    def _refusal(self, connection: HTTPConnection, given: str | None) -> _Refusal | None:
        hosts = connection.headers.getlist("host")
        if len(hosts) != 1 or not self._policy.allows_host(hosts[0], connection["scheme"]):
            message = (
                f"The request names the host {', '.join(hosts) or '(none)'}, which isn't this "
                f"server. Open http://localhost:{self._policy.port}/ on this machine; "
                "a forwarded port must have the same number at both ends."
            )
            return _Refusal(403, "host_refused", message)
        for origin in connection.headers.getlist("origin"):
            if not _same_origin(origin, hosts[0]):
                message = f"A page of {origin} may not use the server at {hosts[0]}."
                return _Refusal(403, "origin_refused", message)
        candidates = (given, _bearer(connection), connection.cookies.get(self._policy.cookie))
        if not any(self._policy.allows_token(candidate) for candidate in candidates):
            return _Refusal(401, "token_required", _TOKEN_MESSAGE)
        return None

    def _settled(self, connection: HTTPConnection) -> Response:
        response = RedirectResponse(_own_url(connection), 303)
        response.set_cookie(
            self._policy.cookie,
            self._policy.token or "",
            httponly=True,
            samesite="strict",
            secure=connection["scheme"] == "https",
        )
        response.headers["cache-control"] = "no-store"
        return response


def _is_loopback(host: str) -> bool:
    if host.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _split_host(host: str, scheme: str) -> tuple[str, int] | None:
    match = _HOST.fullmatch(host)
    return match and (match[1].lower(), int(match[2] or _DEFAULT_PORTS[scheme]))


def _same_origin(origin: str, host: str) -> bool:
    # The Origin's own scheme fills in missing ports: behind a proxy that ends TLS ours differs.
    scheme, _, rest = origin.partition("://")
    if scheme not in ("http", "https"):
        return False
    named = _split_host(rest, scheme)
    return named is not None and named == _split_host(host, scheme)


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


def _wants_html(connection: HTTPConnection) -> bool:
    return "text/html" in connection.headers.get("accept", "")


def _is_navigation(connection: HTTPConnection) -> bool:
    # Browsers that don't send Sec-Fetch-Mode ask for HTML by name when they navigate.
    mode = connection.headers.get("sec-fetch-mode", "navigate")
    return connection["method"] == "GET" and mode == "navigate" and _wants_html(connection)


def _from_elsewhere(connection: HTTPConnection) -> bool:
    fetch_site = connection.headers.get("sec-fetch-site")
    return fetch_site == "cross-site" and _is_navigation(connection)


def _own_url(connection: HTTPConnection) -> str:
    # One slash in front: `//name/` would lead to another server.
    path = "/" + quote(connection["path"].lstrip("/\\"))
    query = connection["query_string"].decode("latin-1")
    return f"{path}?{query}" if query else path


def _refused(connection: HTTPConnection, refusal: _Refusal) -> Response:
    response: Response
    if _wants_html(connection):
        refresh = ""
        if refusal.status == 401 and _from_elsewhere(connection):
            # A navigation that another site began carries no SameSite=Strict cookie, through
            # no redirect either. One that this page begins does, if there is a cookie.
            url = html.escape(_own_url(connection))
            refresh = f'<meta http-equiv="refresh" content="0;url={url}">'
        page = _PAGE.format(refresh=refresh, message=html.escape(refusal.message))
        response = HTMLResponse(page, refusal.status)
    else:
        response = JSONResponse(error_body(refusal.code, refusal.message), refusal.status)
    if refusal.status == 401:
        response.headers["www-authenticate"] = "Bearer"
    response.headers["cache-control"] = "no-store"
    return response
