"""The 3D scene: what the session's thread tells Viser, at most once a picture.

All methods but ``push`` belong to one thread. Nodes are made once and then changed in place: a
node's name stays in Viser's memory for ever.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import viser

from robot.arm import flange_positions
from robot.experiment import Robot
from server.desired_path import DesiredPath
from server.exaggeration import exaggerated_angles
from server.gizmo import Gizmo
from server.scene_arm import GhostArm, SolidArm, joint_orientations
from server.trails import Stretch, Trail, TrailLine
from server.viewer import GREY, close_viewer, open_viewer

Array = np.ndarray

FROZEN = (156, 112, 112)
"""Colour of an arm that has stopped (*ours*): grey with a tinge of red."""
WIDTH_SELECTED = 5.0
"""Width of the selected lane's trail in [px] (*ours*)."""
WIDTH_OTHERS = 2.5
"""Width of the other lanes' trails in [px] (*ours*)."""
LABEL = (0.5, -0.42, -0.75)
"""Where the scene says that deviations are exaggerated in [m] (*ours*): on the floor in front."""


@dataclass(frozen=True)
class LaneStyle:
    """How a lane looks.

    Attributes:
        name: the lane's name.
        color: its colour as ``#rrggbb``.
    """

    name: str
    color: str


@dataclass(frozen=True)
class SceneFrame:
    """What one picture shows.

    Attributes:
        q_d: desired angles now in [rad]. Shape (6,).
        q: angles of each lane now in [rad]. Shapes (6,).
        frozen: names of the lanes that have stopped.
        desired_path: desired flange positions since the last frame in [m]. Shape (k, 3).
        paths: true flange positions of each lane since the last frame in [m]. Shapes (k, 3).
        period: time between the rows of the paths in [s].
    """

    q_d: Array
    q: Mapping[str, Array]
    frozen: frozenset[str]
    desired_path: Array
    paths: Mapping[str, Array]
    period: float


@dataclass
class _Slot:
    """One lane's nodes. A slot has a number, not a name, so that there are never more than lanes."""

    ghost: GhostArm
    line: TrailLine


class _Lane:
    """What is known of one lane.

    Attributes:
        trail: where its flange has been.
        q_d: desired angles in the last picture in which it moved in [rad]. Shape (6,).
        q: its angles then in [rad]. Shape (6,).
        frozen: whether it has stopped.
    """

    def __init__(self) -> None:
        self.trail = Trail()
        self.q_d: Array | None = None
        self.q: Array | None = None
        self.frozen = False

    def take(self, name: str, frame: SceneFrame, factor: float) -> None:
        """Take what a frame says of the lane; a stopped lane stays as it was."""
        self.frozen = name in frame.frozen
        if self.frozen and self.q is not None:
            return
        q = np.array(frame.q[name], dtype=float)
        before = (frame.q_d, q) if self.q is None or self.q_d is None else (self.q_d, self.q)
        stretch = Stretch(
            frame.desired_path,
            frame.paths[name],
            np.array([before[0], frame.q_d]),
            np.array([before[1], q]),
            frame.period,
        )
        self.trail.extend(stretch, factor)
        self.q_d, self.q = np.array(frame.q_d, dtype=float), q


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
        self._gizmo = Gizmo(self._viewer)
        self._label = self._viewer.scene.add_label(
            "/label",
            "",
            position=LABEL,
            anchor="center-center",
            font_screen_scale=1.3,
            visible=False,
        )
        self._slots: list[_Slot] = []
        self._styles: tuple[LaneStyle, ...] = ()
        self._selected = ""
        self._lanes: dict[str, _Lane] = {}
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
        self._lanes = {lane.name: self._lanes.get(lane.name) or _Lane() for lane in lanes}
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
        with self._viewer.atomic():
            self._label.text = f"deviation × {self._factor:g}"
            self._label.visible = self._factor > 1.0

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
                self._draw(frame.q_d)

    def clear_trails(self) -> None:
        """Forget where the flanges have been."""
        for name in self._lanes:
            self._lanes[name] = _Lane()

    def push(self) -> Array | None:
        """Return the force on the flange [N] in the base frame while somebody pulls, else ``None``.

        Safe to call from any thread. Shape (3,).
        """
        return self._gizmo.force()

    def close(self) -> None:
        """Stop Viser and its threads."""
        close_viewer(self._viewer)

    def _new_slot(self, number: int) -> _Slot:
        scene = self._viewer.scene
        return _Slot(GhostArm(scene, f"/ghost_{number}"), TrailLine(scene, f"/trail_{number}"))

    def _paint(self) -> None:
        """Give every node its colour and decide what is seen, when something of it has changed."""
        frozen = tuple(lane.frozen for lane in self._lanes.values())
        painted = (self._styles, self._selected, frozen, self._ghosts, len(self._slots))
        if painted == self._painted:
            return
        self._painted = painted
        for slot in self._slots[len(self._styles) :]:
            slot.ghost.show(False)
            slot.line.hide()
        for slot, style, stopped in zip(self._slots, self._styles, frozen, strict=False):
            chosen, color = style.name == self._selected, _rgb(style.color)
            slot.ghost.paint(FROZEN if stopped else color)
            slot.ghost.show(stopped if chosen else self._ghosts)
            slot.line.style(color, GREY, WIDTH_SELECTED if chosen else WIDTH_OTHERS)
            if chosen:
                self._arm.show(not stopped)
                self._arm.paint(color)

    def _draw(self, q_d: Array) -> None:
        known = [(i, lane) for i, lane in enumerate(self._lanes.values()) if lane.q is not None]
        if not known:
            return
        desired = np.array([lane.q_d for _, lane in known])
        angles = exaggerated_angles(desired, np.array([lane.q for _, lane in known]), self._factor)
        flanges = flange_positions(np.vstack([angles, q_d]))
        self._desired.mark(flanges[-1])
        turned = joint_orientations(angles)
        for (i, lane), flange, orientations in zip(known, flanges, turned, strict=False):
            chosen = self._styles[i].name == self._selected
            lane.trail.stretch_to(self._factor)
            self._slots[i].line.show(lane.trail, flange)
            if chosen:
                self._arm.pose(orientations)
                self._gizmo.follow(flange)
            if lane.frozen or not chosen:
                self._slots[i].ghost.pose(orientations)


def _rgb(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
