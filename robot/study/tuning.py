"""What a search is told: lane, gains and their ranges, how it searches and how it judges."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field, model_validator

from slidetune.robot.errors import FieldError, InvalidExperimentError
from slidetune.robot.experiment.document import LONGEST_LANE_NAME, Experiment
from slidetune.robot.fields.quantity import Integer, Number, Section, field, refusal
from slidetune.robot.study.draws import check_ranges

Sampler = Literal["tpe", "cmaes", "nsga2", "sobol"]

MOST_TRIALS, MOST_DRAWS = 20_000, 2_000
MOST_GAINS = 24
USUAL_DRAWS = 50
"""Draws where something is uncertain and nobody says how many (*ours*)."""


class GainRange(Section):
    """Between which values a gain is searched."""

    low: Number = field(
        0.0,
        title="Least value",
        low=-1e9,
        high=1e9,
        meaning="Least value that is tried, in the gain's own unit.",
    )
    high: Number = field(
        1.0,
        title="Greatest value",
        low=-1e9,
        high=1e9,
        meaning="Greatest value that is tried; of six that are turned alike, the greatest one's.",
    )
    joints: Literal["alike", "each"] = field(
        "alike",
        title="Joints",
        meaning="alike: six values stay in proportion; each: every joint's is searched by itself.",
    )

    @model_validator(mode="after")
    def _is_not_empty(self) -> GainRange:
        if self.low >= self.high:
            text = f"high must be greater than low = {self.low:g}, got {self.high:g}"
            raise refusal("high", self.high, text)
        return self


class Tuning(Section):
    """A search for the gains of a lane that keep to the experiment's goals."""

    lane: str = Field(
        max_length=LONGEST_LANE_NAME, title="Lane", description="Lane whose gains are searched."
    )
    gains: dict[str, GainRange] = Field(
        default_factory=dict,
        max_length=MOST_GAINS,
        title="Gains",
        description="Gains by name that are searched, and their ranges; where there are none, "
        "every gain that acts, from a tenth of its value to ten times.",
    )
    quiet: bool = field(
        True,
        title="No more chattering than now",
        meaning="Gains that chatter more than the present ones, at the same draw of what is "
        "uncertain, are never the best. Without it, and without a goal that bounds chattering, "
        "accuracy is bought with it.",
    )
    sampler: Sampler = field(
        "cmaes",
        title="Sampler",
        meaning="How the next gains are chosen: cmaes (CMA-ES, around the present ones), tpe "
        "(Parzen estimators), nsga2, which looks for the best compromises between several soft "
        "goals, or sobol, which covers the ranges evenly to tell how much each gain counts.",
    )
    trials: Integer = field(
        200,
        title="Trials",
        low=1,
        high=MOST_TRIALS,
        step=10,
        meaning="How many sets of gains are tried; the first is the present one.",
    )
    draws: Integer = field(
        0,
        title="Draws",
        low=0,
        high=MOST_DRAWS,
        step=10,
        meaning="How many draws of what is uncertain each set is judged by, 0 for the experiment "
        "as it is. Where it is not said: 50 if anything is uncertain.",
    )
    judged_by: Literal["worst", "p95"] = field(
        "p95",
        title="Judged by",
        meaning="Which draw counts: the worst one, or the one that 95 % of the draws keep below.",
    )
    seed: Integer = field(
        1,
        title="Seed",
        low=0,
        high=2**31 - 1,
        step=1,
        meaning="The same seed gives the same trials, on however many cores.",
    )


def told(experiment: Experiment, wanted: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a search is told, with its lane and draws where they are not."""
    draws = USUAL_DRAWS if experiment.uncertainty.uncertain else 0
    return {"lane": next(iter(experiment.lanes)), "draws": draws, **wanted}


def check_tuning(experiment: Experiment, tuning: Tuning) -> None:
    """Refuse a search that can't come to anything, before it begins.

    Raises:
        InvalidExperimentError: if there is no such lane, no goal, nothing uncertain to draw from,
            a range that leads out of a field's bounds, or fewer than two soft goals for ``nsga2``.
    """
    experiment.lane(tuning.lane)
    soft = [name for name, goal in experiment.goals.items() if goal.priority == "soft"]
    refused = []
    if not experiment.goals:
        refused.append(no_goal())
    elif tuning.sampler == "nsga2" and len(soft) < 2:
        text = f"nsga2 needs two soft goals or more to choose between, there are {len(soft)}"
        refused.append(FieldError("sampler", text, tuning.sampler))
    refused += unfounded_draws(experiment, tuning.draws)
    if refused:
        raise InvalidExperimentError(refused)
    if tuning.draws:
        check_ranges(experiment)


def no_goal() -> FieldError:
    """Return the refusal of a search that has nothing to make small."""
    text = "there is nothing to search for: set a goal first, a bound on a response or a figure"
    return FieldError("goals", text)


def unfounded_draws(experiment: Experiment, draws: int) -> list[FieldError]:
    """Return the refusal of draws where nothing is uncertain, if it is one."""
    if not draws or experiment.uncertainty.uncertain:
        return []
    text = f"{draws} draws of nothing: give a quantity of uncertainty a range, or set draws to 0"
    return [FieldError("draws", text, draws)]
