"""Headless runs with a progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.kernels.compiler import is_warm
from slidetune.robot.loop.simulate import Run, simulate


@contextmanager
def progress_bar(console: Console, text: str) -> Iterator[Callable[[float], None]]:
    """Show a bar while the block lasts; yield a call that takes the share done, 0 to 1.

    Nothing is shown where the console is no screen.
    """
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as progress:
        task = progress.add_task(text, total=1.0)
        yield lambda share: progress.update(task, completed=share)


def simulate_with_bar(experiment: Experiment, console: Console) -> Run:
    """Run an experiment; raises what ``simulate`` raises."""
    if not is_warm():
        console.print("Compiling what is not compiled yet (once for this version) …")
    with progress_bar(console, "Simulating") as show:
        return simulate(experiment, show)


def simulate_presets(names: Sequence[str], console: Console) -> dict[str, Run]:
    """Run several presets; raises what ``load_preset`` and ``simulate`` raise."""
    experiments = {name: load_preset(name) for name in names}
    return {name: simulate_with_bar(item, console) for name, item in experiments.items()}
