"""A progress bar while kernels are compiled."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn

from slidetune.robot.arm.known import SHIPPED, arm_named
from slidetune.robot.kernels.compiler import is_warm
from slidetune.robot.loop.warmup import warm_up, warm_up_arm


def warm_up_with_bar(console: Console, model: str = SHIPPED) -> None:
    """Compile every kernel; silent when they are compiled already.

    Args:
        console: where to say it.
        model: name of an arm whose number of joints they are for as well.
    """
    _warm_up_shipped(console)
    joints = arm_named(model).joints
    if is_warm(joints):
        warm_up_arm(model)
        return
    console.print(f"Compiling them for an arm with another number of joints, {joints} (once) …")
    with Progress(BarColumn(), TimeElapsedColumn(), console=console, transient=True) as progress:
        progress.add_task("kernels", total=None)
        warm_up_arm(model)


def _warm_up_shipped(console: Console) -> None:
    if is_warm():
        warm_up()
        return
    columns = (MofNCompleteColumn(), BarColumn(), TimeElapsedColumn())
    console.print("Compiling the control laws (once for this version, about half a minute) …")
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("kernels", total=None)

        def show(number: int, total: int) -> None:
            progress.update(task, completed=number, total=total)

        warm_up(show)
