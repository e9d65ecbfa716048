"""A server process that may be killed, suspended or starved."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

ROOT = Path(__file__).resolve().parents[3]
PATIENCE = 180.0
"""Longest wait for a server in [s] (*ours*): the first one may have to compile."""
_ADDRESS = re.compile(r"is at https?://\S+?:(\d+)/")


class FaultError(RuntimeError):
    """Something that a fault can't go on without didn't happen."""


def wait_for(condition: Callable[[], object], what: str, seconds: float = 30.0) -> None:
    """Wait until a condition holds.

    Raises:
        FaultError: if it doesn't within so many seconds.
    """
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise FaultError(f"not within {seconds:g} s: {what}")
        time.sleep(0.005)


class Server:
    """One process of ``slidetune serve`` and what it wrote to standard error.

    Attributes:
        process: the process.
        lines: lines of standard error so far.
        port: its port; 0 until it says where it is.
    """

    def __init__(
        self,
        options: Sequence[str] = ("--port", "0"),
        module: str = "slidetune",
        environment: Mapping[str, str] | None = None,
        prepare: Callable[[], None] | None = None,
    ) -> None:
        """Start it.

        Args:
            options: options of ``serve``.
            module: what to run: ``slidetune``, or a script of ours that spoils something first.
            environment: variables to set for it.
            prepare: called in the new process before the program is loaded.
        """
        self.port = 0
        self.lines: list[str] = []
        self.process = subprocess.Popen(
            [sys.executable, "-m", module, "serve", "--no-browser", *options],
            cwd=ROOT,
            env={**os.environ, **(environment or {})},
            preexec_fn=prepare,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            encoding="utf-8",
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self.process.stderr or ():
            self.lines.append(line.rstrip())
            if not self.port and (address := _ADDRESS.search(line)):
                self.port = int(address[1])

    def wait_until_ready(self) -> None:
        """Wait until it says where it is."""
        wait_for(lambda: self.port or self.process.poll() is not None, "an address", PATIENCE)
        if not self.port:
            raise FaultError(f"the server ended: {self.lines[-1:]}")

    def wait_until_ended(self, seconds: float = 60.0) -> int:
        """Return its exit code once it has ended."""
        code = self.process.wait(seconds)
        self._reader.join(5.0)
        return code

    @property
    def complaints(self) -> list[str]:
        """The lines that tell of a traceback or of a warning."""
        return [line for line in self.lines if "Traceback" in line or "Warning" in line]

    def http(self) -> httpx.Client:
        """Return a client of its own."""
        address = f"http://127.0.0.1:{self.port}"
        return httpx.Client(base_url=address, timeout=90.0, trust_env=False)

    def end(self) -> None:
        """End it, whatever state it is in."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(15.0)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self._reader.join(5.0)
        if self.process.stderr is not None:
            self.process.stderr.close()


@contextmanager
def served(**arguments: Any) -> Iterator[Server]:
    """Start a server, wait for it, and end it after the block; the arguments are ``Server``'s."""
    server = Server(**arguments)
    try:
        server.wait_until_ready()
        yield server
    finally:
        server.end()
