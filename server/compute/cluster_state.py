"""What is known of a cluster, told whenever it changes: how many workers it has, and had."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from slidetune.server.compute.cluster_task import ClusterError

Tell = Callable[[str], None]

SILENT = 15.0
"""Time without a word after which a worker or the scheduler is taken for lost in [s] (*ours*). A
worker speaks twice a second, one of two hundred every other second (Dask's intervals)."""
GRACE = 10.0
"""Time for another worker to come where none is left in [s] (*ours*): Dask's nanny starts one in
about three."""
ANSWER = 3.0
"""Time after which it is told that the scheduler doesn't answer in [s] (*ours*)."""


class ClusterState:
    """Looks at a cluster again and again."""

    def __init__(self, client: Any, tell: Tell) -> None:
        """Begin with a ``distributed.Client`` that is connected."""
        self._client, self._tell = client, tell
        self._told, self._most = "", 0
        self._heard: dict[str, tuple[float, float]] = {}
        self._answered = self._manned = time.monotonic()

    @property
    def workers(self) -> frozenset[str]:
        """Addresses of the workers that there were at the last look."""
        return frozenset(self._heard)

    def look(self) -> None:
        """Look once, and tell what is new.

        Raises:
            ClusterError: if the scheduler is lost, or every worker.
        """
        said, now = self._last_words(), time.monotonic()
        if said is None:
            if now - self._answered > SILENT:
                raise self.scheduler_lost()
            self._say("the scheduler doesn't answer at present")
            return
        self._answered = now
        # The scheduler dates a worker's last word by its own clock; ours tells how old it is.
        before = self._heard
        self._heard = {
            worker: before[worker] if before.get(worker, (None,))[0] == when else (when, now)
            for worker, when in said.items()
        }
        silent = sum(now - since > SILENT for _, since in self._heard.values())
        self._most = max(self._most, len(said))
        if len(said) > silent:
            self._manned = now
        elif now - self._manned > GRACE:
            raise ClusterError(f"all of its {self._most} workers are lost")
        if self._most:
            self._say(self._words(len(said), silent))

    def scheduler_lost(self) -> ClusterError:
        """Return the error of a scheduler that is gone, or as good as gone."""
        return ClusterError(f"the scheduler at {self._client.scheduler.address} is lost")

    def _last_words(self) -> dict[str, float] | None:
        """Return when the scheduler heard of each worker, or nothing if it doesn't answer."""
        if self._client.status != "running":
            raise self.scheduler_lost()
        try:
            found = self._client.sync(self._client.scheduler.identity, callback_timeout=ANSWER)
        except TimeoutError:
            return None
        except Exception as error:  # whatever becomes of a connection that breaks
            raise self.scheduler_lost() from error
        return {worker: about["last_seen"] for worker, about in found["workers"].items()}

    def _words(self, there: int, silent: int) -> str:
        lost = self._most - there
        if not lost and not silent:
            return f"{there} worker{'s' * (there != 1)}"
        of, left = f"of {self._most} workers", there - silent
        gone = [f"{lost} {of} lost"] * bool(lost) + [f"{silent} {of} silent"] * bool(silent)
        rest = f"going on with {left}" if left else f"waiting {GRACE:g} s for another"
        return f"{', '.join(gone)}, {rest}"

    def _say(self, words: str) -> None:
        if words != self._told:
            self._told = words
            self._tell(f"Cluster: {words}.")
