"""A progress bar while kernels are compiled."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from slidetune.robot.kernels.compiler import is_warm
from slidetune.robot.loop.warmup import warm_up


def warm_up_with_bar(console: Console) -> None:
    """Compile every kernel; silent when they are compiled already."""
    if is_warm():
        warm_up()
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    console.print("Compiling the control laws (once for this version, about a minute) …")
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("")

        def show(number: int, total: int, name: str) -> None:
            progress.update(task, completed=number, total=total, description=name)

        warm_up(show)
