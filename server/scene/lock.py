"""Locks Viser's own port.

It listens on loopback and checks nobody: any program of this machine, and any page that a browser
here shows, could otherwise connect to it past the token and pull at the arm.

The key is drawn at every start and known to the relay alone, which sends it as a header. No page
can: browsers let nobody set the headers of a WebSocket. What stays open on that port is Viser's
own page, a file that everybody can install; without the key it shows nothing.
"""

from __future__ import annotations

import asyncio
import secrets
from hmac import compare_digest

import viser
from viser.infra import WebsockClientConnection

KEY_HEADER = "X-Slidetune-Scene"
"""The header that carries the key."""
POLICY_VIOLATION = 1008
"""Close code of a connection without it (RFC 6455, section 7.4.1)."""


def lock_scene(viewer: viser.ViserServer) -> str:
    """Let only those connect to a viewer who know a new key; end what is connected already.

    Args:
        viewer: a running Viser server.

    Returns:
        The key: the value of ``KEY_HEADER``.
    """
    key = secrets.token_urlsafe(32)
    server = viewer._websock_server

    async def admit(connection: WebsockClientConnection) -> None:
        socket = server._live_connections[connection.client_id]
        request = socket.request
        given = "" if request is None else request.headers.get(KEY_HEADER, "")
        if compare_digest(given.encode(), key.encode()):
            return
        server._live_connections.pop(connection.client_id, None)
        server._client_state_from_id.pop(connection.client_id, None)
        await socket.close(POLICY_VIOLATION, "Open the scene through Slidetune's own address.")
        # Ends this connection's handler before it has read a single message. An ordinary
        # exception would be logged as a failure of ours, which it isn't.
        raise asyncio.CancelledError

    # First of all: Viser calls these in order before it listens to the newcomer.
    server._client_connect_cb.insert(0, admit)
    server.disconnect_all_clients()
    return key
