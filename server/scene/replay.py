"""Whole runs side by side in 3D: two in the place of the session, or all lanes of a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from slidetune.robot.arm.section import Robot
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.response import only_lane
from slidetune.robot.loop.simulate import simulate
from slidetune.server.scene.frame import LaneStyle, SceneFrame

Array = np.ndarray

NOMINAL, OTHER = "nominal", "other"
OTHER_COLOR = "#d1495b"
"""Of the other run (*ours*): no lane has it."""


@dataclass(frozen=True)
class Replay:
    """What is shown.

    Attributes:
        robot: the arm, whose payload is drawn.
        styles: how the runs look; the arm of the first is solid.
        period: time between two rows in [s].
        q_d: desired angles in [rad]. Shape (n, 6).
        desired: desired flange positions in [m]. Shape (n, 3).
        q: angles of each run in [rad], NaN once it left its bounds. Shapes (n, 6).
        flange: flange positions of each run in [m]. Shapes (n, 3).
    """

    robot: Robot
    styles: tuple[LaneStyle, ...]
    period: float
    q_d: Array
    desired: Array
    q: Mapping[str, Array]
    flange: Mapping[str, Array]

    def row(self, passed: float) -> int | None:
        """Return the row to show so long after the beginning [s], ``None`` once it is over."""
        row = int(passed / self.period)
        return row if row < len(self.q_d) else None

    def frame(self, first: int, last: int) -> SceneFrame:
        """Return the picture of a row, with the paths since another.

        Args:
            first: the row that the last picture showed.
            last: the row that this one shows.
        """
        known = {name: _last_known(q, last) for name, q in self.q.items()}
        return SceneFrame(
            q_d=self.q_d[last],
            q={name: self.q[name][row] for name, row in known.items()},
            frozen=frozenset(name for name, row in known.items() if row < last),
            desired_path=self.desired[first:last],
            paths={name: self.flange[name][first : min(last, row)] for name, row in known.items()},
            period=self.period,
        )


def _last_known(q: Array, row: int) -> int:
    """Return the last row up to one that is a number."""
    known = np.flatnonzero(np.isfinite(q[: row + 1, 0]))
    return int(known[-1]) if len(known) else 0


def replay_of(nominal: Experiment, other: Experiment, lane: str, color: str) -> Replay:
    """Run a lane of two experiments and return what is to be shown of it.

    Args:
        nominal: the one whose arm is solid.
        other: the one whose arm is a ghost.
        lane: which lane of both.
        color: of the lane.

    Raises:
        InvalidExperimentError: if an arm can't follow its trajectory.
    """
    runs = {
        NOMINAL: simulate(only_lane(nominal, lane), estimate=False),
        OTHER: simulate(only_lane(other, lane), estimate=False),
    }
    first = runs[NOMINAL]
    return Replay(
        robot=nominal.robot,
        styles=(LaneStyle(NOMINAL, color), LaneStyle(OTHER, OTHER_COLOR)),
        period=float(first.time[1] - first.time[0]),
        q_d=first.q_d,
        desired=first.lanes[lane].flange_desired,
        q={name: run.lanes[lane].q for name, run in runs.items()},
        flange={name: run.lanes[lane].flange for name, run in runs.items()},
    )
