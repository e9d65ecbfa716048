"""How a request is turned away: a page for browsers, the one error shape for programs."""

from __future__ import annotations

import html
from typing import NamedTuple
from urllib.parse import quote

from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, JSONResponse, Response

from slidetune.server.guard.errors import error_body

_PAGE = """<!doctype html><html lang="en"><meta charset="utf-8">{refresh}<title>Slidetune</title>
<body style="font:1rem/1.5 system-ui;max-width:40rem;margin:4rem auto;padding:0 1rem">
<h1>Slidetune</h1><p>{message}</p></body></html>"""


class Refusal(NamedTuple):
    """Why a request is turned away."""

    status: int
    code: str
    message: str


def wants_html(connection: HTTPConnection) -> bool:
    """Say whether a request asks for HTML by name, as browsers do when they navigate."""
    return "text/html" in connection.headers.get("accept", "")


def is_navigation(connection: HTTPConnection) -> bool:
    """Say whether a request is a browser's that opens a page."""
    # Browsers that don't send Sec-Fetch-Mode ask for HTML by name when they navigate.
    mode = connection.headers.get("sec-fetch-mode", "navigate")
    return connection["method"] == "GET" and mode == "navigate" and wants_html(connection)


def own_url(connection: HTTPConnection) -> str:
    """Return path and query of a request, safe to redirect to."""
    # One slash in front: `//name/` would lead to another server.
    path = "/" + quote(connection["path"].lstrip("/\\"))
    query = connection["query_string"].decode("latin-1")
    return f"{path}?{query}" if query else path


def refused(connection: HTTPConnection, refusal: Refusal) -> Response:
    """Return the answer to a request that is turned away."""
    response: Response
    if wants_html(connection):
        refresh = ""
        if refusal.status == 401 and _from_elsewhere(connection):
            # A navigation that another site began carries no SameSite=Strict cookie, through
            # no redirect either. One that this page begins does, if there is a cookie.
            url = html.escape(own_url(connection))
            refresh = f'<meta http-equiv="refresh" content="0;url={url}">'
        page = _PAGE.format(refresh=refresh, message=html.escape(refusal.message))
        response = HTMLResponse(page, refusal.status)
    else:
        response = JSONResponse(error_body(refusal.code, refusal.message), refusal.status)
    if refusal.status == 401:
        response.headers["www-authenticate"] = "Bearer"
    response.headers["cache-control"] = "no-store"
    return response


def _from_elsewhere(connection: HTTPConnection) -> bool:
    fetch_site = connection.headers.get("sec-fetch-site")
    return fetch_site == "cross-site" and is_navigation(connection)
