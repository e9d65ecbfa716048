"""Clients that leave in the middle of what the workers do for them: a response, a study."""

from __future__ import annotations

import time
from typing import Any

import httpx

from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.live import Follower, strict_json
from tests.trust.faults.server import Server, served

SLOWLY = {"mode": "sampled", "control_rate": 1000.0, "plant_substeps": 190, "horizon": 40.0}
"""Nearly as many steps of the arm as are run."""
SLOW = {"robot": {"armature": 5.0}, "lanes": {"A": {"law": "computed_torque"}}}
LEAVE = 0.5
"""Time after which a client leaves in [s]: a slow response takes some four."""


def _time_goes_on(live: Follower, promises: Promises, begin: tuple[float, float]) -> float:
    """Return simulated seconds a second since ``begin``, and check that time went on."""
    wall, simulated = (last - first for first, last in zip(begin, live.last, strict=True))
    factor = simulated / max(wall, 1e-9)
    promises.hold(factor > 0.5, f"the session ran at {factor:.2f} of real time")
    promises.hold(not live.closed, "a client lost its connection")
    promises.hold(not live.faults, f"a client got {live.faults[:1]}")
    return factor


def _next_is_served(http: httpx.Client, promises: Promises, number: int) -> float:
    """Ask for another response; return how long it took in [s]."""
    begin = time.monotonic()
    patch = {"simulation": {"horizon": 0.6 + 0.01 * number}}  # not one that is remembered
    answer = http.post("/api/preview", json={"patch": patch, "estimate": False})
    promises.hold(answer.status_code == 200, f"the next response: {answer.status_code}")
    return time.monotonic() - begin


def _leave(server: Server, number: int, promises: Promises) -> None:
    """Ask for a slow response and leave before it is there."""
    # Each of another length: what has been computed once is remembered.
    simulation = {**SLOWLY, "horizon": SLOWLY["horizon"] + 0.01 * number}  # type: ignore[operator]
    with server.http() as http:
        try:
            wanted = {"experiment": {**SLOW, "simulation": simulation}}
            http.post("/api/preview", json=wanted, timeout=LEAVE)
            promises.hold(False, "the slow response was there before the client left")
        except httpx.TimeoutException:
            pass


def leave_responses(quick: bool) -> Outcome:
    """Leave slow responses one after the other, many more than there are workers."""
    promises, count, waits = Promises(), 3 if quick else 12, []
    with served() as server, server.http() as http, Follower(server.port) as live:
        live.wait(lambda: live.frames > 5, "frames")
        begin = live.last
        for number in range(count):
            _leave(server, number, promises)
            waits.append(_next_is_served(http, promises, number))
        # Were they all still at it, this would wait for one of them to end.
        promises.hold(max(waits) < 10.0, f"the next response took {max(waits):.1f} s")
        factor = _time_goes_on(live, promises, begin)
    measured = (
        f"next response after {max(waits):.1f} s at most; "
        f"the session meanwhile at {factor:.2f} of real time"
    )
    return promises.outcome(f"{count} clients, each after {LEAVE:g} s", measured)


def leave_studies(quick: bool) -> Outcome:
    """Leave studies after their first line; then let one come to its end."""
    promises, count = Promises(), 2 if quick else 10
    wanted = {"lane": "RBFNN-NFTSM", "field": "c", "count": 6 if quick else 24}
    with served() as server, server.http() as http, Follower(server.port) as live:
        http.patch("/api/experiment", json={"simulation": {"horizon": 3.0}}).raise_for_status()
        live.wait(lambda: live.frames > 5, "frames")
        begin = live.last
        for _ in range(count):
            with http.stream("POST", "/api/studies/strip", json=wanted) as answer:
                promises.hold(answer.status_code == 200, f"a study: {answer.status_code}")
                next(answer.iter_lines())
        rows: list[dict[str, Any]] = []
        with http.stream("POST", "/api/studies/strip", json=wanted) as answer:
            rows += [strict_json(line) for line in answer.iter_lines()]
        promises.hold(len(rows) == wanted["count"], f"{len(rows)} lines")
        promises.hold(all(row["state"] != "refused" for row in rows), "a line was refused")
        factor = _time_goes_on(live, promises, begin)
    measured = (
        f"{len(rows)} lines of the last one, all with figures; "
        f"the session meanwhile at {factor:.2f} of real time"
    )
    return promises.outcome(f"{count} studies, each left after its first line", measured)


FAULTS = (
    Fault(
        "leave-response",
        "A client leaves in the middle of a long response",
        "The run stops; the next response does not wait for it; the session is not affected",
        leave_responses,
    ),
    Fault(
        "leave-study",
        "A client leaves in the middle of a study",
        "Its runs stop; the next study is complete; the session is not affected",
        leave_studies,
    ),
)
