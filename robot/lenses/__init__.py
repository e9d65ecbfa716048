"""Lenses: a lane's whole run, looked at so that it explains itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import Packed, pack
from slidetune.robot.lenses import chattering, network_view, prediction, sliding_mode
from slidetune.robot.lenses.screen import document
from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import LaneRun, simulate

Array = np.ndarray
Lens = Callable[[Packed, str, LaneRun, LaneRun | None], Any]

LENSES: dict[str, Lens] = {
    "sliding": sliding_mode.look,
    "network": network_view.look,
    "chattering": chattering.look,
    "prediction": prediction.look,
}
"""Every lens by name; each returns a dataclass of arrays, or ``None`` where it has no object."""

NOISY = frozenset({"sliding", "chattering", "prediction"})
"""Lenses that also look at a run without sensor noise."""


def only_known_lane(experiment: Experiment, lane: str) -> Experiment:
    """Return the experiment with one of its lanes alone.

    Raises:
        InvalidExperimentError: if there is no such lane; lists the known ones.
    """
    experiment.lane(lane)
    return only_lane(experiment, lane)


def without_sensor_noise(experiment: Experiment) -> Experiment | None:
    """Return the experiment with exact sensors, ``None`` where it has them already."""
    noise = experiment.disturbance.sensor_noise
    if not np.any(noise.position) and not np.any(noise.velocity):
        return None
    quiet = {"sensor_noise": {"position": 0.0, "velocity": 0.0}}
    return experiment.patched({"disturbance": quiet})


def look_through(
    experiment: Experiment,
    lane: str,
    lenses: Sequence[str] = tuple(LENSES),
    stop: Array | None = None,
) -> dict[str, Any]:
    """Run one lane over its horizon and look at it through some lenses.

    Args:
        experiment: what to run.
        lane: which lane.
        lenses: which of ``LENSES``.
        stop: once another thread has set it, the run stops; see ``simulate``.

    Returns:
        Plain JSON values: ``horizon`` [s], ``frozen`` (time, joint, cause, or ``None``), and what
        each lens saw under its name.

    Raises:
        InvalidExperimentError: if there is no such lane, or the arm can't follow the trajectory.
        CancelledError: if ``stop`` was set.
    """
    alone = only_known_lane(experiment, lane)
    run = simulate(alone, stop=stop, estimate=False).lanes[lane]
    # What is left of restlessness without noise is the loop's own: a second run tells them apart.
    calm = without_sensor_noise(alone) if NOISY & set(lenses) else None
    quiet = None
    if calm is not None:
        quiet = simulate(calm, stop=stop, estimate=False).lanes[lane]
    packed, freeze = pack(alone), run.freeze
    frozen = freeze.document() if freeze is not None else None
    seen = {name: document(LENSES[name](packed, lane, run, quiet)) for name in lenses}
    return {"horizon": alone.simulation.horizon, "frozen": frozen, **seen}
