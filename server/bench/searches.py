"""Searches for gains and draws: beside the same runs without the machinery, and on two threads."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from time import perf_counter, process_time
from typing import Any

import httpx
import optuna

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.study.robustness import robustness
from slidetune.robot.study.search_space import patch_of, search_space
from slidetune.robot.study.tune import tune
from slidetune.robot.study.tuning import Tuning
from slidetune.server.bench.result import Measurement, measurement
from slidetune.server.bench.rounds import Case, measured
from slidetune.server.bench.runs import COMPARISON, CORES, cores
from slidetune.server.compute.executor import local_executor

LANE = "RBFNN-NFTSM"
TRIALS, DRAWS = 200, 200
FACTOR = "lowest real-time factor while a study has all threads, 3 lanes at 1 kHz"


def experiment(horizon: float) -> Experiment:
    """Return the paper's lanes with a goal to search for and a payload that is not known."""
    return Experiment.from_document(
        {
            "lanes": COMPARISON,
            "simulation": {"horizon": horizon},
            "goals": {"near": {"kind": "figure", "figure": "mae", "bound": 0.005}},
            "uncertainty": {"payload": [0.0, 2.0]},
        }
    )


def search_cases(horizon: float, trials: int, draws: int) -> list[Case]:
    """Return the cases of searches and draws.

    Args:
        horizon: of every run in [s].
        trials: of a search.
        draws: how many.
    """
    whole = experiment(horizon)
    tuning = Tuning(lane=LANE, trials=trials)
    lane = only_lane(whole, LANE)
    with local_executor(CORES) as executor:
        tried = [one.patch for one in tune(whole, tuning, executor)]
    variants = [lane.patched(patch) for patch in tried]

    def search(workers: int, clock: Callable[[], float]) -> Callable[[], float]:
        return _timed(workers, clock, lambda pool: sum(1 for _ in tune(whole, tuning, pool)))

    def bare() -> float:
        """Make the runs of the search and nothing else."""
        begin = process_time()
        for variant in variants:
            simulate(variant, estimate=False)
        return process_time() - begin

    def drawn() -> Callable[[], float]:
        return _timed(
            CORES, perf_counter, lambda pool: sum(1 for _ in robustness(whole, LANE, draws, pool))
        )

    enough = cores() >= CORES
    note = "" if enough else "only one core here"
    runs = f"{trials} runs of {horizon:g} s"
    floor, one = f"{runs} through simulate() alone, processor time", "the same with one thread"
    machinery = f"a search that makes them: tune(), {trials} trials, processor time"
    two = f"the same search, {CORES} threads"
    rate = "runs a second and core through a search"
    return [
        Case(floor, "s", bare),
        Case(machinery, "s", search(1, process_time), floor=floor, most=1.15),
        Case("the same written by hand with Optuna", "s", _by_hand(whole, tuning), floor=floor),
        Case(one, "s", search(1, perf_counter)),
        Case(two, "s", search(CORES, perf_counter), 6.0 if enough else None, one, 0.556, note=note),
        Case(rate, "Hz", lambda: trials / search(1, process_time)(), 40.0, limit="at least"),
        Case(f"{draws} draws, {CORES} threads", "s", drawn(), 4.0 if enough else None, note=note),
    ]


def _timed(
    workers: int, clock: Callable[[], float], work: Callable[[Executor], int]
) -> Callable[[], float]:
    def measure() -> float:
        with local_executor(workers) as executor:
            begin = clock()
            work(executor)
            return clock() - begin

    return measure


def _by_hand(whole: Experiment, tuning: Tuning) -> Callable[[], float]:
    """Return a search as one writes it with Optuna on ``simulate()``."""
    space = search_space(whole, tuning)
    lane = only_lane(whole, LANE)

    def objective(trial: optuna.Trial) -> float:
        values = {
            one.name: trial.suggest_float(one.name, one.low, one.high, log=one.logarithmic)
            for one in space
        }
        run = simulate(lane.patched(patch_of(LANE, space, values)), estimate=False).lanes[LANE]
        return 1e6 if run.freeze else float(run.metrics.mae.mean())

    def measure() -> float:
        sampler = optuna.samplers.TPESampler(seed=tuning.seed, multivariate=True)
        study = optuna.create_study(sampler=sampler)
        begin = process_time()
        study.optimize(objective, n_trials=tuning.trials)
        return process_time() - begin

    return measure


def measure_searches(quick: bool, progress: Callable[[float], None]) -> list[Measurement]:
    """Time searches and draws and return their rows."""
    cases = search_cases(0.5, 16, 16) if quick else search_cases(10.0, TRIALS, DRAWS)
    return measured(cases, 1 if quick else 3, progress)


@contextmanager
def own_studies() -> Iterator[dict[str, str]]:
    """Give an environment in which a server keeps its studies apart from the user's."""
    with tempfile.TemporaryDirectory() as folder:
        yield {"SLIDETUNE_STUDIES": folder}


def measure_beside(port: int, quick: bool) -> list[Measurement]:
    """Let a running server make a study; return the least real-time factor meanwhile.

    Args:
        port: TCP port of the server on 127.0.0.1.
        quick: short, for a look instead of a verdict.
    """
    seconds = 2.0 if quick else 20.0
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=120.0) as client:
        wanted: dict[str, Any] = {"uncertainty": {"payload": [0.0, 2.0]}}
        client.patch("/api/experiment", json=wanted).raise_for_status()
        body = {"kind": "robustness", "wanted": {"lane": LANE, "draws": 2000}}
        number = client.post("/api/studies", json=body).raise_for_status().json()["id"]
        factors: list[float] = []
        begin = perf_counter()
        while (passed := perf_counter() - begin) < seconds:
            time.sleep(0.2)
            if passed > 1.5:
                factors.append(client.get("/api/session").json()["real_time_factor"])
        made = client.get(f"/api/studies/{number}").json()["made"]
        client.delete(f"/api/studies/{number}").raise_for_status()
    note = f"{made / passed:.0f} runs a second meanwhile"
    return [_least(factors, note)]


def _least(factors: Sequence[float], note: str) -> Measurement:
    least = min(factors, default=float("nan"))
    return measurement(FACTOR, "", [least], target=0.99, limit="at least", note=note)
