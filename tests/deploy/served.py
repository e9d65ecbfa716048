"""A server that is started by its command, and asked over HTTP."""

from __future__ import annotations

import http.client
import re
import subprocess
import time
from pathlib import Path
from urllib.parse import urlsplit

PATIENCE = 300.0
"""Seconds within which a server says where it is."""
ADDRESS = re.compile(r"Slidetune is at (\S+)")


def address_of(process: subprocess.Popen[bytes], log: Path) -> str:
    """Return the address that a server prints; it must not end before."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        text = log.read_text(encoding="utf-8")
        if found := ADDRESS.search(text):
            return found[1]
        assert process.poll() is None, text
        time.sleep(0.1)
    raise AssertionError(f"no address within {PATIENCE:g} s: {log.read_text(encoding='utf-8')}")


def get(address: str, path: str, token: str = "") -> tuple[int, str]:
    """Return status and text of an answer."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.hostname or "", parts.port, timeout=30)
    try:
        headers = {"authorization": f"Bearer {token}"} if token else {}
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.read().decode()
    finally:
        connection.close()
