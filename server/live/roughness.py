"""Tells which lanes of the live session take longer steps than their own error allows."""

from __future__ import annotations

from slidetune.robot.kernels.workspace import CAPPED, UNSOLVED
from slidetune.robot.loop.closed_loop import ClosedLoop

WINDOW = 1.0
"""Simulated time in [s] over which rough rows are counted (*ours*)."""
WORTH_TELLING = 0.02
"""Share of rough rows from which on they are told of (*ours*): a start alone is not."""


class Roughness:
    """Share of each lane's last rows whose steps were not cut, or not solved, as they ask for.

    A whole run cuts a step until its error holds; the live session has to keep its pace.
    """

    def __init__(self) -> None:
        """Know of nothing."""
        self.restart()

    def restart(self) -> None:
        """Forget everything."""
        self._share: dict[str, float] = {}
        self._counted: dict[str, float] = {}
        self._since = 0

    def look(self, loop: ClosedLoop) -> None:
        """Count anew, once a window; on the session's thread, after its steps."""
        rows = loop.number - self._since
        if rows * loop.period < WINDOW and rows >= 0:
            return
        counted = {
            name: float(lane.work[CAPPED, 0] + lane.work[UNSOLVED, 0])
            for name, lane in loop.lanes.items()
        }
        # Below 0 the session went back in time: what was counted belongs to no rows that are left.
        self._share = {
            name: (count - self._counted.get(name, 0.0)) / rows
            for name, count in counted.items()
            if rows > 0
        }
        self._counted, self._since = counted, loop.number

    def remark(self, name: str) -> str | None:
        """Say in words that a lane's live curves are approximate, or ``None``."""
        share = self._share.get(name, 0.0)
        if share < WORTH_TELLING:
            return None
        return (
            f"{min(share, 1.0):.0%} of its live steps are longer than their local error allows, so "
            "its live curves are approximate. Response subdivides such steps as needed; here a "
            "shorter step helps."
        )
