"""A fit with a progress bar."""

from __future__ import annotations

from rich.console import Console

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.fit import Fitting, FitTrial, fit
from slidetune.server.compute.executor import local_executor
from slidetune.server.report.run_bar import progress_bar
from slidetune.server.report.warmup_bar import warm_up_with_bar


def fit_with_bar(
    experiment: Experiment, fitting: Fitting, workers: int, console: Console
) -> list[FitTrial]:
    """Fit; raises what ``fit`` raises."""
    warm_up_with_bar(console)
    made: list[FitTrial] = []
    with local_executor(workers or None) as executor:
        trials = fit(experiment, fitting, executor)
        with progress_bar(console, "Fitting") as show:
            for trial in trials:
                made.append(trial)
                show(len(made) / fitting.trials)
    return made
