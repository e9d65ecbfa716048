"""The control step inside a compiled horizon: processor time of ``simulate()``, all of it counted.

M and h come from the compiled recursion there; ``stepped`` has the same steps over Pinocchio.
"""

from __future__ import annotations

from collections.abc import Callable
from time import thread_time
from typing import Any

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.laws import LAWS
from slidetune.server.bench.result import Measurement
from slidetune.server.bench.rounds import Case, measured
from slidetune.server.bench.runs import finished, run_cases
from slidetune.server.bench.stepped import (
    FLOOR,
    FLOOR_TWICE,
    LAW,
    MICROSECOND,
    SAMPLED,
    Timing,
    stepped_cases,
)

LOOPS = 10_000
"""Calls timed at once (*ours*)."""
PLAIN_STEP = "plain step, RBFNN-NFTSM"
ESTIMATED_STEP = "extrapolated step, RBFNN-NFTSM, with the run that estimates the error"
MODEL_BASED, NETWORK = 1.8, 2.0
"""Targets of an extrapolated step in [µs]: of a law that knows the arm, of one that learns it."""
MISMATCH = 0.8
"""Ratio of the nominal masses to the true ones where they differ (*ours*)."""


def _step(document: dict[str, Any], horizon: float, estimate: bool = False) -> Timing:
    """Return the timing of a step of one lane in ``simulate``, by default without its estimate."""
    settings = {"horizon": horizon, **document["simulation"]}
    experiment = Experiment.from_document({**document, "simulation": settings})
    steps = experiment.simulation.rows * len(experiment.lanes)

    def measure() -> float:
        begin = thread_time()
        finished(experiment, estimate)
        return (thread_time() - begin) / steps / MICROSECOND

    return measure


def _law(law: str, scheme: str, horizon: float, estimate: bool = False, **more: Any) -> Timing:
    lanes, simulation = {"A": {"law": law}}, {"scheme": scheme}
    return _step({"lanes": lanes, "simulation": simulation, **more}, horizon, estimate)


def step_cases(quick: bool) -> list[Case]:
    """Return everything to time, the floor first.

    Args:
        quick: short horizons and few calls, for a look instead of a verdict.
    """
    horizon, loops = (0.2, 200) if quick else (10.0, LOOPS)
    cases = [
        *stepped_cases(horizon, loops),
        # Before the others: it fetches the memory that they find, which a step is not to pay for.
        Case(
            ESTIMATED_STEP,
            "µs",
            _law(LAW, "extrapolated", horizon, estimate=True),
            floor=FLOOR_TWICE,
        ),
        Case(PLAIN_STEP, "µs", _law(LAW, "plain", horizon), 1.0, FLOOR),
    ]
    for name, law in LAWS.items():
        target = MODEL_BASED if law.model_based else NETWORK
        measure = _law(name, "extrapolated", horizon)
        cases.append(Case(f"extrapolated step, {law.title}", "µs", measure, target, FLOOR_TWICE))
    other = _law("nftsm", "extrapolated", horizon, disturbance={"nominal_mismatch": MISMATCH})
    return [
        *cases,
        Case("extrapolated step, NFTSM, another nominal arm", "µs", other, 2.6, FLOOR_TWICE),
        Case("sampled period of 10 steps of the arm", "µs", _step(SAMPLED, horizon), 5.0, FLOOR),
        *run_cases(horizon, 2 if quick else 24),
    ]


def measure_steps(quick: bool, progress: Callable[[float], None]) -> list[Measurement]:
    """Time steps and whole runs and return their rows."""
    return measured(step_cases(quick), 2 if quick else 9, progress)
