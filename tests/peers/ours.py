"""The closed loop through this project's own ``simulate``."""

from __future__ import annotations

from typing import Literal

import pinocchio as pin

from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.version import __version__
from tests.peers.problem import SAMPLE, Array, MassAndBias, Problem, Run, Trace, Variant

LANE = "RBFNN-NFTSM"


def mass_and_bias(problem: Problem) -> MassAndBias:
    """Return M and h as ``robot.loop.steps`` takes them: views that Pinocchio refills."""
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


VARIANTS = (
    Variant("`simulate`", "plain", _plain),
    Variant("`simulate`", "extrapolated", _extrapolated),
)
VERSION = f"Slidetune {__version__}"
