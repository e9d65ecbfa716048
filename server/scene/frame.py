"""What the scene is told, and what it remembers of each lane from one picture to the next."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from slidetune.server.scene.trails import Stretch, Trail

Array = np.ndarray


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
        q_d: desired angles now in [rad]. Shape (n,).
        q: angles of each lane now in [rad]. Shapes (n,).
        frozen: names of the lanes that have stopped.
        desired_path: desired flange positions since the last frame in [m]. Shape (k, 3).
        paths: true flange positions of each lane since the last frame in [m]. Shapes (k, 3).
        period: time between the rows of the paths in [s].
        past: whether it is a look back, so that the trails end elsewhere.
    """

    q_d: Array
    q: Mapping[str, Array]
    frozen: frozenset[str]
    desired_path: Array
    paths: Mapping[str, Array]
    period: float
    past: bool = False


class ShownLane:
    """What the scene remembers of one lane.

    Attributes:
        trail: where its flange has been.
        q_d: desired angles in the last picture in which it moved in [rad]. Shape (n,).
        q: its angles then in [rad]. Shape (n,).
        frozen: whether it has stopped.
    """

    def __init__(self, places: Array) -> None:
        """Know nothing yet.

        Args:
            places: its arm for ``flange_positions``.
        """
        self.trail = Trail(places)
        self.q_d: Array | None = None
        self.q: Array | None = None
        self.frozen = False
        self._present: tuple[Array | None, Array | None] | None = None

    def take(self, name: str, frame: SceneFrame, factor: float) -> None:
        """Take what a frame says of the lane; a lane that has stopped stays as it was.

        Args:
            name: the lane's name.
            frame: the present.
            factor: how many times its deviation is drawn.
        """
        self.frozen = name in frame.frozen
        if frame.past:
            self._look_back(frame.q_d, frame.q[name])
            return
        if self._present is not None:
            (self.q_d, self.q), self._present = self._present, None
        if self.frozen and self.q is not None:
            return
        q_d, q = np.array(frame.q_d, dtype=float), np.array(frame.q[name], dtype=float)
        if self.q_d is None or self.q is None:
            # Of the rows before the first picture only the last one's angles are known.
            rows, before = slice(-1, None), (q_d, q)
        else:
            rows, before = slice(None), (self.q_d, self.q)
        stretch = Stretch(
            frame.desired_path[rows],
            frame.paths[name][rows],
            np.array([before[0], q_d]),
            np.array([before[1], q]),
            frame.period,
        )
        self.trail.extend(stretch, factor)
        self.q_d, self.q = q_d, q

    def _look_back(self, q_d: Array, q: Array) -> None:
        """Stand elsewhere for a while; the way goes on from where it was left."""
        if self._present is None:
            self._present = self.q_d, self.q
        self.q_d, self.q = np.array(q_d, dtype=float), np.array(q, dtype=float)
