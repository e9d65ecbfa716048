"""The live session of a real server, seen by one real client."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import perf_counter

import httpx
import numpy as np
from websockets.sync.client import connect
from websockets.sync.connection import Connection

from slidetune.server.bench.preview import measure_drag
from slidetune.server.bench.result import Measurement, measurement
from slidetune.server.bench.searches import measure_beside, own_studies
from slidetune.server.bench.served import (
    RunningServer,
    ServerStartError,
    running_server,
    stepping_thread,
    thread_times,
)
from slidetune.server.live.telemetry import HEADER

LANE = "RBFNN-NFTSM"
READY = "process start until the server answers"
LATENCY = "slider move to its first telemetry frame"
FACTOR = "real-time factor, 3 lanes at 1 kHz, one client"
SESSION_SHARE = "session thread, share of one core"
PROCESS_SHARE = "server process, share of one core"
GAP = (0.01, 0.06)
"""Time between two slider moves in [s], random so that no clock of the server's is met (*ours*)."""


@dataclass(frozen=True)
class Frame:
    """The head of a telemetry frame.

    Attributes:
        revision: revision of the experiment that made its rows.
        end: simulated time after its last row in [s].
        dropped: rows that this client missed before it.
        arrival: when it came in [s].
    """

    revision: int
    end: float
    dropped: int
    arrival: float


def _frame(message: bytes) -> Frame:
    arrival = perf_counter()
    revision, rows, _, dropped, first, period = HEADER.unpack_from(message)
    return Frame(revision, first + rows * period, dropped, arrival)


def frames(connection: Connection, seconds: float) -> Iterator[Frame]:
    """Yield telemetry frames as they come, for so many seconds."""
    end = perf_counter() + seconds
    while (left := end - perf_counter()) > 0.0:
        try:
            message = connection.recv(timeout=left)
        except TimeoutError:
            return
        if isinstance(message, bytes):
            yield _frame(message)


def latencies(connection: Connection, count: int) -> list[float]:
    """Move a slider again and again; return the time until its effect arrives in [ms]. Shape (n,).

    Raises:
        ServerStartError: if an effect doesn't come within 5 s.
    """
    dice = random.Random(1)
    taken = []
    revision = max((frame.revision for frame in frames(connection, 0.2)), default=1)
    for number in range(count):
        nu = 10.0 ** dice.uniform(-0.5, 1.5)
        patch = {"lanes": {LANE: {"nu": nu}}}
        begin = perf_counter()
        connection.send(json.dumps({"type": "patch", "patch": patch, "id": number}))
        effects = (frame for frame in frames(connection, 5.0) if frame.revision > revision)
        effect = next(effects, None)
        if effect is None:
            raise ServerStartError("a slider move had no effect within 5 s")
        taken.append((effect.arrival - begin) * 1e3)
        revision = effect.revision
        for _ in frames(connection, dice.uniform(*GAP)):
            pass
    return taken


def _latency(connection: Connection, count: int) -> Measurement:
    taken = latencies(connection, count)
    return Measurement(
        LATENCY,
        "ms",
        min(taken),
        float(np.median(taken)),
        high=float(np.quantile(taken, 0.95)),
        target=50.0,
        note=f"{count} moves",
    )


def _pace(
    server: RunningServer, connection: Connection, thread: int | None, seconds: float
) -> list[Measurement]:
    """Listen for so long; return real-time factor and processor shares."""
    for _ in frames(connection, 0.5):  # what was waiting
        pass
    before, begin = thread_times(server.process), perf_counter()
    heard = list(frames(connection, seconds))
    after, passed = thread_times(server.process), perf_counter() - begin
    missed = sum(frame.dropped for frame in heard)
    span = heard[-1].arrival - heard[0].arrival
    factor = (heard[-1].end - heard[0].end) / span
    rows = [
        Measurement(
            FACTOR,
            "",
            factor,
            None,
            target=0.99,
            limit="at least",
            note=f"{len(heard)} frames, {missed} rows missed",
        )
    ]
    if thread is None or thread not in after:
        note = "only Linux reports the processor time of a thread"
        return [*rows, Measurement(SESSION_SHARE, "", None, None, target=0.15, note=note)]
    taken = {key: (after[key] - before.get(key, 0.0)) / passed for key in after}
    share, whole = taken[thread], sum(taken.values())
    return [
        *rows,
        Measurement(SESSION_SHARE, "", share, None, target=0.15),
        Measurement(PROCESS_SHARE, "", whole, None),
    ]


def _with_client(quick: bool, progress: Callable[[float], None]) -> tuple[float, list[Measurement]]:
    with own_studies() as environment, running_server((), environment) as server:
        progress(0.3)
        # The workers load what they need at the start: until then they are the busiest.
        wanted = {"patch": {"simulation": {"horizon": 0.5}}}
        address = f"http://127.0.0.1:{server.port}/api/preview"
        httpx.post(address, json=wanted, timeout=60.0).raise_for_status()
        thread = stepping_thread(server.process, 0.5 if quick else 2.0)
        address = f"ws://127.0.0.1:{server.port}/api/live"
        with connect(address, compression=None, max_size=None, proxy=None) as connection:
            rows = _pace(server, connection, thread, 1.0 if quick else 10.0)
            progress(0.6)
            rows.append(_latency(connection, 10 if quick else 200))
        progress(0.8)
        rows += measure_drag(server.port, quick)
        rows += measure_beside(server.port, quick)
    return server.ready, rows


def _starts(count: int) -> list[float]:
    taken = []
    for _ in range(count):
        with running_server() as server:
            taken.append(server.ready)
    return taken


def measure_live(quick: bool, progress: Callable[[float], None]) -> list[Measurement]:
    """Start servers and talk to one; return the rows, or one that says why there are none.

    Args:
        quick: short and few, for a look instead of a verdict.
        progress: called with the share done, 0 to 1.
    """
    try:
        ready, rows = _with_client(quick, progress)
        starts = [ready, *_starts(0 if quick else 2)]
    except (ServerStartError, OSError) as error:
        return [Measurement(READY, "s", None, None, target=4.0, note=str(error))]
    progress(1.0)
    return [measurement(READY, "s", starts, target=4.0), *rows]
