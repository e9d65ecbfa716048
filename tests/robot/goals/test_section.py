"""Goals and uncertain ranges as parts of an experiment: kept, patched, refused by field."""

from __future__ import annotations

from typing import Any

import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.goals.section import GOALS, OF_THE_WHOLE_ARM, Bounded, FigureGoal
from slidetune.robot.loop.figures import FIGURES

GOAL: dict[str, Any] = {"kind": "response", "channel": "e", "bound": 0.005, "start": 1.0}


def with_goals(goals: dict[str, Any]) -> Experiment:
    return load_preset("realistic").patched({"goals": goals})


def refusal(patch: dict[str, Any]) -> tuple[str, str]:
    with pytest.raises(InvalidExperimentError) as caught:
        load_preset("realistic").patched(patch)
    (field,) = caught.value.fields
    return field.path, field.message


def test_every_figure_of_which_less_is_better_can_be_bounded() -> None:
    wanted = {f.name for f in FIGURES.values() if f.source == "run" and f.better == "less"}
    assert set(Bounded.__args__) == wanted
    whole = {name for name in wanted if not FIGURES[name].per_joint}
    assert whole == {name for name in OF_THE_WHOLE_ARM if name in FIGURES}


def test_an_experiment_without_goals_is_written_as_before() -> None:
    for name in ("paper", "realistic", "drive-lag", "chattering-sign"):
        text = experiment_to_yaml(load_preset(name))
        assert "goals" not in text
        assert "uncertainty" not in text


def test_goals_and_ranges_read_back_equal() -> None:
    experiment = with_goals(
        {"settled": GOAL, "quiet": {"kind": "figure", "figure": "chattering", "bound": 200.0}}
    ).patched({"uncertainty": {"payload": [0.0, 3.0], "lag": [0.001, 0.004]}})
    text = experiment_to_yaml(experiment)
    assert experiment_from_yaml(text) == experiment
    assert experiment_to_yaml(experiment_from_yaml(text)) == text
    assert hash(experiment_from_yaml(text)) == hash(experiment)


def test_a_patch_adds_changes_renames_and_removes_a_goal() -> None:
    experiment = with_goals({"one": GOAL, "two": {**GOAL, "joint": 2}})
    assert experiment.patched({"goals": {"one": {"bound": 0.1}}}).goals["one"].bound == 0.1
    renamed = experiment.patched({"goals": {"one": None, "other": GOAL}})
    assert list(renamed.goals) == ["other", "two"]
    assert list(experiment.patched({"goals": {"one": None}}).goals) == ["two"]
    other = experiment.patched({"goals": {"one": {"kind": "figure", "figure": "mae"}}})
    assert other.goals["one"] == FigureGoal(figure="mae", bound=0.005)
    assert set(GOALS) == {"response", "figure"}


@pytest.mark.parametrize(
    ("goal", "path", "words"),
    [
        ({**GOAL, "bound": 0.0}, "goals.g.bound", "[1e-09, 1e+09]"),
        ({**GOAL, "channel": "x"}, "goals.g.channel", "flange_error"),
        ({**GOAL, "start": 2.0, "end": 2.0}, "goals.g.end", "later than start = 2 s"),
        ({**GOAL, "joint": 7}, "goals.g.joint", "[0, 6]"),
        ({**GOAL, "channel": "flange_error", "joint": 2}, "goals.g.joint", "of the whole arm"),
        ({"kind": "figure", "figure": "gamma"}, "goals.g.figure", "mae"),
        ({"kind": "figure", "figure": "chattering", "joint": 1}, "goals.g.joint", "whole arm"),
        ({"kind": "wish"}, "goals.g.kind", "response, figure"),
        ({**GOAL, "priority": "must"}, "goals.g.priority", "hard"),
    ],
)
def test_a_bad_goal_is_refused_by_field(goal: dict[str, Any], path: str, words: str) -> None:
    found, message = refusal({"goals": {"g": goal}})
    assert found == path
    assert words in message


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("payload", [3.0, 1.0], "from the least to the greatest"),
        ("payload", [0.0, 30.0], "[0, 10] kg"),
        ("payload", [0.0], "list of 2 numbers"),
        ("payload", 2.0, "list of 2 numbers"),
        ("inertia", [0.0, 1.0], "[0.2, 5]"),
        ("seed", -1, "[0, 2.14748e+09]"),
        ("colour", [0.0, 1.0], "unknown field"),
    ],
)
def test_a_bad_range_is_refused_by_field(name: str, value: Any, words: str) -> None:
    path, message = refusal({"uncertainty": {name: value}})
    assert path == f"uncertainty.{name}"
    assert words in message


def test_a_goal_may_not_take_a_name_that_a_browser_can_not_hold() -> None:
    _, message = refusal({"goals": {"__proto__": GOAL}})
    assert "goal's name" in message
