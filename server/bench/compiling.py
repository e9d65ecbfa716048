"""How long a new machine compiles, and how long a start takes once that is done."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

from slidetune.server.bench.result import Measurement, measurement

COMPILE = "first compile of everything on a new machine"
CACHED = "process start until everything compiled is loaded"
_WARM_UP = """
from slidetune.robot.kernels.compiler import CACHE
from slidetune.robot.loop.warmup import warm_up
warm_up()
print(CACHE, flush=True)
"""


def start(folder: Path) -> tuple[float, str]:
    """Warm a new process up; return the time until it is warm in [s], and where its kernels lie.

    Args:
        folder: where caches lie.

    Raises:
        OSError: if it doesn't start, or ends before.
    """
    begin = perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-c", _WARM_UP],
        env={**os.environ, "XDG_CACHE_HOME": str(folder)},
        stdout=subprocess.PIPE,
        encoding="utf-8",
    )
    with process:
        assert process.stdout is not None
        cache = process.stdout.readline().strip()
        taken = perf_counter() - begin
    if not cache:
        raise ChildProcessError(f"a process that compiles ended with {process.returncode}")
    return taken, cache


def measure_compiling(progress: Callable[[float], None]) -> list[Measurement]:
    """Start a process without compiled kernels, then others that find them.

    Args:
        progress: called with the share done, 0 to 1.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        try:
            first, cache = start(folder)
            progress(0.8)
            starts = [start(folder)[0] for _ in range(3)]
        except OSError as error:
            return [Measurement(COMPILE, "s", None, None, target=20.0, note=str(error))]
    progress(1.0)
    if folder not in Path(cache).resolve().parents:
        # Some systems keep caches where no variable moves them: that one was compiled before.
        note = "this system's cache can't be put elsewhere"
        compiled = Measurement(COMPILE, "s", None, None, target=20.0, note=note)
    else:
        compiled = Measurement(COMPILE, "s", first, None, target=20.0)
    return [compiled, measurement(CACHED, "s", starts, target=2.0)]
