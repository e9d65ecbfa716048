"""Where the flange has been: a fixed number of points a lane, and the line through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import viser

from slidetune.server.scene.exaggeration import exaggerated_positions

Array = np.ndarray

SPAN = 6.0
"""How far back a trail reaches in simulated [s] (*ours*): nearly a period of the paper's sine."""
POINTS = 240
"""Points of a trail (*ours*): 25 ms apart."""


@dataclass(frozen=True)
class Stretch:
    """What a lane did between two pictures.

    Attributes:
        desired: desired flange positions in [m]. Shape (k, 3).
        actual: true flange positions in [m]. Shape (k, 3).
        q_d: desired angles in the last picture and in this one in [rad]. Shape (2, n).
        q: true angles in the last picture and in this one in [rad]. Shape (2, n).
        period: time between the rows in [s].
    """

    desired: Array
    actual: Array
    q_d: Array
    q: Array
    period: float


class Trail:
    """The last points of one flange, oldest first.

    Attributes:
        points: where they are drawn in [m]; the oldest is repeated until there are enough.
            Shape (``POINTS``, 3).
        empty: whether there is none.
    """

    def __init__(self, places: Array) -> None:
        """Begin without points.

        Args:
            places: the arm for ``flange_positions``. Shape (n + 1, 13).
        """
        self._places = places
        self.points = np.zeros((POINTS, 3))
        self._desired = np.zeros((POINTS, 3))
        self._actual = np.zeros((POINTS, 3))
        self._q_d = np.zeros((POINTS, len(places) - 1))
        self._q = np.zeros((POINTS, len(places) - 1))
        self._factor = 1.0
        self.clear()

    def clear(self) -> None:
        """Forget all points."""
        self.empty = True
        self._skip = 0

    def extend(self, stretch: Stretch, factor: float) -> None:
        """Append what was done since the last picture, thinned out to the trail's spacing.

        Args:
            stretch: what was done.
            factor: how many times deviations are drawn.
        """
        self.stretch_to(factor)
        rows = self._chosen(len(stretch.actual), stretch.period)
        if not len(rows):
            return
        share = ((rows + 1) / len(stretch.actual))[:, None]
        new = (
            stretch.desired[rows],
            stretch.actual[rows],
            stretch.q_d[0] + share * (stretch.q_d[1] - stretch.q_d[0]),
            stretch.q[0] + share * (stretch.q[1] - stretch.q[0]),
        )
        rings = (self._desired, self._actual, self._q_d, self._q)
        for ring, values in zip(rings, new, strict=True):
            self._append(ring, values)
        self._append(self.points, exaggerated_positions(*new, factor, self._places))
        self.empty = False

    def _chosen(self, count: int, period: float) -> Array:
        stride = max(1, round(SPAN / POINTS / period))
        rows = np.arange(min(self._skip, stride - 1), count, stride)
        self._skip = int(rows[-1]) + stride - count if len(rows) else self._skip - count
        return rows[-POINTS:]

    def _append(self, ring: Array, values: Array) -> None:
        if self.empty:
            ring[:] = values[0]
        count = len(values)
        ring[:-count] = ring[count:].copy()
        ring[-count:] = values

    def stretch_to(self, factor: float) -> None:
        """Draw all points with deviations ``factor`` times as large."""
        if factor != self._factor:
            self._factor = factor
            rings = (self._desired, self._actual, self._q_d, self._q)
            self.points[:] = exaggerated_positions(*rings, factor, self._places)


class TrailLine:
    """One line on the screen for a trail, moved in place: it never becomes another node."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        """Make the line, hidden.

        Args:
            scene: where to draw.
            name: the line's node.
        """
        self._line = scene.add_line_segments(
            name,
            np.zeros((POINTS, 2, 3)),
            np.zeros((POINTS, 2, 3), dtype=np.uint8),
            thickness_units="screen",
            visible=False,
        )

    def style(self, color: tuple[int, int, int], faded: tuple[int, int, int], width: float) -> None:
        """Give the line a colour and a width.

        Args:
            color: sRGB of its young end.
            faded: sRGB of its old end.
            width: in [px].
        """
        young = np.minimum(1.0, np.linspace(0.0, 2.0, POINTS + 1))[:, None]
        shades = np.asarray(faded) + young * (np.asarray(color) - np.asarray(faded))
        self._line.colors = _segments(_linear(shades)).round().astype(np.uint8)
        self._line.thickness = width

    def show(self, trail: Trail, head: Array) -> None:
        """Draw a trail up to where the flange is drawn now. Shape of ``head`` (3,), in [m]."""
        if not trail.empty:
            self._line.points = _segments(np.vstack([trail.points, head]))
        self._line.visible = not trail.empty

    def hide(self) -> None:
        """Take the line off the screen."""
        self._line.visible = False


def _segments(vertices: Array) -> Array:
    """Return each vertex with the next. Shape (n + 1, 3) to (n, 2, 3)."""
    return np.stack([vertices[:-1], vertices[1:]], axis=1)


def _linear(shades: Array) -> Array:
    """Turn sRGB into linear light, both in 0..255: Viser takes the colours of points for that."""
    share = shades / 255.0
    low = share <= 0.04045
    light: Array = 255.0 * np.where(low, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return light
