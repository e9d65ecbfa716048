"""``slidetune.tune``: the search that the command ``tune`` makes, called from Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.tune import Trial
from slidetune.robot.study.tune import tune as search
from slidetune.server.compute.executor import local_executor
from slidetune.server.notebook.tuned import Tuned
from slidetune.server.report.study_file import wanted_tuning

MOST_WORKERS = 1024
"""Threads of one search (*ours*)."""


def tune(
    experiment: Experiment,
    gains: Mapping[str, Any] | None,
    workers: int | None,
    progress: Callable[[Tuned], object] | None,
    told: Mapping[str, Any],
) -> Tuned:
    """Search for gains; see ``slidetune.tune``.

    Args:
        experiment: whose goals count.
        gains: ranges of those that are searched.
        workers: threads, ``None`` for one a core.
        progress: called with what is found so far.
        told: the other fields of ``robot.study.tuning.Tuning``, ``None`` for those not given.
    """
    ranges = None if gains is None else {name: _range(name, one) for name, one in gains.items()}
    settings = wanted_tuning(experiment, "", {**told, "gains": ranges})
    made: list[Trial] = []
    interrupted = False
    with local_executor(_workers(workers)) as executor:
        try:
            for trial in search(experiment, settings, executor):
                made.append(trial)
                if progress is not None:
                    progress(Tuned(experiment, settings, tuple(made)))
        except KeyboardInterrupt:
            executor.shutdown(wait=False, cancel_futures=True)
            if not made:
                raise
            interrupted = True
        except BaseException:
            executor.shutdown(wait=False, cancel_futures=True)
            raise
    return Tuned(experiment, settings, tuple(made), interrupted)


def _range(name: str, given: Any) -> Any:
    """Return a range as ``GainRange`` reads it; a pair is its least and its greatest value."""
    if not isinstance(given, tuple | list | np.ndarray):
        return given
    if len(given) != 2:
        text = f"must be a pair (least, greatest) or a mapping with low and high, got {given!r}"
        raise InvalidExperimentError([FieldError(f"gains.{name}", text)])
    low, high = (one.item() if isinstance(one, np.generic) else one for one in given)
    return {"low": low, "high": high}


def _workers(given: int | None) -> int | None:
    if given is None:
        return None
    if isinstance(given, bool) or not isinstance(given, int) or not 1 <= given <= MOST_WORKERS:
        text = f"must be a number of threads in [1, {MOST_WORKERS}] or None, got {given!r}"
        raise InvalidExperimentError([FieldError("workers", text)])
    return given
