"""The process in which a hand-over is made.

It steps a thousand control periods in Python, and makes draws: the live session is not kept waiting
for that.
"""

from __future__ import annotations

import os
from typing import Any

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.handover.package import package
from slidetune.robot.handover.sampled_run import sampled_experiment
from slidetune.robot.handover.self_check import HandOverError
from slidetune.robot.study.robustness import robustness
from slidetune.server.compute.apart import answer_once
from slidetune.server.compute.executor import LocalExecutor

_THREADS = max(1, (os.cpu_count() or 2) - 1)
"""Threads that make the draws (*ours*): one core stays the live session's."""


def answered(asked: dict[str, Any]) -> dict[str, Any]:
    """Answer with a package's files, or with what is refused; see ``server.handover.apart``."""
    lane, count = asked["lane"], asked["draws"]
    try:
        experiment = Experiment.from_document(asked["experiment"])
        sampled = sampled_experiment(experiment, lane)
        with LocalExecutor(_THREADS) as executor:
            draws = list(robustness(sampled, lane, count, executor)) if count else []
        return {"files": package(experiment, lane, asked["controller"], draws).files}
    except InvalidExperimentError as error:
        fields = [[one.path, one.message] for one in error.fields]
        return {"fields": fields}
    except HandOverError as error:
        return {"refused": str(error)}


if __name__ == "__main__":
    answer_once(answered)
