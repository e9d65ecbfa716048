"""Faults of studies: the server is killed while one runs, again and again."""

from __future__ import annotations

import json
import random
import tempfile
import time
from typing import Any

import httpx

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.study import Study
from slidetune.server.compute.executor import local_executor
from tests.trust.faults.fault import Fault, Outcome, Promises
from tests.trust.faults.server import served, wait_for

KILLS = 20
PATIENCE = 600.0
EXPERIMENT: dict[str, Any] = {
    "lanes": {"A": {"law": "rbfnn_nftsm"}},
    "simulation": {"horizon": 5.0},
    "goals": {"near": {"kind": "figure", "figure": "mae", "bound": 0.001}},
    "uncertainty": {"payload": [0.0, 2.0]},
}


def kill_studies(quick: bool) -> Outcome:
    """Kill the server while a search runs, at random moments, and let it come to its end."""
    promises, dice, kills = Promises(), random.Random(7), 2 if quick else KILLS
    trials = 40 if quick else 400
    wanted = {"lane": "A", "trials": trials, "draws": 2}
    counts = []
    with tempfile.TemporaryDirectory() as folder:
        environment = {"SLIDETUNE_STUDIES": folder, "SLIDETUNE_PRESETS": folder}
        number = 0
        for kill in range(kills):
            with served(environment=environment) as server, server.http() as http:
                if not number:
                    body = {"kind": "tune", "wanted": wanted, "experiment": EXPERIMENT}
                    number = http.post("/api/studies", json=body).raise_for_status().json()["id"]
                begin = _made(http, number)
                promises.hold(begin >= (counts or [0])[-1], "entries that were told are gone")
                # Every life gets a little further, and something is left for the last.
                _wait(http, number, min(begin + 1, trials - kills + kill))
                time.sleep(dice.uniform(0.0, 0.3))
                counts.append(_made(http, number))
                server.process.kill()
                server.process.wait()
        with served(environment=environment) as server, server.http() as http:
            wait_for(lambda: _ended(http, number), "the end of the search", PATIENCE)
            found = http.get(f"/api/studies/{number}").json()
            entries = http.get(f"/api/studies/{number}/entries").json()["entries"]
            promises.hold(found["state"] == "done", f"it ended as {found['state']}")
            promises.hold(not server.complaints, f"the server wrote: {server.complaints[:1]}")
    numbers = [entry["number"] for entry in entries]
    promises.hold(numbers == list(range(trials)), f"{len(numbers)} trials of {trials}")
    study = Study.from_document("tune", Experiment.from_document(EXPERIMENT), wanted)
    with local_executor() as executor:
        whole = [json.loads(json.dumps(one.document())) for one in study.entries(executor)]
    promises.hold(entries == whole, "it came to other trials than without a kill")
    measured = (
        f"{trials} trials, each once, the same as in one go; killed after "
        f"{', '.join(map(str, counts))} of them"
    )
    return promises.outcome(f"{kills} kills of the server during one search", measured)


def _made(http: httpx.Client, number: int) -> int:
    return int(http.get(f"/api/studies/{number}").raise_for_status().json()["made"])


def _wait(http: httpx.Client, number: int, made: int) -> None:
    wait_for(lambda: _made(http, number) >= made, f"{made} trials", PATIENCE)


def _ended(http: httpx.Client, number: int) -> bool:
    state = http.get(f"/api/studies/{number}").raise_for_status().json()["state"]
    return state not in ("waiting", "running")


FAULTS = (
    Fault(
        "kill-study",
        "kill -9 of the server while a search for gains runs",
        "The next server goes on with it; every trial is there once, and is the one that it would "
        "have been without the kill",
        kill_studies,
    ),
)
