"""Finds a port, says where the dashboard is, opens it, and serves it."""

from __future__ import annotations

import socket
import threading
import webbrowser
from contextlib import closing

import uvicorn
from rich.console import Console

from robot.experiment import Experiment
from server.access import AccessPolicy, policy_for
from server.app import create_app
from server.studio import Studio

MAX_MESSAGE = 256 * 1024
"""Largest WebSocket message that a client may send in bytes (*ours*)."""
PORTS = 20
"""How many ports are tried from the wanted one on (*ours*)."""

console = Console(stderr=True, highlight=False)


def free_socket(host: str, port: int) -> socket.socket:
    """Bind the first free port from ``port`` on; 0 takes any.

    Raises:
        OSError: if none of twenty is free, or the host isn't one of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    last: OSError | None = None
    for candidate in range(port, min(port + PORTS, 65536)):
        bound = socket.socket(family, socket.SOCK_STREAM)
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            bound.bind((host, candidate))
            return bound
        except OSError as error:
            bound.close()
            last = error
            if port == 0:
                break
    raise last or OSError(f"no port from {port} on")


class _Server(uvicorn.Server):
    """Says where it is once it answers, not before."""

    def __init__(self, config: uvicorn.Config, policy: AccessPolicy, browser: bool) -> None:
        super().__init__(config)
        self._policy = policy
        self._browser = browser

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        address = self._policy.address()
        console.print(f"Slidetune is at {address}   (Ctrl+C ends it)", soft_wrap=True)
        if self._browser:
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()


def serve(experiment: Experiment, preset: str, host: str, port: int, browser: bool) -> None:
    """Serve the dashboard until it is interrupted.

    Args:
        experiment: what to begin with.
        preset: name of the preset that it comes from.
        host: address to bind; any but loopback asks for a token.
        port: wanted port; the next free one if it is taken.
        browser: whether to open a browser.

    Raises:
        OSError: if no port is free.
    """
    with closing(free_socket(host, port)) as bound:
        actual = bound.getsockname()[1]
        if port not in (0, actual):
            console.print(f"Port {port} is taken: using {actual}.")
        policy = policy_for(host, actual)
        app = create_app(Studio(experiment, preset), policy)
        config = uvicorn.Config(
            app,
            log_level="warning",
            ws_max_size=MAX_MESSAGE,
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=2,
            server_header=False,
        )
        _Server(config, policy, browser).run(sockets=[bound])
