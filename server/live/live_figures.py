"""The figures of every lane of the live session, and since when they count.

A lane counts since the last change of its closed loop, so that no figure mixes old and new gains;
where there was none, since it began. Another name is no change, and neither is a kick, whose effect
is what one wants to see.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import floor
from typing import Any

import numpy as np

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.server.live.running_metrics import RunningMetrics
from slidetune.server.live.telemetry import Channel

Array = np.ndarray

ROUNDING = 1e-6
"""Part of a row by which its time may be off (*ours*)."""
_SHARED = ("robot", "trajectory", "disturbance", "simulation")
"""Sections that belong to every lane's closed loop."""
_WHOLE = {"horizon": 0.0, "high_frequency": 0.0}
"""Fields of whole runs: the live session has no end, and takes no spectrum."""


class LiveFigures:
    """The figures of all lanes; touched by the session's thread alone.

    Attributes:
        lanes: the figures by lane; another mapping after a change of lanes.
    """

    def __init__(self, columns: list[Channel], names: list[str]) -> None:
        """Begin at time 0.

        Args:
            columns: of the telemetry.
            names: of the lanes.
        """
        self.lanes = {name: RunningMetrics(columns, name) for name in names}

    def add(self, rows: Array, loop: ClosedLoop, time: float) -> None:
        """Take in what the loop has just written.

        Args:
            rows: telemetry. Shape (n, columns).
            loop: the closed loop, after these rows.
            time: time of the first row in [s].
        """
        for name, metrics in self.lanes.items():
            freeze = loop.lanes[name].freeze
            # A lane that stands still has no figures: the rows after its last are only held.
            ran = len(rows)
            if freeze is not None:
                ran = floor((freeze.time - time) / loop.period + ROUNDING) + 1
            if ran > 0:
                metrics.add(rows[:ran], time, loop.period)

    def restart(self, time: float, reason: str) -> None:
        """Let every lane count anew from ``time`` [s]."""
        for metrics in self.lanes.values():
            metrics.restart(time, reason)

    def adopt(
        self,
        before: Experiment,
        loop: ClosedLoop,
        origins: Mapping[str, str],
        columns: list[Channel],
    ) -> None:
        """Follow a change of the experiment.

        A lane that stands still keeps its figures: nothing acts on it until it is reset.

        Args:
            before: the experiment before it.
            loop: the closed loop, which has taken the new one.
            origins: by lane whose state it continues, itself where it was there already.
            columns: of the telemetry from now on.
        """
        after, known = loop.packed.experiment, dict(self.lanes)
        apart = any(_part(before, section) != _part(after, section) for section in _SHARED)
        lanes: dict[str, RunningMetrics] = {}
        for name, origin in origins.items():
            renamed = name != origin and origin not in after.lanes
            if name != origin and not (renamed and origin in known):
                lanes[name] = RunningMetrics(columns, name, loop.time, "added")
                continue
            lanes[name] = known.pop(origin)
            lanes[name].find(columns, name)
            changed = apart or before.lanes[origin] != after.lanes[name]
            if changed and loop.lanes[name].freeze is None:
                lanes[name].restart_total(loop.time, "change")
        self.lanes = lanes

    def document(self) -> dict[str, dict[str, Any]]:
        """Return the figures of every lane as plain JSON values. For any thread."""
        return {name: metrics.document() for name, metrics in tuple(self.lanes.items())}


def _part(experiment: Experiment, section: str) -> Any:
    part = getattr(experiment, section)
    # What whole runs alone have is no change of the loop.
    return part.model_copy(update=_WHOLE) if section == "simulation" else part
