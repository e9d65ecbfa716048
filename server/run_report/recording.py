"""A run in 3D as Viser's own recording: all lanes, the desired path and the trails."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from slidetune.robot.loop.simulate import Run
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.scene.frame import LaneStyle
from slidetune.server.scene.replay import Replay
from slidetune.server.scene.scene import Scene

RATE = 30.0
"""Pictures a second of simulated time (*ours*), where there are no more than ``MOST_PICTURES``."""
MOST_PICTURES = 600
"""Most pictures of a recording (*ours*): a longer run has fewer a second."""
SPACING = 0.025
"""Time between two points of a trail at most in [s] (*ours*), as on the dashboard."""
PATH_POINTS = 800
"""Points of the desired path (*ours*)."""


@dataclass(frozen=True)
class Film:
    """What is to be recorded.

    Attributes:
        replay: the lanes, thinned out.
        rows: how many rows of it pass from one picture to the next.
    """

    replay: Replay
    rows: int

    @property
    def rate(self) -> float:
        """Pictures a second of simulated time in [1/s]."""
        return 1.0 / (self.rows * self.replay.period)


def film_of(run: Run) -> Film:
    """Return what is to be recorded of a run; its first lane's arm is solid.

    Args:
        run: the run.
    """
    row = float(run.time[1] - run.time[0])
    picture = max(1.0 / RATE, float(run.time[-1]) / MOST_PICTURES)
    rows = ceil(picture / SPACING)
    stride = max(1, ceil(picture / (rows * row) - 1e-9))
    lanes = run.lanes
    colors = LaneColors()
    colors.assign(list(lanes))
    replay = Replay(
        robot=run.experiment.robot,
        styles=tuple(LaneStyle(name, colors.of(name)) for name in lanes),
        period=stride * row,
        q_d=run.q_d[::stride],
        desired=next(iter(lanes.values())).flange_desired[::stride],
        q={name: lane.q[::stride] for name, lane in lanes.items()},
        flange={name: lane.flange[::stride] for name, lane in lanes.items()},
    )
    return Film(replay, rows)


def record(film: Film) -> bytes:
    """Return a recording in Viser's format, compressed.

    Viser records what it would send: a server of its own runs meanwhile, on a free port of the
    loopback interface and locked, and has ended when this returns.

    Args:
        film: what to record.
    """
    replay = film.replay
    scene = Scene(None, replay.robot.model, recorded=True)
    try:
        scene.lock()
        path = replay.desired[:: max(1, len(replay.desired) // PATH_POINTS)]
        scene.configure(replay.styles, replay.styles[0].name, replay.robot, path)
        scene.update(replay.frame(0, 0))
        recorder = scene.recorder()
        end = len(replay.q_d) - 1
        shown = 0
        while shown < end:
            row = min(shown + film.rows, end)  # the last picture is of the end of the run
            recorder.insert_sleep((row - shown) * replay.period)
            scene.update(replay.frame(shown, row))
            shown = row
        return recorder.serialize()
    finally:
        scene.close()
