"""OpenSMC's laws on its own arm, by its own simulator: ``python -m … SECONDS FILE``.

It runs where OpenSMC is installed, and writes every run to one file of NumPy's.
"""

from __future__ import annotations

import sys
from importlib.metadata import version
from typing import Any

import numpy as np
from opensmc import controllers, reaching, surfaces
from opensmc.core import Controller
from opensmc.plants import TwoLinkArm
from opensmc.simulator import Simulator

from tests.peers.opensmc.pairs import PAIRS, Pair, Part
from tests.peers.opensmc.tasks import STEP, TASKS, Array, Task, push

_PER_JOINT = ((0, 1), (2, 3))
"""Where its state holds angle and velocity of a joint."""


def _made(module: Any, part: Part | None) -> Any:
    return None if part is None else getattr(module, part[0])(**part[1])


class BothJoints(Controller):
    """One of OpenSMC's controllers at each joint, and the torque that they ask for together."""

    def __init__(self, pair: Pair, task: Task) -> None:
        super().__init__()
        self._pair, self._task = pair, task
        self._joints = [self._controller(pair) for _ in _PER_JOINT]

    @staticmethod
    def _controller(pair: Pair) -> Any:
        name, gains = pair.theirs
        parts = {
            "surface": _made(surfaces, pair.surface),
            "reaching": _made(reaching, pair.reaching),
        }
        given = {key: part for key, part in parts.items() if part is not None}
        return getattr(controllers, name)(**gains, **given)

    def compute(
        self, t: float, x: Array, xref: Array, plant: Any = None, **_: Any
    ) -> tuple[Array, dict[str, Any]]:
        ahead = self._task.desired(t)[2]
        answers = [
            one.compute(t, x[[q, v]], xref[[q, v]], xref_ddot=ahead[j])
            for j, ((q, v), one) in enumerate(zip(_PER_JOINT, self._joints, strict=True))
        ]
        asked = np.array([u for u, _ in answers])
        if self._pair.made == "torque":
            return asked, {}
        beside = np.zeros(2)
        if self._pair.made == "parts":
            asked = np.array([info["u_eq"] for _, info in answers])
            beside = np.array([info["u_rob"] for _, info in answers])
        if self._pair.ahead:
            asked = asked + ahead
        q1, v1, q2, v2 = x
        bias = plant.coriolis_vector(q1, q2, v1, v2) + plant.gravity_vector(q1, q2)
        return plant.mass_matrix(q1, q2) @ asked + bias + beside, {}

    def reset(self) -> None:
        for one in self._joints:
            one.reset()


def run(pair: Pair, task: Task, seconds: float) -> Array:
    """Return angles, velocities and torques at every step. Shape (n + 1, 6)."""
    order = [0, 2, 1, 3]

    def pushed(t: float) -> Array:
        first, second = push(t)
        return np.array([0.0, first, 0.0, second])

    found = Simulator(dt=STEP, T=seconds, method="rk4").run(
        BothJoints(pair, task),
        TwoLinkArm(),
        ref_fn=lambda t: task.desired(t)[:2].T.ravel(),
        dist_fn=pushed,
        x0=np.array([task.q0, task.v0]).T.ravel(),
    )
    return np.hstack([found["x"][:, order], found["u"]])


def main(seconds: float, file: str) -> None:
    """Run all of them; the key of a run is its pair and its task."""
    runs = {
        f"{name}|{key}": run(pair, TASKS[key], seconds)
        for name, pair in PAIRS.items()
        for key in pair.tasks
    }
    np.savez(file, version=version("opensmc"), **runs)


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2])
