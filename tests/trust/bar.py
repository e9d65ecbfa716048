"""One line that says what a long script does now, and how far it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NotYet
from contextlib import contextmanager
from time import perf_counter
from typing import TypeVar

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

Result = TypeVar("Result")


class Bar:
    """Shows a text and a share; where the console is no screen, each new text once."""

    def __init__(self, console: Console, progress: Progress) -> None:
        self._console = console
        self._progress = progress
        self._task = progress.add_task("", total=1.0)
        self._text = ""

    def show(self, text: str, share: float) -> None:
        """Say what is being done, and which share of it, 0 to 1."""
        if text != self._text and not self._console.is_terminal:
            self._console.print(text)
        self._text = text
        self._progress.update(self._task, description=text, completed=min(share, 1.0))

    def follow(self, text: str, seconds: float, future: Future[Result]) -> Result:
        """Wait for a task that takes about so long; raise what it raises."""
        begin = perf_counter()
        while True:
            self.show(text, (perf_counter() - begin) / seconds)
            try:
                return future.result(timeout=0.2)
            except NotYet:
                if future.done():
                    raise

    def wait(self, text: str, seconds: float, done: Callable[[], bool] = lambda: False) -> bool:
        """Wait for a condition, at most so long; return whether it holds."""
        begin = perf_counter()
        pause = Future[None]()
        while (passed := perf_counter() - begin) < seconds:
            if done():
                return True
            self.show(text, passed / seconds)
            try:
                pause.result(timeout=min(0.2, seconds - passed))
            except NotYet:
                continue
        return done()


@contextmanager
def progress(console: Console) -> Iterator[Bar]:
    """Show a bar while the block lasts."""
    columns = (BarColumn(), TimeElapsedColumn(), TextColumn("{task.description}"))
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as shown:
        yield Bar(console, shown)
