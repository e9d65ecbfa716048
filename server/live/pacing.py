"""How simulated time keeps pace with the wall's, and says so when it can't."""

from __future__ import annotations

import os
import sys
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import get_native_id
from time import perf_counter

TICK = 0.01
"""Wall time between two ticks in [s] (*ours*): a slider's effect waits at most for one."""
BUSY = 0.7
"""Greatest share of a tick that may go into stepping (*ours*)."""
WINDOW = 1.0
"""Wall time over which the real-time factor is measured in [s] (*ours*)."""
LONGEST = 0.25
"""Most wall time that is caught up after a shortage in [s]; a suspended process isn't (*ours*)."""
STALL = 1.0
"""Wall time without a tick in [s] from which people are told of it (*ours*)."""


class Pacer:
    """A budget of simulated time that grows with the wall's and is spent by steps.

    Attributes:
        speed: simulated seconds a wall second.
        capped: whether steps were lately too slow for the speed and debt was dropped.
        stalled: wall time that passed without a tick before this one in [s], 0 where that is
            nothing to speak of: the process was suspended, or kept from the processor.
    """

    def __init__(self, clock: Callable[[], float] = perf_counter) -> None:
        """Start with an empty budget at speed 1."""
        self.speed = 1.0
        self._clock = clock
        self.restart()

    def restart(self) -> None:
        """Forget the budget and the measurements, as after a pause."""
        self.capped = False
        self.stalled = 0.0
        self._capped_at = -1e9
        self._budget = 0.0
        self._simulated = 0.0
        self._last = self._clock()
        self._marks: deque[tuple[float, float]] = deque([(self._last, 0.0)])

    def begin(self) -> float:
        """Start a tick: let the budget grow; return the wall time by which stepping must end."""
        now = self._clock()
        gap = now - self._last
        if gap > LONGEST:
            self._capped_at = now
        self.stalled = gap if gap > STALL else 0.0
        self._budget += min(gap, LONGEST) * self.speed
        self._last = now
        return now + BUSY * TICK

    def affords(self, period: float) -> bool:
        """Say whether the budget holds one more step of ``period`` [s]."""
        return self._budget >= period

    def spend(self, period: float) -> None:
        """Take one step of ``period`` [s] from the budget."""
        self._budget -= period
        self._simulated += period

    def overdue(self, deadline: float) -> bool:
        """Say whether the tick's time is up."""
        return self._clock() >= deadline

    def end(self, period: float) -> None:
        """End a tick: drop what couldn't be stepped and measure."""
        now = self._clock()
        # A short shortage is made up for in the next ticks; more is a debt that is never paid.
        allowed = max(period, LONGEST * self.speed)
        if self._budget > allowed:
            self._budget = allowed
            self._capped_at = now
        self.capped = now - self._capped_at < WINDOW
        self._marks.append((now, self._simulated))
        while len(self._marks) > 2 and now - self._marks[0][0] > WINDOW:
            self._marks.popleft()

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds a wall second, over the last second."""
        (begin, before), (end, after) = self._marks[0], self._marks[-1]
        return (after - before) / (end - begin) if end > begin else 0.0

    def rest(self) -> float:
        """Return how long to sleep until the next tick in [s]."""
        return max(0.0, self._last + TICK - self._clock())


def come_first() -> None:
    """Ask for this thread to be scheduled before others, where the system grants it."""
    if sys.platform == "linux":
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, get_native_id(), -10)
