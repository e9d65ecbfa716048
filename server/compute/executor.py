"""Where the runs of studies are made: the cores of this machine, or a cluster's."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import Any, TypeVar

from slidetune.robot.loop.simulate import CancelledError, stop_flag

Result = TypeVar("Result")

NICENESS = 10
"""Of a study's threads beside a live session (*ours*): one of the same core gets nine tenths."""


class LocalExecutor(Executor):
    """This machine's cores.

    Threads: a run is one call that holds no lock of the interpreter. Runs under way can be stopped:
    what is submitted takes ``stop``, which ``simulate`` looks at.
    """

    def __init__(self, workers: int | None = None, nice: bool = False) -> None:
        """Start them.

        Args:
            workers: how many; by default one a core.
            nice: whether they keep out of the way of others of this process.
        """
        count = workers or os.cpu_count() or 1
        self._stop = stop_flag()
        self._pool = ThreadPoolExecutor(count, "study", _keep_back if nice else None)

    def submit(
        self, function: Callable[..., Result], /, *args: Any, **options: Any
    ) -> Future[Result]:
        """Run ``function(*args, stop=…)`` in a thread.

        Raises:
            CancelledError: once runs under way were stopped.
        """
        try:
            return self._pool.submit(function, *args, stop=self._stop, **options)
        except RuntimeError as error:
            if self._stop[0]:
                raise CancelledError from error
            raise

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End them; with ``cancel_futures`` runs under way are stopped too."""
        if cancel_futures:
            self._stop[0] = 1
        self._pool.shutdown(wait, cancel_futures=cancel_futures)


def _keep_back() -> None:
    if sys.platform == "linux":  # where a thread has a niceness of its own
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICENESS)


def local_executor(workers: int | None = None) -> Executor:
    """Return this machine's cores, one thread a core where ``workers`` is not given."""
    return LocalExecutor(workers)
