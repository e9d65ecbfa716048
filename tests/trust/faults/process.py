"""What happens to a process from outside: taken ports, a suspension, a clock that jumps."""

from __future__ import annotations

import os
import signal
import socket
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from slidetune.server.live.pacing import LONGEST
from slidetune.server.serve import PORTS
from tests.server.scene.viser_client import ViserClient
from tests.trust.faults import jumping_clock
from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.jumping_clock import DAY, VARIABLE
from tests.trust.faults.live import Follower
from tests.trust.faults.server import FaultError, Server, served, wait_for

SLACK = 0.15
"""Simulated time in [s] that may lie between the last frame sent and the suspension, and between
a step and the arrival of its frame (*ours*)."""


@contextmanager
def _taken(count: int) -> Iterator[int]:
    """Listen on so many ports in a row; yield the first."""
    for base in range(20000, 60000, count):
        with ExitStack() as stack:
            try:
                for port in range(base, base + count):
                    listener = stack.enter_context(socket.socket())
                    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                    listener.bind(("127.0.0.1", port))
                    listener.listen()
            except OSError:
                continue
            yield base
            return
    raise FaultError(f"no {count} free ports in a row")


def _answers(server: Server, promises: Promises) -> None:
    with server.http() as http:
        promises.hold(http.get("/api/health").status_code == 200, "the other port doesn't answer")


def _one_taken(promises: Promises) -> str:
    """Ask for a port that is taken; return what the server said."""
    with _taken(1) as port, served(options=("--port", str(port))) as server:
        said = next((line for line in server.lines if "taken" in line), "nothing")
        promises.hold(str(server.port) in said, f"a taken port is told as: {said}")
        _answers(server, promises)
        promises.hold(not server.complaints, f"the server wrote: {server.complaints[:1]}")
        return said.replace(str(port), "N").replace(str(server.port), "M")


def _all_taken(promises: Promises, quick: bool) -> str:
    """Let no port be free among those that are tried; return what the server said."""
    with _taken(PORTS) as port:
        server = Server(("--port", str(port)))
        try:
            code = server.wait_until_ended()
        finally:
            server.end()
        said = next((line for line in server.lines if "Error" in line), "nothing")
        clear = str(port) in said and "--port" in said
        promises.hold(code != 0, "no port is free, and the exit code is 0")
        promises.hold(clear, f"no port is free, and it only says: {said}")
        promises.hold(not server.complaints, f"the server wrote: {server.complaints[:1]}")
        if not quick:  # what the message suggests
            with served(options=("--port", "0")) as other:
                _answers(other, promises)
    return f"exit code {code}"


def _two_at_once(promises: Promises) -> str:
    """Start two servers for one port at the same moment; return where they went."""
    with _taken(1) as port:
        pass
    servers = [Server(("--port", str(port))) for _ in range(2)]
    try:
        for server in servers:
            wait_for(lambda s=server: s.port or s.process.poll() is not None, "a server", 120.0)
        ports = [server.port for server in servers]
        lost = [server.lines[-1:] for server in servers if not server.port]
        promises.hold(not lost, f"of two started at once one ended with {lost}")
        promises.hold(len(set(ports)) == 2, "two servers share a port")
        for server in servers:
            if server.port:
                _answers(server, promises)
    finally:
        for server in servers:
            server.end()
    return "two started at once got two ports"


def take_port(quick: bool) -> Outcome:
    """Take the port that a server wants, all that it would try, and one at the same moment."""
    promises = Promises()
    said, code = _one_taken(promises), _all_taken(promises, quick)
    measured = f"one taken: “{said}”, and it answers there; {PORTS} in a row taken: {code}"
    if quick:
        return promises.outcome(f"once each: one port, {PORTS} ports", measured)
    often = f"once each: one port, {PORTS} ports, two servers at once"
    return promises.outcome(often, f"{measured}; {_two_at_once(promises)}")


def suspend(quick: bool) -> Outcome:
    """Suspend the whole process for a while."""
    promises, seconds = Promises(), 2.0 if quick else 10.0
    with served() as server, Follower(server.port) as live:
        live.wait(lambda: live.last[1] > 1.0, "a second of simulated time")
        os.kill(server.process.pid, signal.SIGSTOP)
        try:
            time.sleep(0.3)  # what is on its way arrives
            stood = live.last[1]
            time.sleep(seconds - 0.3)
            promises.hold(live.last[1] == stood, "frames came from a suspended server")
        finally:
            resumed = time.monotonic()
            os.kill(server.process.pid, signal.SIGCONT)
        ahead = 0.0
        while time.monotonic() < resumed + 1.5 and not live.closed:
            arrival, simulated = live.last
            if simulated > stood:
                ahead = max(ahead, (simulated - stood) - (arrival - resumed))
            time.sleep(0.002)
        promises.hold(not live.closed, "the client lost its connection")
        promises.hold(live.last[1] > stood + 1.0, "time doesn't go on")
        promises.hold(ahead < LONGEST + SLACK, f"time ran ahead of the wall by {ahead:.2f} s")
        told = [text for text in live.notices if "could not run" in text]
        promises.hold(len(told) == 1, f"the page was told {len(told)} times that it was suspended")
        promises.hold(not live.faults, f"the client got {live.faults[:1]}")
    measured = f"at most {ahead:.2f} s caught up; the client stayed connected"
    if told:
        measured += f"; the page was told: “{told[0]}”"
    return promises.outcome(f"once, SIGSTOP for {seconds:g} s", measured)


def _factor(live: Follower, seconds: float) -> float:
    """Listen for so long; return simulated seconds a second."""
    begin = live.last
    time.sleep(seconds)
    wall, simulated = (last - first for first, last in zip(begin, live.last, strict=True))
    return simulated / max(wall, 1e-9)


def turn_clock(quick: bool) -> Outcome:
    """Turn the clock on the wall while everything runs."""
    promises, factors = Promises(), []
    jumps = (DAY, -DAY) if quick else (3600.0, -3600.0, DAY, -DAY, 3e8, 0.0)
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "clock"
        path.write_text("0")
        arguments = {"module": jumping_clock.__name__, "environment": {VARIABLE: str(path)}}
        with served(**arguments) as server, Follower(server.port) as live:
            scene = ViserClient(server.port, "/scene")
            live.wait(lambda: live.last[1] > 0.5, "frames")
            for jump in jumps:
                spare = path.with_suffix(".new")
                spare.write_text(str(jump))
                spare.replace(path)
                count = scene.count
                factors.append(_factor(live, 1.0))
                promises.hold(scene.count > count, "the 3D scene stands still after a jump")
            with server.http() as http:
                patch = {"lanes": {"NFTSM": {"nu": 30.0}}}
                http.patch("/api/experiment", json=patch).raise_for_status()
                edit = http.get("/api/history").json()["edits"][-1]
            shown = edit["time"] - time.time()
            promises.hold(abs(shown - jumps[-1]) < 60.0, "the clock of the server never jumped")
            slowest, fastest = min(factors), max(factors)
            promises.hold(slowest > 0.5 and fastest < 1.5, f"pace {slowest:.2f} to {fastest:.2f}")
            promises.hold(not live.notices, f"the page was told {live.notices[:1]}")
            promises.hold(not live.closed and not live.faults, f"a client got {live.faults[:1]}")
            scene.close()
    measured = f"{slowest:.2f} to {fastest:.2f} simulated seconds per second; 3D continues"
    return promises.outcome(f"{len(jumps)} jumps of Python's time of day, up to years", measured)


FAULTS = (
    Fault(
        "port",
        "The port is taken",
        "The next free one and a message, or a clear error and a non-zero exit code",
        take_port,
    ),
    Fault(
        "suspend",
        "The process is suspended",
        f"At most {LONGEST:g} s are caught up; clients stay connected; the page says what happened",
        suspend,
    ),
    Fault(
        "clock", "The system clock jumps", "No effect: pace, clients and 3D continue", turn_clock
    ),
)
