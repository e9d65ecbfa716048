"""Threads that run whole experiments beside the live session, which must not notice.

A lane's rows are made in one call that holds no lock of the interpreter, so that threads share the
cores as processes would. A task can be stopped while it runs: it looks at a flag of its own.
"""

from __future__ import annotations

import asyncio
import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import numpy as np

from slidetune.robot.errors import SlidetuneError
from slidetune.robot.loop.simulate import stop_flag
from slidetune.server.compute.turns import Turns

Result = TypeVar("Result")

MOST = 256
"""Tasks that can be under way or waiting at once (*ours*)."""


class BusyError(SlidetuneError, RuntimeError):
    """Too many tasks wait already."""


def worker_count() -> int:
    """Return how many threads there are: with three lanes on two cores all end at the same time."""
    return max(4, min(16, (os.cpu_count() or 2) - 1))


def _begin() -> None:
    """Keep out of the session's way."""
    if sys.platform == "linux":  # where a thread has a niceness of its own
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 5)


class Workers:
    """A pool of threads."""

    def __init__(self, count: int | None = None) -> None:
        """Say how many threads there will be."""
        self._count = count or worker_count()
        self._stops: dict[int, np.ndarray] = {}
        self._turns = Turns(self._count)
        self._pool = ThreadPoolExecutor(self._count, "worker", _begin)

    def start(self) -> None:
        """Start the threads, and load what the first task would have to wait for."""
        for _ in range(self._count):
            self._pool.submit(_load)

    def stop(self) -> None:
        """Stop all tasks; none begins any more."""
        for stop in self._stops.values():
            stop[0] = 1
        self._pool.shutdown(cancel_futures=True)

    @property
    def tasks(self) -> int:
        """How many tasks are under way or waiting."""
        return len(self._stops)

    async def run(self, function: Callable[..., Result], *args: Any, client: str = "") -> Result:
        """Run ``function(*args, stop=…)`` in a thread; cancelling this stops the task.

        Args:
            function: what to run; it takes ``stop``, which ``simulate`` looks at.
            args: its other arguments.
            client: who asks; of those who wait each has its turn, however much another asked.

        Raises:
            BusyError: if too many tasks wait already.
        """
        if self.tasks >= MOST:
            raise BusyError(f"{MOST} tasks are waiting already: try again in a moment")
        stop = stop_flag()
        self._stops[id(stop)] = stop
        try:
            async with self._turns.turn(client):
                task = self._pool.submit(function, *args, stop=stop)
                return await asyncio.wrap_future(task)
        finally:
            stop[0] = 1
            del self._stops[id(stop)]


def _load() -> None:
    import scipy.signal  # noqa: F401  (slow to import: not in the middle of the first drag)
