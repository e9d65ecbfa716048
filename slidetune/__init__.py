"""Sliding-mode control of a robot arm: experiments, runs, and the dashboard to tune them on.

`slidetune` is the one import name. The links beside this file stand for the folders of the same
names at the top of the repository; in a wheel the folders themselves are here.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from slidetune.robot import Experiment, Run, __version__, load_preset, save_preset, simulate
from slidetune.robot.shown import draw_shown_by

if TYPE_CHECKING:
    from slidetune.server.client.dashboard import Dashboard
    from slidetune.server.notebook.tuned import Tuned

__all__ = [
    "Experiment",
    "Run",
    "__version__",
    "connect",
    "load_preset",
    "save_preset",
    "simulate",
    "tune",
]


def connect(address: str = "http://127.0.0.1:8000/", token: str | None = None) -> Dashboard:
    """Connect to a dashboard that runs.

    Args:
        address: as the server printed it, with its ``?token=…`` where it has one.
        token: in place of that in the address.

    Raises:
        DashboardError: if no Slidetune answers there, or the token is refused.
    """
    from slidetune.server.client.dashboard import Dashboard  # HTTP is of no use to a run

    return Dashboard(address, token)


def tune(
    experiment: Experiment,
    lane: str | None = None,
    *,
    gains: Mapping[str, tuple[float, float] | Mapping[str, Any]] | None = None,
    trials: int | None = None,
    draws: int | None = None,
    sampler: str | None = None,
    judged_by: str | None = None,
    quiet: bool | None = None,
    seed: int | None = None,
    workers: int | None = None,
    progress: Callable[[Tuned], object] | None = None,
) -> Tuned:
    """Search for the gains of a lane that keep to the experiment's goals.

    The command ``slidetune tune`` makes the same trials: a seed gives the same ones, on however
    many threads. Interrupted (Ctrl-C, or the stop of a notebook) it returns what is done.

    Args:
        experiment: what to tune; it must have a goal.
        lane: whose gains; by default the first lane's.
        gains: those that are searched, by name, each with its least and greatest value in its own
            unit, ``{"nu": (0.5, 50)}``, or a mapping with ``low``, ``high`` and, for gains of six
            values, ``joints``: ``"alike"`` (in proportion) or ``"each"``. By default every gain
            that acts, from a tenth of its value to ten times.
        trials: how many sets of gains are tried, the present one first; by default 200.
        draws: how many draws of what is uncertain judge each set, 0 for the experiment as it is; by
            default 50 where anything is uncertain.
        sampler: ``cmaes`` (the default), ``tpe``, ``nsga2`` or ``sobol``.
        judged_by: the draw that counts, ``p95`` (the default) or ``worst``.
        quiet: whether gains that chatter more than the present ones are never the best; by default
            they are not.
        seed: by default 1.
        workers: threads that make the runs; by default one a core.
        progress: called after each trial with what is found so far; ``print`` will do.

    Raises:
        InvalidExperimentError: before anything runs, naming every refused field: there is no such
            lane or gain, no goal, nothing uncertain to draw from.
    """
    with warnings.catch_warnings():
        # What Optuna imports misses a widget for progress bars in notebooks; none is shown here.
        warnings.filterwarnings("ignore", "IProgress not found")
        from slidetune.server.notebook import tune as notebook  # samplers are of no use to a run

    told = {
        "lane": lane,
        "trials": trials,
        "sampler": sampler,
        "draws": draws,
        "judged_by": judged_by,
        "seed": seed,
        "quiet": quiet,
    }
    return notebook.tune(experiment, gains, workers, progress, told)


def _drawn(shown: object) -> dict[str, Any]:
    from slidetune.server.notebook.display import drawn  # whoever shows nothing draws nothing

    return drawn(shown)


draw_shown_by(_drawn)
