"""What the last minute looked like: states to look back at and to branch off from."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from dataclasses import dataclass

import numpy as np

from slidetune.robot.kernels.workspace import CHANGE_Q, MEMORY_ROWS, STATE_ROWS, Q
from slidetune.robot.loop.closed_loop import ClosedLoop
from slidetune.robot.loop.lane import Freeze

Array = np.ndarray

MEMORY = slice(CHANGE_Q, CHANGE_Q + MEMORY_ROWS)
INTERVAL = 0.1
"""Simulated time between two recorded moments in [s] (*ours*)."""
LENGTH = 60.0
"""How far back one can look in [s] (*ours*)."""


@dataclass(frozen=True)
class Moment:
    """Every lane at one time.

    Attributes:
        time: simulated time in [s].
        states: angles, velocities and weights by lane. Shapes (12, 6).
        memories: what each lane remembered of its last step. Shapes (3, 6).
        freezes: why a lane stood still, by lane.
        begins: when each lane had begun in [s].
    """

    time: float
    states: dict[str, Array]
    memories: dict[str, Array]
    freezes: dict[str, Freeze | None]
    begins: dict[str, float]

    def angles(self) -> dict[str, Array]:
        """Return the joint angles by lane in [rad]. Shapes (6,)."""
        return {name: state[Q] for name, state in self.states.items()}


class Recorder:
    """Moments of the last minute of simulated time, a tenth of a second apart."""

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
        lanes = loop.lanes.items()
        self._moments.append(
            Moment(
                time,
                {name: lane.work[:STATE_ROWS].copy() for name, lane in lanes},
                {name: lane.work[MEMORY].copy() for name, lane in lanes},
                {name: lane.freeze for name, lane in lanes},
                {name: lane.began for name, lane in lanes},
            )
        )

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

        A lane that was not there yet keeps its state.
        """
        moment = self.at(time)
        if moment is None:
            return
        for name, lane in loop.lanes.items():
            if name in moment.states:
                lane.work[:STATE_ROWS] = moment.states[name]
                lane.work[MEMORY] = moment.memories[name]
                lane.freeze = moment.freezes[name]
                lane.began = moment.begins[name]
        loop.travel(moment.time)
        while self._moments and self._moments[-1].time >= moment.time:
            self._moments.pop()
        self._next = moment.time
