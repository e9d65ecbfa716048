"""Processes that run whole experiments beside the live session, which must not notice.

They are started once and stay warm. A task can be cancelled while it runs: each has a slot in a
shared array and stops as soon as the number there isn't its own any more. A killed process costs
the tasks that it had; the next ones get a new pool.
"""

from __future__ import annotations

import asyncio
import itertools
import multiprocessing
import os
import signal
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from threading import Thread
from typing import Any, TypeVar

from slidetune.robot.errors import SlidetuneError
from slidetune.server.compute.turns import Turns

Result = TypeVar("Result")

TRIES = 3
"""How often a task is given to a new pool, where the old one was lost before it began (*ours*)."""
SLOTS = 256
"""Tasks that can be under way or waiting at once (*ours*)."""

_flags: Any = None
_begun: Any = None


class WorkerLostError(SlidetuneError, RuntimeError):
    """The process of a task was killed; asking again gets a new one."""


class BusyError(SlidetuneError, RuntimeError):
    """Too many tasks wait already."""


def worker_count() -> int:
    """Return how many processes to start: one core stays with the session and the browser."""
    return max(1, min(4, (os.cpu_count() or 2) - 1))


def _begin(flags: Any, begun: Any) -> None:
    """Warm a new process up: load every compiled kernel, keep out of the session's way."""
    global _flags, _begun
    _flags, _begun = flags, begun
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the server, which ends us
    Thread(target=_leave_with_parent, daemon=True).start()
    if hasattr(os, "nice"):
        os.nice(5)
    import scipy.signal  # noqa: F401  (slow to import: not in the middle of the first drag)

    from slidetune.robot.loop.warmup import warm_up

    warm_up()


def _leave_with_parent() -> None:
    """End this process as soon as the server is gone, however that ended."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(0)


def _perform(
    function: Callable[..., Result], slot: int, ticket: int, args: tuple[Any, ...]
) -> Result:
    """Run one task in a worker, with its own way to learn that it isn't wanted any more."""
    flags = _flags
    _begun[slot] = ticket
    return function(*args, cancelled=lambda: flags[slot] != ticket)


class Workers:
    """A pool of warm processes."""

    def __init__(self, count: int | None = None) -> None:
        """Say how many processes there will be; ``start`` starts them."""
        self._count = count or worker_count()
        self._context = multiprocessing.get_context("spawn")
        self._flags = self._context.Array("Q", SLOTS, lock=False)
        self._begun = self._context.Array("Q", SLOTS, lock=False)
        self._tickets = itertools.count(1)
        self._free = set(range(SLOTS))
        self._pool: ProcessPoolExecutor | None = None
        self._turns = Turns(self._count)

    def start(self) -> None:
        """Start the processes, without waiting for them."""
        self._pool = ProcessPoolExecutor(
            self._count, self._context, initializer=_begin, initargs=(self._flags, self._begun)
        )
        for _ in range(self._count):
            self._pool.submit(int)

    def stop(self) -> None:
        """End the processes, whatever they are doing."""
        for slot in range(SLOTS):
            self._flags[slot] = 0
        if self._pool is not None:
            processes = list((getattr(self._pool, "_processes", None) or {}).values())
            self._pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.terminate()
            for process in processes:
                process.join(5.0)
            self._pool = None

    def processes(self) -> list[int]:
        """Return the ids of the processes."""
        return [] if self._pool is None else list(getattr(self._pool, "_processes", None) or ())

    async def run(self, function: Callable[..., Result], *args: Any, client: str = "") -> Result:
        """Run ``function(*args, cancelled=…)`` in a process; cancelling this cancels the task.

        Args:
            function: a function of a module, which takes ``cancelled``, a callable that says
                whether to stop.
            args: what can travel between processes.
            client: who asks; of those who wait each has its turn, however much another asked.

        Raises:
            WorkerLostError: if the process was killed while it ran ``function``.
            BusyError: if too many tasks wait already.
        """
        if not self._free:
            raise BusyError(f"{SLOTS} tasks are waiting already: try again in a moment")
        slot, ticket = self._free.pop(), next(self._tickets)
        self._flags[slot] = ticket
        task = partial(_perform, function, slot, ticket, args)
        try:
            async with self._turns.turn(client):
                for _ in range(TRIES):
                    try:
                        return await asyncio.wrap_future(self._submit(task))
                    except BrokenProcessPool:
                        if self._begun[slot] == ticket or self._pool is None:
                            break  # it may be this very task that ends its process; or all is over
                raise WorkerLostError("a worker process was lost: repeat the request")
        finally:
            self._flags[slot] = 0
            self._free.add(slot)

    def _submit(self, task: Callable[[], Result]) -> Future[Result]:
        if self._pool is None:
            self.start()
        assert self._pool is not None
        try:
            return self._pool.submit(task)
        except BrokenProcessPool:
            self._pool.shutdown(wait=False)
            self.start()
            return self._pool.submit(task)
