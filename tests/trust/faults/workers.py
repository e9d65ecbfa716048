"""Worker processes that are killed: idle, in a whole response, in the middle of a study."""

from __future__ import annotations

import os
import random
import signal
import threading
import time
from typing import Any

import httpx

from slidetune.server.bench.served import thread_times
from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.live import Follower, strict_json
from tests.trust.faults.server import Server, served, wait_for, workers

SLOW = {"lanes": {"A": {"law": "computed_torque"}}}
SLOWLY = {"mode": "sampled", "control_rate": 1000.0, "plant_substeps": 190}
"""Nearly as many steps of the arm as are run: it can be killed in the middle."""
SHORT = {"simulation": {"horizon": 0.5}}


def _kill_workers(server: Server) -> int:
    found = workers(server.process.pid)
    for process in found:
        os.kill(process, signal.SIGKILL)
    return len(found)


def _warm(server: Server, http: httpx.Client) -> None:
    """Wait until the workers answer."""
    http.post("/api/preview", json={"patch": SHORT, "quick": True}).raise_for_status()
    wait_for(lambda: workers(server.process.pid), "a worker")


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
    answer = http.post("/api/preview", json={"patch": patch, "quick": True})
    promises.hold(answer.status_code == 200, f"the next response: {answer.status_code}")
    return time.monotonic() - begin


def kill_responding(quick: bool) -> Outcome:
    """Kill the workers while they compute whole responses, and while they have nothing to do."""
    promises, dice, kills = Promises(), random.Random(3), 1 if quick else 5
    told, waits = set(), []
    with served() as server, server.http() as http, Follower(server.port) as live:
        _warm(server, http)
        live.wait(lambda: live.frames > 5, "frames")
        begin = live.last
        for number in range(kills):
            answers: list[httpx.Response] = []
            thread = threading.Thread(target=_ask_slow, args=(server, number, answers))
            thread.start()
            _wait_until_busy(server)
            time.sleep(dice.uniform(0.0, 0.5))
            promises.hold(not answers, "the slow response was there before the kill")
            _kill_workers(server)
            thread.join(60.0)
            told.add(_told(answers))
            waits.append(_next_is_served(http, promises, 2 * number))
        promises.hold(told == {"503 worker_lost"}, f"the request was told {', '.join(told)}")
        _kill_workers(server)
        wait_for(lambda: not workers(server.process.pid), "the end of the workers")
        waits.append(_next_is_served(http, promises, 2 * kills + 1))
        factor = _time_goes_on(live, promises, begin)
    measured = (
        f"{', '.join(sorted(told))}; next response after {max(waits):.1f} s at most; "
        f"the session meanwhile at {factor:.2f} of real time"
    )
    return promises.outcome(f"{kills} kills in the middle of a response, 1 kill at rest", measured)


def _wait_until_busy(server: Server) -> None:
    """Wait until a worker has computed for a tenth of a second; where that is hidden, half one."""
    before = {process: _busy(process) for process in workers(server.process.pid)}
    if not any(before.values()):
        time.sleep(0.5)
        return
    wait_for(
        lambda: any(_busy(process) > time + 0.1 for process, time in before.items()),
        "a worker that computes",
        60.0,
    )


def _busy(process: int) -> float:
    """Return the processor time of a process in [s], 0 where it is hidden."""
    return sum(thread_times(process).values())


def _told(answers: list[httpx.Response]) -> str:
    """Return what a request was told: its status, and the code of an error."""
    if not answers:
        return "nothing"
    refused = answers[0].status_code != 200
    return f"{answers[0].status_code} {answers[0].json()['error']['code'] if refused else ''}"


def _ask_slow(server: Server, number: int, answers: list[httpx.Response]) -> None:
    # Each of another length: what has been computed once is remembered.
    wanted = {**SLOW, "simulation": {**SLOWLY, "horizon": 10.0 + 0.01 * number}}
    with server.http() as http:
        answers.append(http.post("/api/preview", json={"experiment": wanted}))


def kill_study(quick: bool) -> Outcome:
    """Kill the workers in the middle of a study."""
    promises, kills, count = Promises(), 1 if quick else 4, 4 if quick else 24
    rows: list[dict[str, Any]] = []
    with served() as server, server.http() as http, Follower(server.port) as live:
        _warm(server, http)
        http.patch("/api/experiment", json={"simulation": {"horizon": 3.0}}).raise_for_status()
        begin = live.last
        for kill in range(kills):
            wanted = {"lane": "RBFNN-NFTSM", "field": "c", "count": count}
            lines: list[dict[str, Any]] = []
            with http.stream("POST", "/api/studies/strip", json=wanted) as answer:
                for line in answer.iter_lines():
                    lines.append(strict_json(line))
                    if len(lines) == 2 + kill:
                        _kill_workers(server)
            promises.hold(len(lines) == count, f"{len(lines)} of {count} lines")
            promises.hold("mae" in lines[-1], "the last line has no figures")
            lost = [line for line in lines if "worker" in line["reason"]]
            promises.hold(len(lost) <= 1, f"{len(lost)} lines were lost with one worker")
            rows += lines
        factor = _time_goes_on(live, promises, begin)
    lost = [row for row in rows if "worker" in row["reason"]]
    promises.hold(all(row["state"] == "refused" for row in lost), "a lost line was not told so")
    promises.hold(len({frozenset(row) for row in rows}) == 1, "a lost line has other keys")
    measured = (
        f"{len(rows)} lines, of which {len(lost)} say that their worker was lost; "
        f"the session meanwhile at {factor:.2f} of real time"
    )
    return promises.outcome(f"{kills} kills in the middle of a study of {count} runs", measured)


FAULTS = (
    Fault(
        "kill-worker",
        "kill -9 of a worker that computes a whole response",
        "The request gets 503; a new worker serves the next; the session is not affected",
        kill_responding,
    ),
    Fault(
        "kill-study",
        "kill -9 of a worker in a study",
        "One line of the study is reported as lost, all others arrive; the session is not affected",
        kill_study,
    ),
)
