"""One variant of an experiment, run and summed up in a few figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.figures import FIGURES, STUDIED
from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import simulate

Array = np.ndarray

LIMIT_CYCLE = 1000.0
"""Total variation of the torque [N m/s] per joint above which a lane counts as chattering hard
(*ours*: smooth runs of the shipped presets stay below 300 for all joints together)."""


def figures(
    experiment: Experiment, lane: str, patch: Mapping[str, Any], stop: Array | None = None
) -> dict[str, Any]:
    """Run one lane of a patched experiment, without an estimate of its error.

    Args:
        experiment: where to start from.
        lane: the lane that counts.
        patch: the change; see ``Experiment.patched``.
        stop: once another thread has set it, the run stops; see ``simulate``.

    Returns:
        One number for each of ``STUDIED``, ``state`` (``good``, ``chattering``, ``diverged`` or
        ``refused``) and ``reason``; the figures are ``None`` where there is no run to speak of.

    Raises:
        CancelledError: if ``stop`` was set.
    """
    nothing: dict[str, Any] = dict.fromkeys(STUDIED)
    try:
        variant = only_lane(experiment.patched(patch), lane)
        result = simulate(variant, stop=stop, estimate=False).lanes[lane]
    except InvalidExperimentError as error:
        return {**nothing, "state": "refused", "reason": str(error)}
    if result.freeze is not None:
        return {**nothing, "state": "diverged", "reason": result.freeze.cause}
    metrics = result.metrics
    hard = metrics.chattering > LIMIT_CYCLE * 6
    return {
        **{name: FIGURES[name].overall(getattr(metrics, name)) for name in STUDIED},
        "state": "chattering" if hard else "good",
        "reason": "",
    }
