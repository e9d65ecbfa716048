"""An executor whose tasks a cluster of Dask makes, and what is told of a cluster that shrinks.

A worker that is lost costs time and nothing else: Dask has its tasks made again by another one.
Whatever else is lost ends all tasks within seconds.
"""

from __future__ import annotations

import pickle
import threading
import uuid
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Executor, Future
from concurrent.futures import wait as wait_for
from typing import Any

from slidetune.server.compute.cluster_state import ClusterState, Tell
from slidetune.server.compute.cluster_task import (
    ClusterError,
    content_key,
    packed_call,
    refuse_own_laws,
)

POLL = 0.5
"""Time between two looks at the cluster in [s] (*ours*)."""


class ClusterExecutor(Executor):
    """Hands tasks to a cluster; see ``cluster_executor``."""

    def __init__(self, client: Any, tell: Tell) -> None:
        """Begin to watch the cluster of a ``distributed.Client``.

        Raises:
            ClusterError: if it is lost already.
        """
        self._dask: Any = client.get_executor()
        self._lock = threading.Lock()
        self._running: dict[Future[Any], tuple[str, Future[Any]]] = {}
        self._wanted: Counter[str] = Counter()
        self._failure: ClusterError | None = None
        self._closed = threading.Event()
        self._cluster = ClusterState(client, tell)
        self._cluster.look()
        self._watcher = threading.Thread(target=self._follow, name="cluster", daemon=True)
        self._watcher.start()

    @property
    def workers(self) -> frozenset[str]:
        """Addresses of the workers that there were at the last look."""
        return self._cluster.workers

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hand on a call; one that is under way already isn't made twice.

        Args:
            function: one of a module, and pure.
            args: experiments and plain JSON values.
            kwargs: none.

        Raises:
            ClusterError: if the cluster is lost.
            InvalidExperimentError: for an experiment whose law the workers don't know.
            TypeError: for other arguments.
        """
        if kwargs:
            raise TypeError("a task of a cluster has no arguments by name")
        refuse_own_laws(args)
        return self._submit(content_key(function, args), "a worker", function, args)

    def submit_to(self, worker: str, function: Callable[[], Any]) -> Future[Any]:
        """Hand a call to the worker of that address, before all others."""
        key = f"{function.__name__}-{uuid.uuid4()}"
        return self._submit(key, f"worker {worker}", function, (), workers=[worker], priority=1)

    def _submit(
        self, key: str, who: str, function: Callable[..., Any], args: tuple[Any, ...], **where: Any
    ) -> Future[Any]:
        asked: Future[Any] = Future()
        call = packed_call(function, args)
        with self._lock:
            if self._failure is not None:
                raise self._failure
            made = self._dask.submit(pickle.loads, call, key=key, **where)
            self._running[asked] = key, made
            self._wanted[key] += 1
        asked.add_done_callback(self._forget)
        made.add_done_callback(lambda made: self._settle(who, asked, made))
        return asked

    def _let_go(self, asked: Future[Any]) -> tuple[Future[Any] | None, bool]:
        """Return a task that is no longer waited for here, and whether anybody else does."""
        with self._lock:
            key, made = self._running.pop(asked, ("", None))
            self._wanted[key] -= 1
            others = self._wanted[key] > 0
            if not others:
                del self._wanted[key]
        return made, others

    def _forget(self, asked: Future[Any]) -> None:
        """Cancel what nobody waits for any more."""
        made, others = self._let_go(asked)
        if made is not None and not others:
            made.cancel()

    def _settle(self, who: str, asked: Future[Any], made: Future[Any]) -> None:
        """Pass on what came of a task, and let go of it: the cluster forgets it as well."""
        known, _ = self._let_go(asked)
        if known is None or not asked.set_running_or_notify_cancel():
            return
        if made.cancelled():  # by Dask, and it does so where it loses its scheduler
            asked.set_exception(self._cluster.scheduler_lost())
        elif (error := made.exception()) is not None:
            asked.set_exception(_told(who, error))
        else:
            asked.set_result(made.result())

    def _follow(self) -> None:
        while not self._closed.wait(POLL):
            try:
                self._cluster.look()
            except ClusterError as error:
                self._fail(error)
                return

    def _fail(self, error: ClusterError) -> None:
        with self._lock:
            self._failure = error
            lost = list(self._running)
            self._running.clear()
            self._wanted.clear()
        for asked in lost:
            if asked.set_running_or_notify_cancel():
                asked.set_exception(error)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Take no more tasks; wait for those under way, or let go of them.

        What a worker is busy with it ends: its results are of no use to anybody then.
        """
        with self._lock:
            self._failure = self._failure or ClusterError("the study has ended")
            running = list(self._running)
        if cancel_futures:
            for asked in running:
                asked.cancel()
        if wait:
            wait_for(running)
            self._closed.set()
            self._watcher.join()


def _told(who: str, error: BaseException) -> BaseException:
    """Return what came of a task as people are told it."""
    if isinstance(error, ImportError | AttributeError):
        return ClusterError(f"{who} can't load this Slidetune: {error}")
    if type(error).__name__ == "KilledWorker":
        return ClusterError(f"a task ended every worker that took it: {error}")
    return error
