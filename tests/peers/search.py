"""``make peers``: the same search for gains through ``tune`` and by hand on another simulator."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from time import process_time
from typing import Annotated, Any

import numpy as np
import optuna
import typer
from optuna.distributions import BaseDistribution, FloatDistribution
from rich.console import Console

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.response import only_lane
from slidetune.robot.study.samplers import BATCH, sampler
from slidetune.robot.study.search_space import patch_of, search_space
from slidetune.robot.study.tune import tune
from slidetune.robot.study.tuning import Tuning
from slidetune.server.compute.executor import local_executor
from slidetune.server.report.run_bar import progress_bar
from tests.peers.contest import PROBE, Worker
from tests.peers.environments import PEERS, UnavailablePeerError
from tests.peers.ours import LANE
from tests.peers.preset_problem import problem_of
from tests.peers.problem import SAMPLE, Problem
from tests.trust.report import provenance, record, table

PRESET = "paper"
GAINS = ("nu", "c", "mu", "k1", "k2", "epsilon", "learning_rate")
"""Gains that the peers' controller has too; each from a tenth of its value to ten times."""
TRIALS = 64
LOST = 1e6
"""Cost of a run that left its bounds, less the time until then in [s] (*ours*)."""
HEADINGS = ("search", "scheme", "runs a second and core", "ours / this", "best mean error [rad]")
ERROR = "mae"

Ask = Callable[[Problem, int], dict[str, Any]]


@dataclass(frozen=True)
class Found:
    """What a search came to.

    Attributes:
        values: of each trial, by name of the gain.
        errors: mean error of each trial in [rad]; ``LOST`` or nearly where it left its bounds.
        seconds: processor time of it all.
    """

    values: list[dict[str, float]]
    errors: list[float]
    seconds: float


def searched(scheme: str, horizon: float) -> Experiment:
    """Return the lane whose gains are searched, with a goal that the mean error alone decides."""
    goals = {"near": {"kind": "figure", "figure": ERROR, "bound": 0.005}}
    settings = {"scheme": scheme, "horizon": horizon}
    whole = load_preset(PRESET).patched({"goals": goals, "simulation": settings})
    return only_lane(whole, LANE)


def wanted(experiment: Experiment, trials: int) -> Tuning:
    """Return what both searches are told."""
    whole = search_space(experiment, Tuning(lane=LANE))
    gains = {one.name: {"low": one.low, "high": one.high} for one in whole if one.name in GAINS}
    told = {"lane": LANE, "gains": gains, "sampler": "tpe", "trials": trials, "quiet": False}
    return Tuning.model_validate(told)


def by_tune(experiment: Experiment, trials: int) -> Found:
    """Search through ``tune``, on one thread."""
    with local_executor(1) as executor:
        begin = process_time()
        made = list(tune(experiment, wanted(experiment, trials), executor))
        seconds = process_time() - begin
    errors = [one.outcome.figures[ERROR] for one in made]
    plain = [LOST if error is None else error for error in errors]
    return Found([one.values for one in made], plain, seconds)


def by_hand(experiment: Experiment, trials: int, ask: Ask) -> Found:
    """Search as one writes it with Optuna, in batches as ``tune`` does.

    Args:
        experiment: what to search.
        trials: how many.
        ask: runs a problem for so many steps; returns ``q``, ``diverged`` and ``seconds``.
    """
    tuning = wanted(experiment, trials)
    space, steps = search_space(experiment, tuning), experiment.simulation.rows - 1
    ranges: dict[str, BaseDistribution] = {
        one.name: FloatDistribution(one.low, one.high, log=one.logarithmic) for one in space
    }
    study = optuna.create_study(sampler=sampler(tuning.sampler, tuning.seed))
    study.enqueue_trial({one.name: one.begin for one in space})
    found, errors, seconds = list[dict[str, float]](), list[float](), 0.0
    for first in (0, *range(1, trials, BATCH)):  # the present gains alone, as ``tune`` has it
        begin = process_time()
        count = min(BATCH, trials - first) if first else 1
        asked = [study.ask(ranges) for _ in range(count)]
        batch = [
            {one.name: one.rounded(trial.params[one.name]) for one in space} for trial in asked
        ]
        variants = [experiment.patched(patch_of(LANE, space, values)) for values in batch]
        seconds += process_time() - begin
        for variant in variants:
            problem = problem_of(variant, PRESET)
            answer = ask(problem, steps)
            errors.append(_error(problem, answer))
            seconds += answer["seconds"]
        begin = process_time()
        for trial, error in zip(asked, errors[first:], strict=True):
            study.tell(trial, error)
        seconds += process_time() - begin
        found += batch
    return Found(found, errors, seconds)


def _error(problem: Problem, answer: dict[str, Any]) -> float:
    if answer["diverged"] is not None:
        return LOST - float(answer["diverged"])
    q = np.array(answer["q"])
    t = problem.h * SAMPLE * np.arange(len(q))[:, None]
    return float(np.abs(problem.amplitude * np.sin(problem.omega * t) - q).mean())


def _fastest(search: Callable[[], Found], rounds: int) -> Found:
    return min((search() for _ in range(rounds)), key=lambda found: found.seconds)


def _on_mujoco(
    trials: int, seconds: float, rounds: int, show: Callable[[float], None]
) -> tuple[str, list[tuple[str, Found]]]:
    """Return MuJoCo's version, and each of its ways that follow with what it found."""
    peer = next(one for one in PEERS if one.name == "mujoco")
    experiment, made = searched("plain", seconds), list[tuple[str, Found]]()
    with closing(Worker(peer)) as worker:
        ways = [
            (number, name)
            for number, (name, scheme) in enumerate(worker.variants)
            if scheme == "plain"
        ]
        for place, (number, name) in enumerate(ways):
            worker.ask(problem_of(experiment, PRESET), number, PROBE)

            def ask(problem: Problem, steps: int, number: int = number) -> dict[str, Any]:
                return worker.ask(problem, number, steps)

            made.append((name, _fastest(lambda ask=ask: by_hand(experiment, trials, ask), rounds)))
            show((place + 1) / len(ways))
    return worker.version, made


def _row(name: str, scheme: str, found: Found, ours: Found) -> list[str]:
    count = len(found.errors)
    times = "1" if found is ours else f"{found.seconds / ours.seconds:.2g}"
    rate = f"{count / found.seconds:.3g}"
    return [name, scheme, rate, times, f"{min(found.errors):.3e}"]


def main(
    quick: Annotated[bool, typer.Option(help="A look instead of figures: 1 s, 8 trials.")] = False,
    write: Annotated[
        bool, typer.Option("--record", help="Write the table into docs/performance.md.")
    ] = False,
    seconds: Annotated[float, typer.Option(min=0.1, max=10.0, help="Length of a run.")] = 10.0,
    trials: Annotated[int, typer.Option(min=1, help="Sets of gains.")] = TRIALS,
    rounds: Annotated[int, typer.Option(min=1, help="Searches of each; the fastest counts.")] = 1,
) -> None:
    """Search for the same gains here and, by hand with Optuna, on MuJoCo."""
    console = Console()
    if quick:
        seconds, trials, rounds = min(seconds, 1.0), 8, 1
    schemes = ("plain", "extrapolated")
    for scheme in schemes:
        by_tune(searched(scheme, 0.1), 2)
    ours = {
        scheme: _fastest(lambda scheme=scheme: by_tune(searched(scheme, seconds), trials), rounds)
        for scheme in schemes
    }
    rows = [_row("Slidetune: `tune`", scheme, ours[scheme], ours[scheme]) for scheme in schemes]
    notes = []
    try:
        with progress_bar(console, f"The same search on MuJoCo, {trials} trials") as show:
            version, made = _on_mujoco(trials, seconds, rounds, show)
        for name, found in made:
            rows.append(_row(f"{version}: Optuna by hand on {name}", "plain", found, ours["plain"]))
            pairs = zip(found.values, ours["plain"].values, strict=True)
            same = sum(one == other for one, other in pairs)
            notes.append(f"{name}: {same} of {trials} sets of gains are those of `tune`.")
    except UnavailablePeerError as error:
        notes.append(f"MuJoCo is skipped: {error}.")
    about = f"{trials} runs of {seconds:g} s; of searches the fastest of {rounds}."
    options = f"--seconds {seconds:g} --trials {trials} --rounds {rounds}"
    command = f"python -m tests.peers.search {options}"
    body = "\n\n".join([table(HEADINGS, rows), " ".join([about, *notes]), provenance(command)])
    console.print(body, markup=False, soft_wrap=True)
    if write:
        record("performance.md", "search", body)


if __name__ == "__main__":
    typer.run(main)
