"""Finds a port, says where the dashboard is, opens it, and serves it."""

from __future__ import annotations

import socket
from contextlib import ExitStack, closing

import uvicorn
from rich.console import Console
from starlette.types import ASGIApp

from slidetune.robot.experiment.document import Experiment
from slidetune.server.app import create_app
from slidetune.server.compute.arm_kernels import compile_ahead
from slidetune.server.guard.access_policy import AccessPolicy, policy_for
from slidetune.server.guard.limits import MAX_MESSAGE
from slidetune.server.hosting.allocator import map_large_blocks_apart
from slidetune.server.hosting.open_browser import open_browser, private_way
from slidetune.server.hosting.raw_http import RawHttp
from slidetune.server.hosting.raw_websocket import RawWebSocket, leave_foreign_text_out_of_the_log
from slidetune.server.law_files.law_files import LawFiles
from slidetune.server.state.app_state import AppState

PORTS = 20
"""How many ports are tried from the wanted one on (*ours*)."""
BACKLOG = 2048
"""Connections that may wait to be accepted (*ours*): as many as uvicorn's own default."""

console = Console(stderr=True, highlight=False)


def free_socket(host: str, port: int) -> socket.socket:
    """Listen on the first free port from ``port`` on; 0 takes any.

    Raises:
        OSError: if none of twenty is free, or the host isn't one of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    last: OSError | None = None
    tried = range(port, min(port + PORTS, 65536) if port else 1)
    for candidate in tried:
        bound = socket.socket(family, socket.SOCK_STREAM)
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            bound.bind((host, candidate))
            # A port that is only bound can be bound again: two servers that start at the same
            # moment would both get it, and one of them would never hear anybody.
            bound.listen(BACKLOG)
            return bound
        except OSError as error:
            bound.close()
            last = error
    reason = last.strerror if last is not None else "there is no such port"
    text = (
        f"can't listen on {host}, port {tried[0]} to {tried[-1]}: {reason}; "
        "choose another with --port, or any free one with --port 0"
    )
    raise OSError(text) from last


def server_config(app: ASGIApp) -> uvicorn.Config:
    """Return how an application of ours is served."""
    return uvicorn.Config(
        app,
        http=RawHttp,
        ws=RawWebSocket,
        log_level="warning",
        ws_max_size=MAX_MESSAGE,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=2,
        server_header=False,
    )


class _Server(uvicorn.Server):
    """Says where it is once it answers, not before."""

    def __init__(self, config: uvicorn.Config, policy: AccessPolicy, browser: bool) -> None:
        super().__init__(config)
        self._policy = policy
        self._browser = browser
        self._ways = ExitStack()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        address, *others = self._policy.addresses("owner")
        _say(f"Slidetune is at {address}   (Ctrl+C to stop)")
        for other in others:
            _say(f"  or, if other machines know this one by name, at {other}")
        for watched in self._policy.addresses("viewer"):
            _say(f"To watch only: {watched}")
        if self._browser:
            open_browser(self._ways.enter_context(private_way(address)))

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self._ways.close()
        await super().shutdown(sockets)


def _say(text: str) -> None:
    console.print(text, soft_wrap=True, markup=False)


OF_LESSONS = "pendulum"
"""The arm of the first lesson, which nobody should have to wait for."""


def serve(
    experiment: Experiment,
    preset: str,
    host: str,
    port: int,
    browser: bool,
    token: bool = False,
    scheduler: str = "",
    law_files: LawFiles | None = None,
) -> None:
    """Serve the dashboard until it is interrupted.

    Args:
        experiment: what to begin with.
        preset: name of the preset that it comes from.
        host: address to bind; any but loopback asks for a token.
        port: wanted port; the next free one if it is taken.
        browser: whether to open a browser.
        token: whether to ask for a token on loopback too.
        scheduler: address of the cluster that makes the runs of studies; this machine without.
        law_files: files of laws of one's own, whose laws have been taken.

    Raises:
        OSError: if no port is free.
    """
    map_large_blocks_apart()
    with closing(free_socket(host, port)) as bound:
        actual = bound.getsockname()[1]
        if port not in (0, actual):
            console.print(f"Port {port} is taken: using {actual}.")
        policy = policy_for(host, actual, token)
        app_state = AppState(experiment, preset, scheduler, law_files)
        compile_ahead(OF_LESSONS)
        config = server_config(create_app(app_state, policy))
        leave_foreign_text_out_of_the_log()
        _Server(config, policy, browser).run(sockets=[bound])
