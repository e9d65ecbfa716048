"""The 3D scene: what the session's thread tells Viser, at most once a picture.

All methods but ``pull`` belong to one thread. Nodes are made once and then changed in place: a
node's name stays in Viser's memory for ever.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from slidetune.robot.arm.arm import flange_positions, shipped_places
from slidetune.robot.arm.description import LINK_NAMES
from slidetune.robot.arm.section import Robot
from slidetune.server.live.pull import Pull
from slidetune.server.scene.arm import GhostArm, SolidArm, joint_orientations
from slidetune.server.scene.desired_path import DesiredPath
from slidetune.server.scene.exaggeration import exaggerated_angles
from slidetune.server.scene.frame import LaneStyle, SceneFrame, ShownLane
from slidetune.server.scene.ghost_mesh import ghost_mesh
from slidetune.server.scene.gizmo import Gizmo
from slidetune.server.scene.lock import lock_scene
from slidetune.server.scene.response_paths import ResponsePaths
from slidetune.server.scene.trails import TrailLine
from slidetune.server.scene.viewer import GREY, close_viewer, open_viewer

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
class _Slot:
    """One lane's nodes; they have numbers for names, so that renaming a lane makes no new ones."""

    ghost: GhostArm
    line: TrailLine


class Scene:
    """The scene of one session.

    Attributes:
        port: TCP port on 127.0.0.1 where Viser serves it.
    """

    def __init__(self, port: int | None = None) -> None:
        """Start Viser with an empty room.

        Args:
            port: wanted TCP port, the next free one if it is taken; ``None`` for any.
        """
        self._viewer = open_viewer(port)
        self.port = self._viewer.get_port()
        self._arm = SolidArm(self._viewer.scene, "/arm")
        self._desired = DesiredPath(self._viewer.scene, "/desired")
        self._responses = ResponsePaths(self._viewer.scene, "/response")
        self._gizmo = Gizmo(self._viewer, self._arm.links)
        self._label = self._viewer.scene.add_label(
            "/label",
            "",
            position=LABEL,
            anchor="center-center",
            font_screen_scale=1.3,
            visible=False,
        )
        for link in LINK_NAMES[1:]:
            ghost_mesh(link)  # now, and not on the session's thread when the first lane comes
        self._slots: list[_Slot] = []
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
            robot: the arm; its payload is drawn.
            desired_loop: the desired flange path over the horizon in [m]. Shape (m, 3).
        """
        self._styles, self._selected = tuple(lanes), selected
        self._lanes = {lane.name: self._lanes.get(lane.name) or ShownLane() for lane in lanes}
        with self._viewer.atomic():
            while len(self._slots) < len(lanes):
                self._slots.append(self._new_slot(len(self._slots)))
            self._arm.carry(robot.payload)
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
        if self._viewer.get_clients():
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
            self._lanes[name] = ShownLane()

    def pull(self) -> Pull | None:
        """Return how somebody pulls at the arm, or ``None``. Safe to call from any thread."""
        return self._gizmo.pull()

    def lock(self) -> str:
        """Let only those connect to Viser's own port who know a key; return the key."""
        return lock_scene(self._viewer)

    def close(self) -> None:
        """Stop Viser and its threads."""
        close_viewer(self._viewer)

    def _new_slot(self, number: int) -> _Slot:
        scene = self._viewer.scene
        return _Slot(GhostArm(scene, f"/ghost_{number}"), TrailLine(scene, f"/trail_{number}"))

    def _paint(self) -> None:
        """Give every node its colour and decide what is seen, when something of it has changed."""
        lanes = tuple(self._lanes.values())
        frozen = tuple(lane.frozen for lane in lanes)
        painted = (self._styles, self._selected, frozen, self._ghosts, len(self._slots))
        if painted == self._painted:
            return
        self._painted = painted
        for slot in self._slots[len(self._styles) :]:
            slot.ghost.show(False)
            slot.line.hide()
        for slot, style, lane in zip(self._slots, self._styles, lanes, strict=False):
            chosen, color = style.name == self._selected, _rgb(style.color)
            slot.ghost.paint(FROZEN if lane.frozen else color)
            slot.ghost.show(self._seen(lane, chosen))
            slot.line.style(color, GREY, WIDTH_SELECTED if chosen else WIDTH_OTHERS)
            if chosen:
                self._arm.show(not lane.frozen)
                self._arm.paint(color)

    def _draw(self, q_d: Array, past: bool) -> None:
        known = [(i, lane) for i, lane in enumerate(self._lanes.values()) if lane.q is not None]
        if not known:
            return
        desired = np.array([lane.q_d for _, lane in known])
        angles = exaggerated_angles(desired, np.array([lane.q for _, lane in known]), self._factor)
        flanges = flange_positions(np.vstack([angles, q_d]), shipped_places())
        self._desired.mark(flanges[-1])
        turned = joint_orientations(angles)
        shown = zip(known, angles, flanges, turned, strict=False)
        for (i, lane), drawn, flange, orientations in shown:
            chosen = self._styles[i].name == self._selected
            lane.trail.stretch_to(self._factor)
            self._slots[i].line.show(lane.trail, lane.trail.points[-1] if past else flange)
            if chosen:
                self._arm.pose(orientations)
                self._gizmo.follow(flange, drawn)
            if self._seen(lane, chosen):
                self._slots[i].ghost.pose(orientations)

    def _seen(self, lane: ShownLane, chosen: bool) -> bool:
        """Return whether a lane has a ghost: the selected one only once it has stopped."""
        return lane.frozen if chosen else self._ghosts


def _rgb(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
