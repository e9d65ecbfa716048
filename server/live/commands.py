"""What the live session was asked for and hasn't done yet: in order, and never without end."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from threading import Lock

from slidetune.server.guard.limits import SessionBusyError

Request = Callable[[], None]

MOST_STEPS = 4000
"""Most steps that wait (*ours*): four seconds of time at 1 kHz."""
MOST_COMMANDS = 1000
"""Most commands that wait (*ours*): four seconds of a client's at full speed."""


@dataclass(frozen=True)
class _Latest:
    """A request that the next of its kind makes needless."""

    request: Request


class Commands:
    """A queue of requests and of steps. For any thread."""

    def __init__(self) -> None:
        """Begin empty."""
        self._lock = Lock()
        self._queue: deque[Request | _Latest | int] = deque()
        self._steps = 0

    @property
    def steps(self) -> int:
        """How many steps wait; what is asked for now comes after them."""
        return self._steps

    def refuse_if_full(self) -> None:
        """Refuse one command more than may wait.

        Raises:
            SessionBusyError: saying what to do.
        """
        if len(self._queue) >= MOST_COMMANDS:
            text = f"{MOST_COMMANDS} commands are waiting for the live session already"
            raise SessionBusyError(f"{text}: try again in a moment, or pause it")

    def add(self, request: Request, instead_of_steps: bool = False) -> None:
        """Put a request at the end, after the steps that wait or instead of them."""
        with self._lock:
            if instead_of_steps:
                self._drop_steps()
            self._queue.append(request)

    def add_latest(self, request: Request) -> None:
        """Put a request at the end; of several in a row the last counts."""
        with self._lock:
            if self._queue and isinstance(self._queue[-1], _Latest):
                self._queue.pop()
            self._queue.append(_Latest(request))

    def add_steps(self, count: int) -> None:
        """Put steps at the end; more than may wait are left out."""
        with self._lock:
            count = min(count, MOST_STEPS - self._steps)
            self._steps += count
            if self._queue and isinstance(self._queue[-1], int):
                count += self._queue.pop()  # type: ignore[operator]
            if count:
                self._queue.append(count)

    def drop_steps(self) -> None:
        """Forget the steps that wait."""
        with self._lock:
            self._drop_steps()

    def take(self, most: int) -> Request | int | None:
        """Take what comes next: a request, a number of steps up to ``most``, or nothing."""
        with self._lock:
            if not self._queue:
                return None
            first = self._queue.popleft()
            if isinstance(first, _Latest):
                return first.request
            if not isinstance(first, int):
                return first
            taken = min(first, most)
            self._steps -= taken
            if first > taken:
                self._queue.appendleft(first - taken)
            return taken

    def _drop_steps(self) -> None:
        self._queue = deque(entry for entry in self._queue if not isinstance(entry, int))
        self._steps = 0
