"""Feeds the 3D scene from the session's thread: angles, new flange points, what is selected."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from time import perf_counter

import numpy as np

from slidetune.robot.arm.arm import flange_positions
from slidetune.robot.experiment.packed import Packed
from slidetune.robot.kernels.workspace import QD, Q
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.motion.along import desired_motion
from slidetune.server.live.lane_colors import LaneColors
from slidetune.server.live.pull import Pull
from slidetune.server.live.recorder import Moment
from slidetune.server.live.telemetry import Channel
from slidetune.server.scene.replay import Replay
from slidetune.server.scene.scene import LaneStyle, Scene, SceneFrame
from slidetune.server.scene.shape import shape_of

Array = np.ndarray

log = logging.getLogger("slidetune.scene")

FRAME = 1.0 / 30.0
"""Time between two pictures in [s] (*ours*)."""
PATH_POINTS = 400
"""Points of the desired path over the horizon (*ours*)."""


class SceneFeed:
    """What the scene shows, and when."""

    def __init__(self, scene: Scene, colors: LaneColors) -> None:
        """Feed ``scene``."""
        self.scene = scene
        self.selected = ""
        self.exaggeration = 1.0
        self.ghosts = True
        self._colors = colors
        self._columns: dict[str, list[int]] = {}
        self._blocks: list[Array] = []
        self._period = 0.001
        self._drawn = 0.0
        self._shown: tuple[object, ...] = ()
        self._broken = False
        self._responses: dict[str, Array] | None = None
        self._past: Moment | None = None
        self._present: float | None = None
        self._replay: Replay | None = None
        self._replayed: tuple[Replay, float, int] | None = None

    def pull(self) -> Pull | None:
        """Return how somebody pulls at the arm, or ``None``."""
        return None if self._broken else self.scene.pull()

    def new_lanes(self, columns: list[Channel]) -> None:
        """Find the flange columns of other lanes."""
        self._blocks.clear()
        self._columns = {}
        for index, channel in enumerate(columns):
            if channel.group in ("flange", "flange_d"):
                self._columns.setdefault(channel.lane, []).append(index)

    def add(self, rows: Array, period: float) -> None:
        """Keep new rows for the trails."""
        self._blocks.append(rows)
        self._period = period

    def show_responses(self, paths: Mapping[str, Array]) -> None:
        """Draw the flange's path of whole responses beside the live one, by lane."""
        self._responses = dict(paths)

    def show_past(self, moment: Moment | None) -> None:
        """Show a past moment until time goes on; ``None``: the present.

        The session pauses first: what it does until then is no reason to leave the past.
        """
        self._present = None
        self._past = moment

    @property
    def past(self) -> Moment | None:
        """The past moment that is shown, ``None`` for the present."""
        return self._past

    def show_replay(self, replay: Replay | None) -> None:
        """Show two runs side by side in place of the session, once; ``None``: the session again."""
        self._replay = replay

    @property
    def replaying(self) -> bool:
        """Whether two runs are shown in place of the session."""
        return self._replay is not None

    def restart(self) -> None:
        """Clear the trails."""
        self._blocks.clear()
        self._responses = {}
        self._guarded(self.scene.clear_trails)

    def restart_lane(self, name: str) -> None:
        """Clear one lane's trail."""
        self._blocks.clear()
        self._guarded(lambda: self.scene.clear_trail(name))

    def prepare(self, model: str) -> None:
        """Read an arm's meshes, away from the session's thread."""
        self._guarded(lambda: shape_of(model))

    def draw(self, loop: ClosedLoop) -> None:
        """Show the present, at most 30 times a second."""
        now = perf_counter()
        if now - self._drawn < FRAME:
            return
        self._drawn = now
        self._guarded(lambda: self._draw(loop, now))

    def _guarded(self, action: object) -> None:
        """Never let the 3D view stop the session."""
        if self._broken or not callable(action):
            return
        try:
            action()
        except Exception:
            log.exception("The 3D view failed and is switched off until the server restarts.")
            self._broken = True

    def _draw(self, loop: ClosedLoop, now: float) -> None:
        if self._draw_replay(now):
            return
        self._configure(loop.packed, list(loop.lanes))
        lanes = loop.lanes
        points = np.vstack(self._blocks) if self._blocks else None
        self._blocks.clear()

        def path(lane: str) -> Array:
            return np.empty((0, 3)) if points is None else points[:, self._columns[lane]]

        if self._responses is not None:
            responses, self._responses = self._responses, None
            self.scene.show_responses(responses)
        moment, packed = self._looked_at(loop), loop.packed
        q_d = next(iter(lanes.values())).work[QD]
        if moment is not None:
            q_d = desired_motion(packed.trajectory, np.array([moment.time]), packed.joints)[0][0]
        angles = moment.angles() if moment is not None else {}
        stops = moment.freezes if moment is not None else {}
        self.scene.update(
            SceneFrame(
                q_d=q_d.copy(),
                q={name: angles.get(name, lane.work[Q]).copy() for name, lane in lanes.items()},
                frozen=frozenset(n for n, lane in lanes.items() if stops.get(n, lane.freeze)),
                desired_path=path(""),
                paths={name: path(name) for name in lanes},
                period=self._period,
                past=moment is not None,
            )
        )

    def _draw_replay(self, now: float) -> bool:
        """Draw the replay, if there is one; return whether there was."""
        replay, replayed = self._replay, self._replayed
        if replay is None:
            if replayed is not None:
                self._leave_replay()
            return False
        if replayed is None or replayed[0] is not replay:
            self.scene.clear_trails()
            self.scene.configure(replay.styles, replay.styles[0].name, replay.robot, replay.desired)
            replayed = replay, now, 0
        _, began, shown = replayed
        row = replay.row(now - began)
        if row is None:
            if self._replay is replay:
                self._replay = None
            self._leave_replay()
            return False
        self.scene.update(replay.frame(shown, row))
        self._replayed = replay, began, row
        self._blocks.clear()
        return True

    def _leave_replay(self) -> None:
        self._replayed = None
        self._shown = ()
        self._blocks.clear()
        self.scene.clear_trails()

    def _looked_at(self, loop: ClosedLoop) -> Moment | None:
        """Return the past moment to show; none once time has gone on."""
        if self._past is None:
            return None
        if self._present is None:
            self._present = loop.time
        if loop.time != self._present:
            self._past = None
        return self._past

    def _configure(self, packed: Packed, lanes: list[str]) -> None:
        if self.selected not in lanes:
            self.selected = lanes[0]
        experiment = packed.experiment
        shown = (
            tuple(lanes),
            self.selected,
            experiment.robot,
            experiment.trajectory,
            experiment.simulation.horizon,
            self.exaggeration,
            self.ghosts,
        )
        if shown == self._shown:
            return
        self._shown = shown
        time = np.linspace(0.0, experiment.simulation.horizon, PATH_POINTS)
        q_d, _ = desired_motion(packed.trajectory, time, packed.joints)
        desired = flange_positions(q_d, packed.places)
        styles = [LaneStyle(name, self._colors.of(name)) for name in lanes]
        self.scene.configure(styles, self.selected, experiment.robot, desired)
        self.scene.view(self.exaggeration, self.ghosts)
