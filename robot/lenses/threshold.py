"""The boundary layers from which on a lane is silent, of its numbers alone: without a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.lenses.instants import (
    along,
    balance_at,
    common_threshold,
    silent_from,
    thresholds_of,
)
from slidetune.robot.lenses.prediction import MEASURED
from slidetune.robot.lenses.screen import document
from slidetune.robot.loop.response import only_lane
from slidetune.robot.margins.plain_lane import switches

Array = np.ndarray


@dataclass(frozen=True)
class Threshold:
    """Layers in [rad/s] of the prediction lens.

    Attributes:
        common: one for all joints, ``None`` where none silences them or there is no limit cycle.
        joints: one for each, those that lock widened together, ``None`` as above. Six where the
            lane has a layer for each, else none: they take ten times as long.
    """

    common: float | None
    joints: tuple[float | None, ...]


def threshold_of(experiment: Experiment, name: str, stop: Array | None = None) -> dict[str, Any]:
    """Return a lane's threshold under ``threshold``, as the prediction lens has it of its run.

    Args:
        experiment: what it is part of.
        name: the lane.
        stop: is not looked at: it takes less than a run.

    Returns:
        Plain JSON values; ``threshold`` is ``None`` where nothing switches, where the law has no
        layer, and where its gain is one that only a run tells.

    Raises:
        InvalidExperimentError: if there is no such lane; lists the known ones.
    """
    experiment.lane(name)
    lane = experiment.lanes[name]
    packed = pack(only_lane(experiment, name))
    # Adaptation ends somewhere in the run.
    if not hasattr(lane, "epsilon") or lane.law == "adaptive_smc" or not switches(packed, name):
        return {"threshold": None}
    period = experiment.simulation.row_period
    rows = round(experiment.simulation.horizon / period) + 1
    first = int(rows * (1.0 - MEASURED))
    times = [row * period for row in along(packed, first, rows - 1, still=True)]
    if isinstance(lane.epsilon, tuple):
        instants = [balance_at(packed, name, time, how_far=False) for time in times]
        joints = tuple(thresholds_of(name, instants))
        return {"threshold": document(Threshold(common_threshold(name, instants), joints))}
    layers, swings = zip(*(silent_from(packed, name, time) for time in times), strict=True)
    known = [layer for layer in layers if layer is not None]
    common = max(known) if any(swings) and len(known) == len(times) else None
    return {"threshold": document(Threshold(common, ()))}
