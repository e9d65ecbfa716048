"""Compiles every kernel before it is needed, with progress: the first time takes a minute."""

from __future__ import annotations

from collections.abc import Callable

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.kernels.compiler import mark_warm
from slidetune.robot.laws import LAWS
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.margins.margin import loop_margin

Progress = Callable[[int, int, str], None]


def _experiment(law: str, mode: str) -> Experiment:
    simulation = {"mode": mode, "horizon": 0.1, "step": 0.005, "control_rate": 200.0}
    return Experiment.from_document({"lanes": {"A": {"law": law}}, "simulation": simulation})


def warm_up(progress: Progress | None = None) -> None:
    """Run every law once in both modes, so that all kernels are compiled and loaded.

    Args:
        progress: called before each part with its number, how many there are, and its name.
    """
    parts = [(law, mode) for law in LAWS for mode in ("continuous", "sampled")]
    for number, (law, mode) in enumerate(parts):
        if progress is not None:
            progress(number, len(parts), f"{LAWS[law].title}, {mode}")
        experiment = _experiment(law, mode)
        simulate(experiment, estimate=False)
        loop_margin(pack(experiment), "A")
    mark_warm()
    if progress is not None:
        progress(len(parts), len(parts), "")
