"""A real server in a second process, and what its threads take from the processor."""

from __future__ import annotations

import os
import queue
import re
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, sleep

from slidetune.robot.errors import SlidetuneError

PATIENCE = 180.0
"""Longest wait for the server in [s] (*ours*)."""

_ADDRESS = re.compile(r"https?://\S+?:(\d+)/")
_FOLDER = Path(__file__).parents[3]


class ServerStartError(SlidetuneError, RuntimeError):
    """The server didn't come up."""


@dataclass(frozen=True)
class RunningServer:
    """A server that answers.

    Attributes:
        port: its port on this machine.
        process: its process id.
        ready: time from the start of the process until it said that it answers in [s].
        said: the lines of its log so far; more come while it runs.
    """

    port: int
    process: int
    ready: float
    said: list[str]


@contextmanager
def running_server(
    options: Sequence[str] = (), environment: Mapping[str, str] | None = None
) -> Iterator[RunningServer]:
    """Start the server with the paper's comparison, and end it after the block.

    Args:
        options: further options of ``serve``.
        environment: variables to set for it, beside those of this process.

    Raises:
        ServerStartError: with its last words, if it ends or says nothing.
    """
    begin = perf_counter()
    command = [sys.executable, "-m", "slidetune", "serve", "--no-browser", "--port", "0", *options]
    process = subprocess.Popen(
        command,
        cwd=_FOLDER,
        env={**os.environ, **(environment or {})},
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        encoding="utf-8",
    )
    lines: queue.Queue[str | None] = queue.Queue()
    said: list[str] = []
    reader = threading.Thread(target=_read, args=(process, lines, said), daemon=True)
    reader.start()
    with process:  # closes the pipe
        try:
            port = _port(lines, begin)
            yield RunningServer(port, process.pid, perf_counter() - begin, said)
        finally:
            _end(process)
            reader.join()


def _end(process: subprocess.Popen[str]) -> None:
    process.terminate()
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.kill()


def _read(process: subprocess.Popen[str], lines: queue.Queue[str | None], said: list[str]) -> None:
    for line in process.stderr or ():
        said.append(line.rstrip())
        lines.put(said[-1])
    lines.put(None)


def _port(lines: queue.Queue[str | None], begin: float) -> int:
    """Return the port that the server names once it answers."""
    last = "it printed nothing"
    while True:
        try:
            line = lines.get(timeout=max(0.0, begin + PATIENCE - perf_counter()))
        except queue.Empty:
            raise ServerStartError(f"the server didn't answer in {PATIENCE:g} s: {last}") from None
        if line is None:
            raise ServerStartError(f"the server ended: {last}")
        if address := _ADDRESS.search(line):
            return int(address[1])
        last = line or last


def thread_times(process: int) -> dict[int, float]:
    """Return the processor time of every thread of a process in [s]; empty where unknown.

    Args:
        process: process id; Linux alone tells.
    """
    times = {}
    folder = Path(f"/proc/{process}/task")
    for thread in folder.iterdir() if folder.is_dir() else ():
        try:
            times[int(thread.name)] = int((thread / "schedstat").read_text().split()[0]) * 1e-9
        except (OSError, ValueError, IndexError):
            continue  # the thread ended, or this kernel keeps no such account
    return times


def stepping_thread(process: int, seconds: float) -> int | None:
    """Return the thread that steps the session: the busiest while no client is connected.

    Args:
        process: process id of the server.
        seconds: how long to watch it.
    """
    before = thread_times(process)
    sleep(seconds)
    after = thread_times(process)
    taken = {thread: time - before.get(thread, 0.0) for thread, time in after.items()}
    return max(taken, key=lambda thread: taken[thread], default=None)


def machine_load() -> float | None:
    """Return how many processes wanted the processor in the last minute; ``None`` if unknown."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else None
