"""A real cluster of Dask on loopback: its scheduler and its workers, each a process of its own."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from slidetune.robot.experiment.presets import SHIPPED_FOLDER

ROOT = SHIPPED_FOLDER.parent
PATIENCE = 300.0
AT = {
    "scheduler": re.compile(r"Scheduler at: +(tcp://\S+)"),
    # A worker has its address before the scheduler knows of it.
    "worker": re.compile(r"Start worker at: +(tcp://\S+)(?=.*Registered to: +tcp://)", re.DOTALL),
}


def until(what: Callable[[], Any]) -> Any:
    """Ask again and again until there is an answer that is true; return it."""
    end = time.monotonic() + PATIENCE
    while not (found := what()):
        assert time.monotonic() < end, what
        time.sleep(0.05)
    return found


def wait_for(path: str) -> str:
    """Wait, on a worker, until there is a file; leave a mark at the beginning."""
    Path(f"{path}.{os.getpid()}").touch()
    until(Path(path).exists)
    return path


def begun(path: Path) -> list[int]:
    """Return the processes that wait for a file."""
    marks = path.parent.glob(f"{path.name}.*")
    return sorted(int(mark.suffix[1:]) for mark in marks)


class Process:
    """A scheduler or a worker."""

    def __init__(
        self, kind: str, folder: Path, *arguments: str, source: Path = ROOT, **settings: str
    ) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._kind, self._log = kind, folder / "log"
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *arguments]
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                command,
                cwd=folder,
                env={**os.environ, "PYTHONPATH": str(source), **settings},
                stdout=log,
                stderr=subprocess.STDOUT,
            )
        self.pid = self._process.pid
        self.address = str(until(self._find))

    def _find(self) -> str:
        text = self._log.read_text(encoding="utf-8", errors="replace")
        assert self._process.poll() is None, text
        found = AT[self._kind].search(text)
        return found[1] if found else ""

    def send(self, number: signal.Signals) -> None:
        """Send a signal."""
        self._process.send_signal(number)

    def kill(self) -> None:
        """End it as `kill -9` does."""
        self._process.kill()
        self._process.wait(PATIENCE)


class Cluster:
    """A scheduler and its workers."""

    def __init__(self, folder: Path, **settings: str) -> None:
        self._folder = folder
        quiet = ("--no-dashboard", "--dashboard-address", ":0")
        local = ("--host", "127.0.0.1", "--port", "0", *quiet)
        self.scheduler = Process("scheduler", folder / "scheduler", *local, **settings)
        self.address = self.scheduler.address
        self.workers: list[Process] = []

    def start_worker(self, source: Path = ROOT) -> Process:
        """Start a worker of one thread, whose Slidetune is that of a folder."""
        options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--memory-limit", "0")
        folder = self._folder / f"worker-{len(self.workers)}"
        local = ("--host", "127.0.0.1", "--local-directory", str(folder))
        worker = Process("worker", folder, self.address, *options, *local, source=source)
        self.workers.append(worker)
        return worker


@contextmanager
def dask_cluster(folder: Path, workers: int, **settings: str) -> Iterator[Cluster]:
    """Start a cluster, its scheduler with these settings; kill it at the end."""
    cluster = Cluster(folder, **settings)
    try:
        for _ in range(workers):
            cluster.start_worker()
        yield cluster
    finally:
        for process in (*cluster.workers, cluster.scheduler):
            process.kill()
