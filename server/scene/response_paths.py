"""Where the flange of each lane would go over the whole horizon: thin dashed lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import viser

from slidetune.server.scene.desired_path import dashes
from slidetune.server.scene.frame import LaneStyle

Array = np.ndarray

WIDTH = 1.4
"""Width of the lines in [px] (*ours*)."""


class ResponsePaths:
    """One dashed line a lane, changed in place; drawn true to scale and only then shown."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        """Draw below the node ``name``; a line is made when the first path for it comes."""
        self._scene = scene
        self._name = name
        self._lines: list[viser.LineSegmentsHandle] = []
        self._drawn = 0

    def draw(self, paths: Mapping[str, Array], lanes: Sequence[LaneStyle]) -> None:
        """Show the paths of the lanes that have one, none of the others.

        Args:
            paths: flange positions by lane in [m]. Shapes (m, 3).
            lanes: the lanes in order.
        """
        self._drawn = 0
        for lane in lanes:
            segments = dashes(paths[lane.name]) if lane.name in paths else np.zeros((0, 2, 3))
            if len(segments):
                line = self._line(self._drawn)
                line.points = segments.astype(np.float32)
                shade = [int(lane.color[i : i + 2], 16) for i in (1, 3, 5)]
                line.colors = np.array(shade, dtype=np.uint8)
                self._drawn += 1
        self.show(True)

    def show(self, visible: bool) -> None:
        """Show or hide what was drawn last."""
        for number, line in enumerate(self._lines):
            line.visible = visible and number < self._drawn

    def _line(self, number: int) -> viser.LineSegmentsHandle:
        if number == len(self._lines):
            line = self._scene.add_line_segments(
                f"{self._name}_{number}",
                np.zeros((1, 2, 3)),
                (0, 0, 0),
                thickness=WIDTH,
                thickness_units="screen",
                visible=False,
            )
            self._lines.append(line)
        return self._lines[number]
