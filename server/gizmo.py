"""Pulling the arm by its flange: a handle on the screen, a spring, an arrow."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import viser

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
"""How far from the base a handle is believed to be in [m] (*ours*)."""


@dataclass(frozen=True)
class _Hold:
    client: int
    target: Array
    heard: float


def spring_force(target: Array, flange: Array) -> Array:
    """Return the pull of the spring, capped.

    Args:
        target: where the handle is in [m]. Shape (3,).
        flange: where the flange is in [m]. Shape (3,).

    Returns:
        Force on the flange in [N], at most ``STRONGEST``. Shape (3,).
    """
    force = STIFFNESS * (target - flange)
    strength = float(np.linalg.norm(force))
    capped: Array = force * min(1.0, STRONGEST / max(strength, 1e-9))
    return capped


class Gizmo:
    """The handle at the flange.

    ``follow`` and ``force`` belong to the session's thread; the callbacks run on Viser's, in the
    order of its messages. They meet in one attribute that is replaced as a whole.
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
        self._hold: _Hold | None = None
        self._handle = viewer.scene.add_transform_controls(
            "/pull",
            scale=46.0,
            fixed=True,
            line_width=2.5,
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
        self._handle.on_update(self._dragged)

    def follow(self, flange: Array) -> None:
        """Move the handle to the flange unless somebody holds it, and draw the pull.

        Args:
            flange: where the flange is drawn in [m]. Shape (3,).
        """
        self._flange = flange
        force = self.force()
        if force is None:
            self._handle.position = flange
        arrow = np.zeros(3) if force is None else force / STIFFNESS
        seen = float(np.linalg.norm(arrow)) > ARROW_HEAD
        if seen:
            self._arrow.points = np.array([[flange, flange + arrow]])
        self._arrow.visible = seen

    def force(self) -> Array | None:
        """Return the force on the flange in [N] while the handle is held, else ``None``."""
        hold = self._hold
        if hold is None or self._clock() - hold.heard > PATIENCE:
            return None
        return spring_force(hold.target, self._flange)

    async def _dragged(self, event: viser.TransformControlsEvent) -> None:
        hold = self._hold
        if hold is not None and hold.client != event.client_id and self.force() is not None:
            return
        if event.phase == "end":  # also when the browser has gone
            self._hold = None
        elif event.client_id is not None:
            target = np.array(event.target.position, dtype=float)
            # A browser sends what it likes; nan fails the comparison too.
            if target.shape == (3,) and (np.abs(target) < FARTHEST).all():
                self._hold = _Hold(event.client_id, target, self._clock())
