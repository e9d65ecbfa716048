"""A search called from Python: the trials of the command, and a result to go on with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import slidetune
from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.loop.verdict import judge_goals
from slidetune.server.notebook.tuned import Tuned
from tests.server.test_cli import slidetune as command
from tests.server.test_cli import strict

LANE = "NFTSM"
GAINS: dict[str, tuple[float, float]] = {"nu": (0.1, 30.0), "k1": (20.0, 900.0)}
GOALS: dict[str, Any] = {
    "near": {"kind": "figure", "figure": "max_error", "bound": 0.001},
    "quiet": {"kind": "figure", "figure": "chattering", "bound": 5000.0, "priority": "hard"},
}


@pytest.fixture(scope="module")
def goal() -> Experiment:
    """The paper's lanes over 0.3 s, with goals and an uncertain payload."""
    patch = {"simulation": {"horizon": 0.3}, "goals": GOALS, "uncertainty": {"payload": [0.0, 3.0]}}
    return slidetune.load_preset("paper").patched(patch)


@pytest.fixture(scope="module")
def tuned(goal: Experiment) -> Tuned:
    return slidetune.tune(goal, LANE, gains=GAINS, trials=17, draws=5, seed=3, workers=2)


def test_tune_makes_the_trials_of_the_command_field_by_field(
    goal: Experiment, tuned: Tuned, tmp_path: Path
) -> None:
    (tmp_path / "goal.yaml").write_text(experiment_to_yaml(goal), encoding="utf-8")
    study = "gains:\n  nu: {low: 0.1, high: 30}\n  k1: {low: 20, high: 900}\n"
    (tmp_path / "study.yaml").write_text(study)
    options = ("--lane", LANE, "--study", "study.yaml", "--trials", "17", "--draws", "5")
    told = ("tune", "goal.yaml", *options, "--seed", "3", "--workers", "1", "--json", "-")
    done = command(*told, folder=tmp_path)
    assert done.returncode in (0, 4), done.stderr
    document = strict(done.stdout)
    assert document.pop("preset") == "goal.yaml"
    assert tuned.document() == document


def test_the_best_experiment_does_what_the_result_says(goal: Experiment) -> None:
    tuned = slidetune.tune(goal, LANE, gains={"k1": (100, 900)}, trials=9, draws=0, quiet=False)
    run = slidetune.simulate(tuned.best, estimate=False).lanes[LANE]
    assert tuned.after.number > 0
    assert tuned.after.figures["max_error"] == run.metrics.max_error.max()
    assert tuned.after.ratios == judge_goals(goal.goals, run, run.metrics).ratios
    before = slidetune.simulate(goal, estimate=False).lanes[LANE].metrics
    assert tuned.before.figures["chattering"] == before.chattering
    assert tuned.before.figures["max_error"] > tuned.after.figures["max_error"]
    assert tuned.best.patched({"lanes": {LANE: {"k1": 150.0}}}) == goal
    slidetune.save_preset("tuned", tuned.best)
    assert slidetune.load_preset("tuned") == tuned.best


def test_columns_have_one_row_for_each_trial_and_make_a_data_frame(tuned: Tuned) -> None:
    frame = pd.DataFrame(tuned.columns)
    assert frame.shape[0] == len(tuned.trials) == 17
    assert frame["number"].tolist() == list(range(17))
    for name in GAINS:
        assert frame[name].tolist() == [trial.values[name] for trial in tuned.trials]
    assert frame["ratio of near"].dtype == float
    assert frame["kept"].dtype == bool
    assert np.isnan(frame["diverged_at"]).all()
    assert frame.loc[tuned.after.number, "score"] == tuned.after.score
    assert frame["beaten"].any()  # at 5 draws some are given up
    assert frame.loc[frame["beaten"], "draws"].max() < 5 == frame.loc[0, "draws"]


def test_progress_sees_every_trial_and_an_interrupt_keeps_what_is_done(goal: Experiment) -> None:
    seen: list[Tuned] = []

    def watch(so_far: Tuned) -> None:
        seen.append(so_far)
        if len(so_far.trials) == 4:
            raise KeyboardInterrupt

    tuned = slidetune.tune(goal, LANE, gains=GAINS, trials=9, draws=0, progress=watch)
    assert [len(one.trials) for one in seen] == [1, 2, 3, 4]
    assert tuned.interrupted
    assert tuned.trials == seen[-1].trials
    assert not any(one.interrupted for one in seen)
    assert "4 of 9 trials" in repr(tuned)


def test_an_error_of_progress_ends_the_search(goal: Experiment) -> None:
    def fail(_: Tuned) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        slidetune.tune(goal, LANE, gains=GAINS, trials=9, draws=0, progress=fail)


@pytest.mark.parametrize(
    ("options", "path", "word"),
    [
        ({"lane": "nobody"}, "lane", "nobody"),
        ({"trials": 0}, "trials", "0"),
        ({"sampler": "grid"}, "sampler", "cmaes"),
        ({"gains": {"nu": (1.0, 2.0, 3.0)}}, "gains.nu", "(least, greatest)"),
        ({"gains": {"nu": 5.0}}, "gains.nu", "5"),
        ({"gains": {"nu": (3.0, 1.0)}}, "gains.nu", "greater than low"),
        ({"gains": {"mass": (0.0, 1.0)}}, "gains.mass", "nu"),
        ({"workers": 0}, "workers", "[1, 1024]"),
        ({"workers": 1.5}, "workers", "1.5"),
    ],
)
def test_a_refusal_names_the_field_before_anything_runs(
    goal: Experiment, options: dict[str, Any], path: str, word: str
) -> None:
    def never(_: Tuned) -> None:
        raise AssertionError("something was run")

    with pytest.raises(InvalidExperimentError) as caught:
        slidetune.tune(goal, **options, progress=never)
    assert any(field.path.startswith(path) for field in caught.value.fields)
    assert word in str(caught.value)


def test_numbers_of_numpy_are_ranges_too(goal: Experiment) -> None:
    gains: Any = {"nu": np.array([0.1, 30.0]), "k1": {"low": 20, "high": 900, "joints": "each"}}
    tuned = slidetune.tune(goal, LANE, gains=gains, trials=2, draws=0)
    assert set(tuned.after.gains) == {"nu", *(f"k1[{joint}]" for joint in range(1, 7))}


def test_without_a_goal_there_is_nothing_to_search_for() -> None:
    with pytest.raises(InvalidExperimentError, match="set a goal first"):
        slidetune.tune(slidetune.load_preset("paper"))
