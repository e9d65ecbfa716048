"""The closed loop through this project's own ``simulate``."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Literal

import pinocchio as pin

from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.version import __version__
from tests.peers.problem import (
    BATCH,
    SAMPLE,
    THREADS,
    Array,
    MassAndBias,
    Problem,
    Run,
    Trace,
    Variant,
)

LANE = "RBFNN-NFTSM"


def mass_and_bias(problem: Problem) -> MassAndBias:
    """Return M and h as the live session takes them: views that Pinocchio refills."""
    model = pin.buildModelFromUrdf(problem.urdf)
    data = model.createData()
    crba, bias = pin.crba, pin.nonLinearEffects
    M, h = data.M.T, data.nle

    def evaluate(q: Array, v: Array) -> tuple[Array, Array]:
        crba(model, data, q)
        bias(model, data, q, v)
        return M, h

    return evaluate


def _prepare(problem: Problem, steps: int, scheme: Literal["plain", "extrapolated"]) -> Run:
    preset = load_preset(problem.preset)
    others = dict.fromkeys(set(preset.lanes) - {LANE})
    settings = {"horizon": steps * problem.h, "scheme": scheme}
    experiment = preset.patched({"lanes": others, "simulation": settings})

    def run() -> Trace:
        lane = simulate(experiment, estimate=False).lanes[LANE]
        return Trace(lane.q[::SAMPLE], None if lane.freeze is None else lane.freeze.time)

    return run


def _plain(problem: Problem, steps: int) -> Run:
    return _prepare(problem, steps, "plain")


def _extrapolated(problem: Problem, steps: int) -> Run:
    return _prepare(problem, steps, "extrapolated")


def _many(run: Run) -> Run:
    """Return the whole batch: every run is a ``simulate`` of its own, from its document on."""

    def batch() -> Trace:
        with ThreadPoolExecutor(THREADS) as pool:
            *_, last = pool.map(lambda _: run(), range(BATCH))
        return last

    return batch


def _many_plain(problem: Problem, steps: int) -> Run:
    return _many(_plain(problem, steps))


def _many_extrapolated(problem: Problem, steps: int) -> Run:
    return _many(_extrapolated(problem, steps))


VARIANTS = (
    Variant("`simulate`", "plain", _plain),
    Variant("`simulate`", "extrapolated", _extrapolated),
)
BATCHES = (
    Variant("`simulate`", "plain", _many_plain),
    Variant("`simulate`", "extrapolated", _many_extrapolated),
)
VERSION = f"Slidetune {__version__}"
