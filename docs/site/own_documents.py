"""What the application says of itself: OpenAPI and AsyncAPI, asked for without a server."""

from __future__ import annotations

import os
import tempfile
from typing import Any

import httpx

from slidetune.robot import load_preset
from slidetune.server.app import create_app
from slidetune.server.guard.access_policy import policy_for
from slidetune.server.state.app_state import AppState

ADDRESS = "127.0.0.1:8000"
"""Where a dashboard is by default: the address that the documents name."""
_FOLDERS = ("SLIDETUNE_PRESETS", "SLIDETUNE_STUDIES", "SLIDETUNE_ARMS")


async def own_documents() -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the OpenAPI and the AsyncAPI document of a new dashboard.

    The requests are calls in this process; its session and its workers are never started, and the
    user's own presets, studies and arms are not looked at.
    """
    before = {name: os.environ.get(name) for name in _FOLDERS}
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(dict.fromkeys(_FOLDERS, folder))
        app_state = AppState(load_preset("paper"))
        try:
            host, port = ADDRESS.split(":")
            app = create_app(app_state, policy_for(host, int(port), False))
            transport = httpx.ASGITransport(app=app)
            async with httpx.AsyncClient(
                transport=transport, base_url=f"http://{ADDRESS}"
            ) as client:
                answers = [await client.get(f"/{name}.json") for name in ("openapi", "asyncapi")]
        finally:
            app_state.stop()
            for name, value in before.items():
                if value is None:
                    os.environ.pop(name, None)
                else:
                    os.environ[name] = value
    openapi, asyncapi = (answer.raise_for_status().json() for answer in answers)
    return openapi, asyncapi
