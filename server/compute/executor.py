"""Where runs are made: the cores of this machine, or a cluster's."""

from __future__ import annotations

import os
from concurrent.futures import Executor, ThreadPoolExecutor


def local_executor(workers: int | None = None) -> Executor:
    """Return this machine's cores.

    Threads: a run is one call that holds no lock of the interpreter.

    Args:
        workers: how many; by default one a core.
    """
    return ThreadPoolExecutor(workers or os.cpu_count() or 1, "study")
