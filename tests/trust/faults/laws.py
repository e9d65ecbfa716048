"""Laws that fail while the session runs: one that raises, one whose torque is not a number."""

from __future__ import annotations

from typing import Any

from tests.trust.faults import broken_laws
from tests.trust.faults.broken_laws import MESSAGE, POISON
from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.live import Follower, Message
from tests.trust.faults.server import served

CALM = {"k1": 5.0, "k2": 1.0}
RUNNING = {"running"}
LANES = {"bad", "good", "other"}


def _document(mode: str, bad: Message) -> Message:
    return {
        "robot": {"armature": 1.0},
        "lanes": {
            "bad": bad,
            "good": {"law": "computed_torque"},
            "other": {"law": "rbfnn_smc", **CALM},
        },
        "simulation": {"mode": mode},
    }


def _lane_of(live: Follower, name: str) -> Any:
    return live.state["lanes"].get(name, {"status": "gone", "cause": None})


def _frozen(live: Follower, promises: Promises, cause: str, seconds: float) -> float:
    """Wait for the bad lane to freeze; check that all others go on. Return the time in [s]."""
    live.wait(lambda: _lane_of(live, "bad")["status"] == "frozen", "a frozen lane", seconds)
    status = _lane_of(live, "bad")
    promises.hold(cause in (status["cause"] or ""), f"the cause is {status['cause']}")
    frames, metrics = live.frames, live.messages.get("metrics")
    moment = live.state["time"]
    live.wait(lambda: live.state["time"] > moment + 0.5, "time to go on", 15.0)
    live.wait(lambda: live.messages.get("metrics") is not metrics, "metrics", 15.0)
    promises.hold(live.frames > frames, "no frames any more")
    promises.hold(live.state["playing"], "the session paused")
    others = {lane["status"] for name, lane in live.state["lanes"].items() if name != "bad"}
    promises.hold(others == RUNNING, "another lane stopped too")
    promises.hold(not live.closed and not live.faults, f"a client got {live.faults[:1]}")
    return float(status["time"])


def _one_mode(live: Follower, http: Any, promises: Promises, mode: str) -> list[float]:
    """Let both laws fail in one mode, and mend them by an edit and a reset."""
    http.put("/api/experiment", json=_document(mode, {"law": "smc", **CALM})).raise_for_status()
    http.post("/api/session/play").raise_for_status()
    live.wait(lambda: set(live.state["lanes"]) == LANES, "the new lanes")
    times = [_frozen(live, promises, MESSAGE, 60.0)]
    live.send({"type": "patch", "patch": {"lanes": {"bad": {"law": "computed_torque"}}}, "id": 1})
    live.send({"type": "reset"})
    live.wait(lambda: _lane_of(live, "bad")["status"] == "running", "a lane that runs again")
    live.wait(lambda: live.state["time"] > 0.2, "time after the reset")
    live.send({"type": "patch", "patch": {"lanes": {"bad": {"kd": POISON}}}, "id": 2})
    times.append(_frozen(live, promises, "not a number", 30.0))
    # A copy continues from it, and a fork goes back to before it: neither may bring NaN in.
    live.send({"type": "lane", "origin": "bad", "name": "copy", "id": 3})
    live.wait(lambda: "copy" in live.state["lanes"], "a copy of the frozen lane")
    moment = max(0.0, times[-1] - 0.1)
    body = {"time": moment, "origin": "bad", "name": "fork", "gains": {"kd": 40.0}}
    http.post("/api/session/fork", json=body).raise_for_status()
    live.wait(lambda: _lane_of(live, "fork")["status"] == "running", "a fork of the past")
    live.wait(lambda: live.state["time"] > moment + 0.3, "time after the fork")
    promises.hold(not live.faults, f"a client got {live.faults[:1]}")
    return times


def break_laws(quick: bool) -> Outcome:
    """Run a server with two broken laws."""
    promises, times = Promises(), []
    modes = ("continuous",) if quick else ("continuous", "sampled")
    with served(module=broken_laws.__name__) as server, server.http() as http:
        with Follower(server.port) as live:
            for mode in modes:
                times += _one_mode(live, http, promises, mode)
            rows = live.rows
        stumbled = [
            line for line in server.lines if "session failed" in line or "failed and is" in line
        ]
        promises.hold(not stumbled, f"the server wrote: {stumbled[:1]}")
    measured = (
        f"frozen with its cause after {', '.join(f'{time:.2f}' for time in times)} s; two other "
        f"lanes went on; {rows} rows, all finite; runs again after an edit and a reset"
    )
    return promises.outcome(f"each {len(modes)} times: {' and '.join(modes)}", measured)


FAULTS = (
    Fault(
        "law",
        "A law raises; a law returns NaN",
        "Its lane freezes with a cause, the others go on; no client ever gets NaN",
        break_laws,
    ),
)
