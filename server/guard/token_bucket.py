"""How often something may happen: a rate that may be exceeded for a moment after a rest."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic


class TokenBucket:
    """So many at once, refilled at a steady rate (a token bucket). For one thread."""

    def __init__(self, rate: float, burst: float, clock: Callable[[], float] = monotonic) -> None:
        """Begin full.

        Args:
            rate: how many a second in the long run [1/s].
            burst: how many at once after a rest, at least 1.
            clock: says the time in [s].
        """
        self._rate = rate
        self._burst = float(burst)
        self._clock = clock
        self._left = self._burst
        self._seen = clock()

    def take(self, count: float = 1.0) -> bool:
        """Take ``count`` if there are as many, and say whether there were."""
        self._refill()
        if self._left < count:
            return False
        self._left -= count
        return True

    def wait(self) -> float:
        """Take one, from the future if need be, and return the time until it is due in [s]."""
        self._refill()
        self._left -= 1.0
        return max(0.0, -self._left / self._rate)

    def _refill(self) -> None:
        now = self._clock()
        self._left = min(self._burst, self._left + self._rate * (now - self._seen))
        self._seen = now
