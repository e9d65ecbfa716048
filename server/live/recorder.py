"""What the last minute looked like: states to look back at and to branch off from."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from dataclasses import dataclass

import numpy as np

from slidetune.robot.kernels.workspace import Q
from slidetune.robot.loop.closed_loop import ClosedLoop, LoopState
from slidetune.robot.loop.lane import Freeze

Array = np.ndarray

INTERVAL = 0.1
"""Simulated time between two recorded moments in [s] (*ours*)."""
LENGTH = 60.0
"""How far back one can look in [s] (*ours*)."""


@dataclass(frozen=True)
class Moment:
    """Every lane at one time.

    Attributes:
        state: what to go back to.
    """

    state: LoopState

    @property
    def time(self) -> float:
        """Simulated time in [s]."""
        return self.state.time

    @property
    def freezes(self) -> dict[str, Freeze | None]:
        """Why a lane stood still, by lane."""
        return {name: lane.freeze for name, lane in self.state.lanes.items()}

    def angles(self) -> dict[str, Array]:
        """Return the joint angles by lane in [rad]. Shapes (6,)."""
        return {name: lane.state[Q] for name, lane in self.state.lanes.items()}


class Recorder:
    """Moments of the last minute of simulated time, a tenth of a second apart.

    One takes about 2 kB a lane, and 48 bytes more for every torque that waits for an input delay:
    24 kB more a lane at the greatest delay and the fastest control rate, where the minute of six
    lanes takes 94 MB instead of 8 MB.
    """

    def __init__(self) -> None:
        """Begin with nothing recorded."""
        self._moments: deque[Moment] = deque(maxlen=round(LENGTH / INTERVAL))
        self._next = 0.0

    def clear(self) -> None:
        """Forget everything: time is 0 again."""
        self._moments.clear()
        self._next = 0.0

    def look(self, loop: ClosedLoop) -> None:
        """Record the present, if it is time; costs next to nothing otherwise."""
        time = loop.time
        if time < self._next:
            return
        self._next = time + INTERVAL - 1e-9
        self._moments.append(Moment(loop.state()))

    def span(self) -> tuple[float, float] | None:
        """Return the first and the last recorded time in [s], ``None`` where there is nothing."""
        moments = tuple(self._moments)
        return (moments[0].time, moments[-1].time) if moments else None

    def at(self, time: float) -> Moment | None:
        """Return the last moment not after ``time`` [s], else the first, or ``None``."""
        moments = tuple(self._moments)
        if not moments:
            return None
        index = bisect_right([moment.time for moment in moments], time + 1e-9)
        return moments[max(index - 1, 0)]

    def restore(self, loop: ClosedLoop, time: float) -> None:
        """Put every lane back to where it was at ``time`` [s] and forget what came after.

        What follows is what followed then, to the last bit, as long as the experiment is the same.
        A lane that was not there yet keeps its state.
        """
        moment = self.at(time)
        if moment is None:
            return
        loop.restore(moment.state)
        while self._moments and self._moments[-1].time >= moment.time:
            self._moments.pop()
        self._next = moment.time
