"""What a whole run costs beside the live session, told before it is begun."""

from __future__ import annotations

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import Experiment

MOST_ARM_STEPS = 8_000_000
"""Most steps of the arm in one lane's run (*ours*): four times the longest run there is, at the
usual ten in a control period; some 6 s. Others wait for as long as a lane takes. One whose steps
can't be solved may take some ten times as long; see ``robot.integrator.cutting``."""
_SECONDS = 7.5e-7
"""Time of a step of the arm with the run that estimates its error in [s] (*ours*, measured)."""


def arm_steps(experiment: Experiment) -> int:
    """Return how many steps the arm makes in one lane's run."""
    simulation = experiment.simulation
    return (simulation.rows - 1) * (
        simulation.plant_substeps if simulation.mode == "sampled" else 1
    )


def refuse_if_costly(experiment: Experiment) -> None:
    """Refuse a run that would keep the workers from everybody else.

    Raises:
        InvalidExperimentError: with what it would cost, the limit and the way out.
    """
    steps = arm_steps(experiment)
    if steps <= MOST_ARM_STEPS:
        return
    lanes = len(experiment.lanes)
    text = (
        f"takes {steps:,} steps of the arm in each of {lanes} lanes, about "
        f"{lanes * steps * _SECONDS:,.0f} s in total; beside the live session at most "
        f"{MOST_ARM_STEPS:,} are allowed: lower plant_substeps or the control rate, shorten the "
        "horizon, or run it separately: python -m slidetune run"
    )
    value = experiment.simulation.plant_substeps
    raise InvalidExperimentError([FieldError("simulation.plant_substeps", text, value)])
