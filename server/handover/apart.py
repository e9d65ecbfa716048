"""A hand-over of a live lane, made in a process of its own."""

from __future__ import annotations

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.handover.choices import check_exportable, portable
from slidetune.robot.handover.gains_file import check_controller
from slidetune.robot.handover.sampled_run import sampled_experiment
from slidetune.robot.handover.self_check import HandOverError
from slidetune.server.compute.apart import LostProcessError, ask_apart
from slidetune.server.compute.run_cost import MOST_ARM_STEPS, arm_steps

_MODULE = "slidetune.server.handover.child"
_LIMIT = 180.0
"""Longest time that one may take in [s] (*ours*): the most that is allowed takes some 20."""
_RUNS = 3
"""Runs of a package besides its draws: its own, their errors', and the continuous one."""


def check_hand_over(experiment: Experiment, lane: str, controller: str, draws: int) -> int:
    """Refuse what can't be handed over; return how many draws there will be.

    Args:
        experiment: the live experiment.
        lane: which of its lanes.
        controller: name of the controller.
        draws: how many draws were asked for; none where nothing is uncertain.

    Raises:
        InvalidExperimentError: naming what is refused, also what would take too long.
    """
    check_exportable(experiment, lane)
    check_controller(controller)
    count = draws if experiment.uncertainty.uncertain else 0
    steps = arm_steps(sampled_experiment(experiment, lane))
    if (count + _RUNS) * steps > MOST_ARM_STEPS:
        text = (
            f"{count} draws take {(count + _RUNS) * steps:,} steps of the arm; beside the live "
            f"session at most {MOST_ARM_STEPS:,} are allowed: ask for fewer draws, shorten the "
            "horizon, or run it separately: python -m slidetune export"
        )
        raise InvalidExperimentError([FieldError("draws", text, draws)])
    return count


def hand_over_apart(
    experiment: Experiment, lane: str, controller: str, draws: int
) -> dict[str, str]:
    """Return the files of a package, by name.

    Args:
        experiment: the experiment; lanes with laws of one's own are left out.
        lane: which of its lanes.
        controller: name of the controller.
        draws: what ``check_hand_over`` returned.

    Raises:
        InvalidExperimentError: if something of it can't be handed over.
        HandOverError: if the loop leaves its bounds at once, or it took too long.
    """
    asked = {
        "experiment": portable(experiment).document(),
        "lane": lane,
        "controller": controller,
        "draws": draws,
    }
    try:
        answer = ask_apart(_MODULE, asked, _LIMIT)
    except LostProcessError as error:
        raise HandOverError(f"{lane} can't be handed over: what makes it {error.text}") from error
    if "fields" in answer:
        raise InvalidExperimentError([FieldError(path, text) for path, text in answer["fields"]])
    if "refused" in answer:
        raise HandOverError(answer["refused"])
    files: dict[str, str] = answer["files"]
    return files
