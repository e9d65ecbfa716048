"""The 3D scene: what the session's thread tells Viser, at most once a picture.

All methods but ``pull`` belong to one thread. Nodes are made once and then changed in place: a
node's name stays in Viser's memory for ever.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from viser.infra import StateSerializer

from slidetune.robot.arm.arm import flange_positions
from slidetune.robot.arm.known import SHIPPED
from slidetune.robot.arm.section import Robot
from slidetune.server.live.pull import Pull
from slidetune.server.scene.arm import GhostArm, SolidArm
from slidetune.server.scene.desired_path import DesiredPath
from slidetune.server.scene.exaggeration import exaggerated_angles
from slidetune.server.scene.frame import LaneStyle, SceneFrame, ShownLane
from slidetune.server.scene.gizmo import Gizmo
from slidetune.server.scene.lock import lock_scene
from slidetune.server.scene.response_paths import ResponsePaths
from slidetune.server.scene.shape import Shape, shape_of
from slidetune.server.scene.trails import TrailLine
from slidetune.server.scene.viewer import GREY, close_viewer, look_at_arm, open_viewer

__all__ = ["LaneStyle", "Scene", "SceneFrame"]

Array = np.ndarray

FROZEN = (134, 90, 90)
"""Colour of an arm that has stopped (*ours*): grey with a tinge of red."""
WIDTH_SELECTED = 5.0
"""Width of the selected lane's trail in [px] (*ours*)."""
WIDTH_OTHERS = 2.5
"""Width of the other lanes' trails in [px] (*ours*)."""
LABEL = (0.5, -0.42, -0.75)
"""Where the scene says that deviations are exaggerated in [m] (*ours*): on the floor in front."""


@dataclass
class _Standing:
    """The nodes of an arm, which stay when another one is shown in its place.

    Attributes:
        shape: what it looks like.
        root: name of the nodes above its own.
        solid: the arm of the selected lane.
        ghosts: those of the lanes; they have numbers for names, so that renaming a lane makes no
            new ones.
    """

    shape: Shape
    root: str
    solid: SolidArm
    ghosts: list[GhostArm]


class Scene:
    """The scene of one session.

    Attributes:
        port: TCP port on 127.0.0.1 where Viser serves it.
    """

    def __init__(
        self, port: int | None = None, model: str = SHIPPED, recorded: bool = False
    ) -> None:
        """Start Viser with an empty room.

        Args:
            port: wanted TCP port, the next free one if it is taken; ``None`` for any.
            model: the arm that stands in it at first.
            recorded: whether it is drawn for a recording, although nobody looks, and without a
                handle to pull at.
        """
        self._viewer = open_viewer(port)
        self.port = self._viewer.get_port()
        self._recorded = recorded
        self._arms: dict[str, _Standing] = {}
        self._arm = self._new_arm(model)
        if model != SHIPPED:
            look_at_arm(self._viewer, self._arm.shape)
        self._desired = DesiredPath(self._viewer.scene, "/desired")
        self._responses = ResponsePaths(self._viewer.scene, "/response")
        self._gizmo = None if recorded else Gizmo(self._viewer)
        if self._gizmo is not None:
            self._gizmo.take(self._arm.shape, self._arm.solid.links)
        self._label = self._viewer.scene.add_label(
            "/label",
            "",
            position=LABEL,
            anchor="center-center",
            font_screen_scale=1.3,
            visible=False,
        )
        self._lines: list[TrailLine] = []
        self._styles: tuple[LaneStyle, ...] = ()
        self._selected = ""
        self._lanes: dict[str, ShownLane] = {}
        self._painted: tuple[object, ...] = ()
        self._factor = 1.0
        self._ghosts = True

    def configure(
        self, lanes: Sequence[LaneStyle], selected: str, robot: Robot, desired_loop: Array
    ) -> None:
        """Say what there is; cheap when nothing has changed.

        Args:
            lanes: the lanes in order.
            selected: name of the lane whose arm is solid.
            robot: the arm and its payload; its looks are known, see ``shape_of``, or take long.
            desired_loop: the desired flange path over the horizon in [m]. Shape (m, 3).
        """
        self._styles, self._selected = tuple(lanes), selected
        with self._viewer.atomic():
            if robot.model != self._arm.shape.name:
                self._change_arm(robot.model)
            self._lanes = {
                lane.name: self._lanes.get(lane.name) or self._new_lane() for lane in lanes
            }
            scene, arm = self._viewer.scene, self._arm
            while len(self._lines) < len(lanes):
                self._lines.append(TrailLine(scene, f"/trail_{len(self._lines)}"))
            while len(arm.ghosts) < len(lanes):
                root = f"{arm.root}ghost_{len(arm.ghosts)}"
                arm.ghosts.append(GhostArm(scene, root, arm.shape))
            arm.solid.carry(robot.payload)
            self._desired.draw(desired_loop)

    def view(self, exaggeration: float, ghosts: bool) -> None:
        """Choose how to look.

        Args:
            exaggeration: how many times each arm's deviation is drawn, at least 1.
            ghosts: whether the arms of the other lanes are drawn.
        """
        self._factor, self._ghosts = max(1.0, float(exaggeration)), ghosts
        exaggerated = self._factor > 1.0
        with self._viewer.atomic():
            self._responses.show(not exaggerated)
            self._label.visible = exaggerated
            if exaggerated:
                self._label.text = f"deviation \N{MULTIPLICATION SIGN} {self._factor:g}"

    def update(self, frame: SceneFrame) -> None:
        """Show the present. Call it while paused too, so that a browser that has just come sees it.

        Args:
            frame: the present.
        """
        for name, lane in self._lanes.items():
            if name in frame.q:
                lane.take(name, frame, self._factor)
        if self._recorded or self._viewer.get_clients():
            with self._viewer.atomic():
                self._paint()
                self._draw(frame.q_d, frame.past)

    def show_responses(self, paths: Mapping[str, Array]) -> None:
        """Draw where the flanges would go over the whole horizon; hidden while exaggerated.

        Args:
            paths: flange positions by lane in [m]; empty for none. Shapes (m, 3).
        """
        with self._viewer.atomic():
            self._responses.draw(paths, self._styles)
            self._responses.show(self._factor == 1.0)

    def clear_trails(self) -> None:
        """Forget where the flanges have been."""
        for name in self._lanes:
            self.clear_trail(name)

    def clear_trail(self, name: str) -> None:
        """Forget where one lane's flange has been."""
        if name in self._lanes:
            self._lanes[name] = self._new_lane()

    def pull(self) -> Pull | None:
        """Return how somebody pulls at the arm, or ``None``. Safe to call from any thread."""
        return None if self._gizmo is None else self._gizmo.pull()

    def recorder(self) -> StateSerializer:
        """Return what records the scene from now on, in Viser's own format."""
        return self._viewer.get_scene_serializer()

    def lock(self) -> str:
        """Let only those connect to Viser's own port who know a key; return the key."""
        return lock_scene(self._viewer)

    def close(self) -> None:
        """Stop Viser and its threads."""
        close_viewer(self._viewer)

    def _new_lane(self) -> ShownLane:
        return ShownLane(self._arm.shape.places)

    def _new_arm(self, name: str) -> _Standing:
        shape = shape_of(name)
        root = f"/arms/{len(self._arms)}/" if self._arms else "/"
        self._arms[name] = _Standing(
            shape, root, SolidArm(self._viewer.scene, f"{root}arm", shape), []
        )
        return self._arms[name]

    def _change_arm(self, name: str) -> None:
        """Show another arm, with nothing of what was before."""
        self._arm.solid.stand(False)
        for ghost in self._arm.ghosts:
            ghost.show(False)
        self._arm = self._arms.get(name) or self._new_arm(name)
        self._arm.solid.stand(True)
        if self._gizmo is not None:
            self._gizmo.take(self._arm.shape, self._arm.solid.links)
        look_at_arm(self._viewer, self._arm.shape)
        self._lanes, self._painted = {}, ()

    def _paint(self) -> None:
        """Give every node its colour and decide what is seen, when something of it has changed."""
        lanes = tuple(self._lanes.values())
        frozen = tuple(lane.frozen for lane in lanes)
        painted = (self._styles, self._selected, frozen, self._ghosts, len(self._lines))
        if painted == self._painted:
            return
        self._painted = painted
        arm = self._arm
        for ghost in arm.ghosts[len(self._styles) :]:
            ghost.show(False)
        for line in self._lines[len(self._styles) :]:
            line.hide()
        for ghost, line, style, lane in zip(
            arm.ghosts, self._lines, self._styles, lanes, strict=False
        ):
            chosen, color = style.name == self._selected, _rgb(style.color)
            ghost.paint(FROZEN if lane.frozen else color)
            ghost.show(self._seen(lane, chosen))
            line.style(color, GREY, WIDTH_SELECTED if chosen else WIDTH_OTHERS)
            if chosen:
                arm.solid.show(not lane.frozen)
                arm.solid.paint(color)

    def _draw(self, q_d: Array, past: bool) -> None:
        known = [(i, lane) for i, lane in enumerate(self._lanes.values()) if lane.q is not None]
        if not known:
            return
        desired = np.array([lane.q_d for _, lane in known])
        angles = exaggerated_angles(desired, np.array([lane.q for _, lane in known]), self._factor)
        arm = self._arm
        flanges = flange_positions(np.vstack([angles, q_d]), arm.shape.places)
        self._desired.mark(flanges[-1])
        shown = zip(known, angles, flanges, *arm.shape.poses(angles), strict=False)
        for (i, lane), drawn, flange, turns, places in shown:
            chosen = self._styles[i].name == self._selected
            lane.trail.stretch_to(self._factor)
            self._lines[i].show(lane.trail, lane.trail.points[-1] if past else flange)
            if chosen:
                arm.solid.pose(turns, places)
                if self._gizmo is not None:
                    self._gizmo.follow(flange, drawn)
            if self._seen(lane, chosen):
                arm.ghosts[i].pose(turns, places)

    def _seen(self, lane: ShownLane, chosen: bool) -> bool:
        """Return whether a lane has a ghost: the selected one only once it has stopped."""
        return lane.frozen if chosen else self._ghosts


def _rgb(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
