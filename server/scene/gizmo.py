"""Pulling the arm: a handle at its flange, Shift and any of its links, a spring, an arrow."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import viser

from slidetune.server.live.pull import Grip, Pull, flange_grip, grip_at
from slidetune.server.scene.arm import Link
from slidetune.server.scene.shape import Shape

Array = np.ndarray

STIFFNESS = 500.0
"""Of the spring between the handle and the flange in [N/m] (*ours*)."""
STRONGEST = 200.0
"""Greatest pull in [N] (*ours*)."""
PATIENCE = 10.0
"""How long a handle may be held without moving in [s] (*ours*): a browser doesn't always say that
the pointer has let go."""
ARROW_COLOR = (204, 34, 58)
"""*Ours*: a red that no lane has."""
ARROW_HEAD = 0.045
"""Length of the arrow's head in [m] (*ours*); a pull that would be drawn shorter has no arrow."""
FARTHEST = 10.0
"""How far from the base a hand is believed to be in [m] (*ours*)."""
HANDLE_SIZE = 80.0
"""Length of the handle's axes in [px] (*ours*), however far away it is."""
HANDLE_WIDTH = 4.0
"""Width of its lines in [px] (*ours*); what takes the pointer is several times as wide."""


@dataclass(frozen=True)
class _Taken:
    """The arm that can be taken: what it is, its flange, and the angles that it is drawn with."""

    shape: Shape
    flange: Grip
    angles: Array


@dataclass(frozen=True)
class _Hold:
    """A hand: where it is, and what it has taken; without a grip it is the handle."""

    client: int
    grip: Grip | None
    target: Array
    heard: float


def spring_force(target: Array, place: Array) -> Array:
    """Return the pull of the spring, capped.

    Args:
        target: where the hand is in [m]. Shape (3,).
        place: where the point of the arm is that it has taken in [m]. Shape (3,).

    Returns:
        Force on the arm in [N], at most ``STRONGEST``. Shape (3,).
    """
    force = STIFFNESS * (target - place)
    strength = float(np.linalg.norm(force))
    capped: Array = force * min(1.0, STRONGEST / max(strength, 1e-9))
    return capped


class Gizmo:
    """The handle at the flange, and the arm as far as it can be taken.

    ``follow`` and ``pull`` belong to the session's thread; the callbacks run on Viser's, in the
    order of its messages. They meet in attributes that are replaced as a whole.
    """

    def __init__(
        self, viewer: viser.ViserServer, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Add the handle and its arrow.

        Args:
            viewer: where.
            clock: says the time in [s].
        """
        self._clock = clock
        self._flange = np.zeros(3)
        self._arm: _Taken | None = None
        self._joints: dict[str, int] = {}
        self._hold: _Hold | None = None
        self._handle = viewer.scene.add_transform_controls(
            "/pull",
            scale=HANDLE_SIZE,
            fixed=True,
            line_width=HANDLE_WIDTH,
            disable_rotations=True,
            depth_test=False,
            opacity=0.8,
        )
        self._arrow = viewer.scene.add_arrows(
            "/pull_arrow",
            np.zeros((1, 2, 3)),
            ARROW_COLOR,
            shaft_radius=0.006,
            head_radius=0.016,
            head_length=ARROW_HEAD,
            visible=False,
        )
        self._handle.on_update(self._handle_dragged)

    def take(self, shape: Shape, links: Sequence[Link]) -> None:
        """Hold another arm, whose links can be dragged with Shift.

        Args:
            shape: the arm.
            links: what moves with its joints, in their order.
        """
        self._hold = None
        self._arm = _Taken(shape, flange_grip(shape.model, shape.tip), np.zeros(shape.joints))
        for joint, link in enumerate(links, 1):
            if link.name not in self._joints and isinstance(link, viser.GlbHandle):
                link.on_drag("left", modifier="shift")(self._link_dragged)
            self._joints[link.name] = joint

    def follow(self, flange: Array, angles: Array) -> None:
        """Move the handle to the flange unless somebody holds it, and draw the pull.

        Args:
            flange: where the flange is drawn in [m]. Shape (3,).
            angles: the joint angles that the arm is drawn with in [rad]. Shape (n,).
        """
        self._flange = flange
        if self._arm is not None:
            self._arm = replace(self._arm, angles=angles)
        hold, force = self._held()
        if hold is None or hold.grip is not None:
            self._handle.position = flange
        arrow = force / STIFFNESS
        seen = float(np.linalg.norm(arrow)) > ARROW_HEAD
        if seen and hold is not None:
            place = self._place(hold)
            self._arrow.points = np.array([[place, place + arrow]])
        self._arrow.visible = seen

    def pull(self) -> Pull | None:
        """Return the force in [N] and where it acts while somebody holds the arm, else ``None``."""
        hold, force = self._held()
        if hold is None or self._arm is None:
            return None
        return Pull(hold.grip or self._arm.flange, force)

    def _held(self) -> tuple[_Hold | None, Array]:
        hold = self._hold
        if hold is None or self._clock() - hold.heard > PATIENCE:
            return None, np.zeros(3)
        return hold, spring_force(hold.target, self._place(hold))

    def _place(self, hold: _Hold) -> Array:
        if hold.grip is None or self._arm is None:
            return self._flange
        return hold.grip.place(self._arm.shape.model, self._arm.angles)

    async def _handle_dragged(self, event: viser.TransformControlsEvent) -> None:
        target = _believed(event.target.position)
        self._move(event.client_id, event.phase, None, target)

    async def _link_dragged(self, event: viser.SceneNodeDragEvent[viser.GlbHandle]) -> None:
        start, target = _believed(event.start_position), _believed(event.end_position)
        hold, _ = self._held()
        joint, arm = self._joints[event.target.name], self._arm
        # Taken once: where the link is by then, only the browser that draws it knows.
        held = hold and hold.client == event.client_id and hold.grip
        if event.phase == "start" or not held or held.joint != joint:
            held = None
            if arm is not None and start is not None and joint <= arm.shape.joints:
                held = grip_at(arm.shape.model, joint, start, arm.angles)
        self._move(event.client_id, event.phase, held, target if held else None)

    def _move(
        self, client: int | None, phase: str, grip: Grip | None, target: Array | None
    ) -> None:
        hold, _ = self._held()
        if hold is not None and hold.client != client:
            return
        if phase == "end":  # also when the browser has gone
            self._hold = None
        elif client is not None and target is not None:
            self._hold = _Hold(client, grip, target, self._clock())


def _believed(position: object) -> Array | None:
    """Return a place that a browser has sent, or ``None`` where it can't be one."""
    place = np.array(position, dtype=float)
    # It sends what it likes; nan fails the comparison too.
    return place if place.shape == (3,) and (np.abs(place) < FARTHEST).all() else None
