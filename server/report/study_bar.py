"""Studies with a progress bar: what is best so far, and how long is left."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from functools import partial
from typing import TypeVar

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
)

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.robustness import Draw, robustness, worst_case
from slidetune.robot.study.sweep import Axis, Point, sweep
from slidetune.robot.study.tune import Trial, best_of, tune
from slidetune.robot.study.tuning import Tuning
from slidetune.server.compute.cluster import cluster_executor
from slidetune.server.compute.cluster_task import ClusterError
from slidetune.server.compute.executor import local_executor
from slidetune.server.report.study_report import ratio_text
from slidetune.server.report.warmup_bar import warm_up_with_bar

Item = TypeVar("Item")


@contextmanager
def study_executor(workers: int, scheduler: str, console: Console) -> Iterator[Executor]:
    """Return where a study's runs are made, warm.

    Args:
        workers: threads of this machine, 0 for one a core.
        scheduler: address of a cluster's scheduler, or an empty text for this machine.
        console: told of what becomes of the cluster, above any progress bar.

    Raises:
        InvalidExperimentError: if the cluster is refused; see ``cluster_executor``.
    """
    if scheduler:
        tell = partial(console.print, markup=False, soft_wrap=True)
        with cluster_executor(scheduler, tell) as executor:
            yield executor
        return
    warm_up_with_bar(console)
    with local_executor(workers or None) as executor:
        yield executor


@contextmanager
def _bar(console: Console, text: str, total: int) -> Iterator[tuple[Progress, TaskID]]:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as progress:
        yield progress, progress.add_task(text, total=total)


def search_with_bar(
    experiment: Experiment, tuning: Tuning, executor: Executor, console: Console
) -> tuple[list[Trial], ClusterError | None]:
    """Search; an interrupt or the loss of the cluster ends it and keeps what is done.

    Raises what ``tune`` raises.

    Returns:
        The trials, and what was lost of the cluster.
    """
    made: list[Trial] = []
    search = tune(experiment, tuning, executor)
    with _bar(console, "Searching", tuning.trials) as (progress, task):
        try:
            for trial in search:
                made.append(trial)
                best = best_of(made)
                score = None if best is None else best.outcome.score
                told = "" if score is None else f", best {ratio_text(score, 3)}"
                progress.update(task, completed=len(made), description=f"Searching{told}")
        except KeyboardInterrupt:
            executor.shutdown(wait=False, cancel_futures=True)
            console.print(f"Stopped after {len(made)} trials; what is done is kept.")
        except ClusterError as error:
            return made, error
    return made, None


def draws_with_bar(
    experiment: Experiment, lane: str, count: int, worst: int, executor: Executor, console: Console
) -> tuple[list[Draw], list[Draw]]:
    """Return draws and, where asked for, the places of a search for the worst.

    Raises what ``robustness`` raises.
    """
    drawn = robustness(experiment, lane, count, executor)
    tried = worst_case(experiment, lane, worst, executor) if worst else iter(())
    return (
        _followed(drawn, "Drawing", count, console),
        _followed(tried, "Looking for the worst", worst, console),
    )


def sweep_with_bar(
    experiment: Experiment, lane: str, axes: Sequence[Axis], executor: Executor, console: Console
) -> list[Point]:
    """Run a sweep; raises what ``sweep`` raises."""
    count = 1
    for one in axes:
        count *= len(one.values)
    return _followed(sweep(experiment, lane, axes, executor), "Sweeping", count, console)


def _followed(items: Iterator[Item], text: str, count: int, console: Console) -> list[Item]:
    made: list[Item] = []
    if not count:
        return made
    with _bar(console, text, count) as (progress, task):
        for item in items:
            made.append(item)
            progress.update(task, completed=len(made))
    return made
