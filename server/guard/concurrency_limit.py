"""How many of something may be under way at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Seats:
    """So many at once and no more. For one thread or one event loop."""

    def __init__(self, most: int, refusal: Callable[[], Exception]) -> None:
        """Begin with all of them free.

        Args:
            most: how many there are.
            refusal: makes the error to raise where none is free.
        """
        self._most = most
        self._refusal = refusal
        self.taken = 0

    @contextmanager
    def one(self) -> Iterator[None]:
        """Hold a seat for the time of a block.

        Raises:
            Exception: the refusal, if none is free.
        """
        if self.taken >= self._most:
            raise self._refusal()
        self.taken += 1
        try:
            yield
        finally:
            self.taken -= 1
