"""The server talks to nobody but itself and those who ask it."""

from __future__ import annotations

import ipaddress
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.server.conftest import serving

# An audit hook can't be taken away again: it listens only while a test does.
_listening: list[list[str]] = []


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if not _listening:
        return
    if event == "socket.getaddrinfo":
        _listening[-1].append(str(arguments[0]))
    elif event in ("socket.connect", "socket.sendto") and isinstance(arguments[1], tuple):
        _listening[-1].append(str(arguments[1][0]))


@pytest.fixture
def called() -> Iterator[list[str]]:
    """Every name that is looked up and every address that is connected to."""
    sys.addaudithook(_note)
    _listening.append([])
    yield _listening[-1]
    _listening.pop()


def is_here(name: str) -> bool:
    try:
        return ipaddress.ip_address(name).is_loopback
    except ValueError:
        return name == "localhost"


def test_nothing_is_fetched_from_elsewhere(called: list[str], tmp_path: Path) -> None:
    with serving(tmp_path) as server:
        for path in (
            "/",
            "/docs",
            "/docs/live",
            "/scene/",
            "/api/schema",
            "/api/presets",
            "/static/plotly.min.js",
        ):
            server.http.get(path).raise_for_status()
        server.http.post("/api/preview", json={"estimate": False}).raise_for_status()
        server.http.post("/api/lens", json={"lane": "NFTSM"}).raise_for_status()
    assert called, "the hook hears nothing"
    assert [name for name in called if not is_here(name)] == []
