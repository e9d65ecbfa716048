"""The closed loop in NumPy on Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from tests.peers.numpy_loop import extrapolated, plain
from tests.peers.problem import Array, MassAndBias, Problem, Run, Variant


def mass_and_bias(problem: Problem) -> MassAndBias:
    """Return M and h by crba, whose lower half stays empty, and nonLinearEffects."""
    model = pin.buildModelFromUrdf(problem.urdf)
    data = model.createData()
    below = np.tril_indices(model.nv, -1)
    above = below[::-1]

    def evaluate(q: Array, v: Array) -> tuple[Array, Array]:
        M = pin.crba(model, data, q)
        M[below] = M[above]
        return M, pin.nonLinearEffects(model, data, q, v)

    return evaluate


def _plain(problem: Problem, steps: int) -> Run:
    return plain(problem, steps, mass_and_bias(problem))


def _extrapolated(problem: Problem, steps: int) -> Run:
    return extrapolated(problem, steps, mass_and_bias(problem))


VARIANTS = (
    Variant("NumPy on `crba`, `nonLinearEffects`", "plain", _plain),
    Variant("NumPy on `crba`, `nonLinearEffects`", "extrapolated", _extrapolated),
)
VERSION = f"Pinocchio {pin.__version__}"
