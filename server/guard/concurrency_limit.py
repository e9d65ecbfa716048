"""How many of something may be under way at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


class ConcurrencyLimit:
    """So many at once and no more, for one thread or one event loop."""

    def __init__(self, most: int, refusal: Callable[[], Exception]) -> None:
        """Begin with none under way.

        Args:
            most: how many may be under way at once.
            refusal: makes the error to raise for one more.
        """
        self._most = most
        self._refusal = refusal
        self.under_way = 0

    @contextmanager
    def one(self) -> Iterator[None]:
        """Count one for the time of a block.

        Raises:
            Exception: the refusal, if as many are under way as may be.
        """
        if self.under_way >= self._most:
            raise self._refusal()
        self.under_way += 1
        try:
            yield
        finally:
            self.under_way -= 1
