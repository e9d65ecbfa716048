"""Where the flange should go: a dashed line over the horizon, and a ball where it should be now."""

from __future__ import annotations

import numpy as np
import viser

from slidetune.server.scene.viewer import GREY

Array = np.ndarray

DASH = 0.016
"""Length of a dash and of the gap after it in [m] (*ours*)."""
PIECES = 800
"""Most dashes and gaps (*ours*); on a longer path each is longer."""
BALL = 0.011
"""Radius of the ball in [m] (*ours*)."""


def dashes(path: Array) -> Array:
    """Cut a path into dashes of one length, once where it runs over itself.

    Args:
        path: points in [m]. Shape (m, 3).

    Returns:
        First and last point of each dash in [m]. Shape (n, 2, 3), empty for a path of no length.
    """
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    count = min(PIECES, int(along[-1] / DASH))
    if count == 0:
        return np.zeros((0, 2, 3))
    ends = np.linspace(0.0, along[-1], count + 1)
    points = np.stack([np.interp(ends, along, path[:, axis]) for axis in range(3)], axis=-1)
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    kept: Array = pieces[(np.arange(count) % 2 == 0) & ~_repeats(pieces, along[-1] / count)]
    return kept


def _repeats(pieces: Array, length: float) -> Array:
    """Return which pieces lie where an earlier one, not just before, already is. Shape (n,)."""
    middles = pieces.mean(axis=1)
    squares = np.einsum("ij,ij->i", middles, middles)
    apart = squares[:, None] + squares - 2.0 * middles @ middles.T
    there: Array = np.tril(apart < (0.6 * length) ** 2, -3).any(axis=1)
    return there


class DesiredPath:
    """The desired path on the screen."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        """Make its nodes below ``name``, the line hidden until there is a path."""
        self._path = np.zeros((0, 3))
        self._line = scene.add_line_segments(
            f"{name}/path",
            np.zeros((1, 2, 3)),
            GREY,
            thickness=1.6,
            thickness_units="screen",
            visible=False,
        )
        self._ball = scene.add_icosphere(
            f"{name}/now", BALL, GREY, subdivisions=2, cast_shadow=False, receive_shadow=False
        )

    def draw(self, path: Array) -> None:
        """Show the path over the horizon in [m]. Shape (m, 3)."""
        if np.array_equal(path, self._path):
            return
        self._path = np.array(path)
        segments = dashes(self._path)
        self._line.visible = len(segments) > 0
        if len(segments):
            self._line.points = segments

    def mark(self, flange: Array) -> None:
        """Put the ball where the flange should be now in [m]. Shape (3,)."""
        self._ball.position = flange
