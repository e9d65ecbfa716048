"""Studies on the command line as people run them: in a process of its own."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.loop.verdict import judge_goals
from slidetune.robot.study.draws import drawn
from tests.server.test_cli import slidetune, strict

LANE = "RBFNN-NFTSM"
GOALS: dict[str, Any] = {
    "near, always": {"kind": "figure", "figure": "max_error", "bound": 0.01},
    "quiet": {"kind": "figure", "figure": "chattering", "bound": 5000.0, "priority": "hard"},
}


@pytest.fixture
def goal(tmp_path: Path) -> Experiment:
    """The paper's lanes over 0.3 s, with goals and an uncertain payload, in ``goal.yaml``."""
    patch = {"simulation": {"horizon": 0.3}, "goals": GOALS, "uncertainty": {"payload": [0.0, 3.0]}}
    experiment = load_preset("paper").patched(patch)
    (tmp_path / "goal.yaml").write_text(experiment_to_yaml(experiment), encoding="utf-8")
    return experiment


def test_tune_writes_gains_that_do_what_it_says(goal: Experiment, tmp_path: Path) -> None:
    study = "trials: 24\ndraws: 0\ngains:\n  nu: {low: 0.1, high: 30}\n  k1: {low: 20, high: 900}\n"
    (tmp_path / "study.yaml").write_text(study)
    arguments = ("tune", "goal.yaml", "--study", "study.yaml", "--out", "tuned.yaml")
    one = slidetune(*arguments, "--json", "-", "--workers", "1", folder=tmp_path)
    assert one.returncode == 0, one.stderr
    document = strict(one.stdout)
    best = document["best"]
    assert document["tuning"]["lane"] == LANE
    assert len(document["trials"]) == 24
    assert best["outcome"]["cost"] < document["present"]["outcome"]["cost"]
    chattering = [document[one]["outcome"]["figures"]["chattering"] for one in ("present", "best")]
    assert chattering[1] <= chattering[0]
    tuned = experiment_from_yaml((tmp_path / "tuned.yaml").read_bytes())
    run = simulate(tuned, estimate=False).lanes[LANE]
    assert judge_goals(tuned.goals, run, run.metrics).score == pytest.approx(
        best["outcome"]["score"]
    )
    two = slidetune(*arguments, "--json", "-", "--workers", "3", folder=tmp_path)
    assert strict(two.stdout) == document
    printed = slidetune(*arguments, folder=tmp_path)
    assert "near, always: maximum error ≤ 0.01 rad" in printed.stdout
    assert "before" in printed.stdout
    assert "no more chattering than now" in printed.stdout


def test_tune_judges_by_draws_where_something_is_uncertain_and_tells_their_means(
    goal: Experiment, tmp_path: Path
) -> None:
    arguments = ("tune", "goal.yaml", "--trials", "9", "--any-chattering")
    done = slidetune(*arguments, "--json", "t.json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "judged by the p95 of 50 draws\n" in done.stdout
    assert "over all draws" in done.stdout
    document = strict((tmp_path / "t.json").read_text(encoding="utf-8"))
    assert document["tuning"]["quiet"] is False
    runs = [simulate(drawn(goal, index), estimate=False).lanes[LANE].metrics for index in range(50)]
    means = document["present"]["draws"]["means"]
    assert means["mae"] == pytest.approx(np.mean([one.mae.mean() for one in runs]))
    assert means["chattering"] == pytest.approx(np.mean([one.chattering for one in runs]))


def test_tune_ends_with_4_where_no_gains_keep_the_hard_goals(
    goal: Experiment, tmp_path: Path
) -> None:
    hard = goal.patched({"goals": {"quiet": {"bound": 1e-6}}})
    (tmp_path / "hard.yaml").write_text(experiment_to_yaml(hard), encoding="utf-8")
    done = slidetune("tune", "hard.yaml", "--trials", "4", folder=tmp_path)
    assert done.returncode == 4
    assert "No set of gains keeps every hard goal" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("tune", "paper"), "set a goal first"),
        (("tune", "goal.yaml", "--sampler", "grid"), "sampler"),
        (("tune", "goal.yaml", "--lane", "X"), "no lane is named X"),
        (("tune", "goal.yaml", "--study", "bad.yaml"), "line 2: gains.nu.high"),
        (("tune", "goal.yaml", "--study", "none.yaml"), "none.yaml"),
        (("robustness", "paper"), "give a quantity of uncertainty a range"),
        (("fit", "goal.yaml", "bad-fit.yaml"), 'line 2: fields."robot.lag".high'),
        (("fit", "goal.yaml", "lost.yaml"), "lost.yaml"),
        (("sweep", "goal.yaml", "nu=1:2"), "k1=10:500:20:log"),
        (("sweep", "goal.yaml", "nu=1:2:3", "k1=1:2:3", "k2=1:2:3"), "one field or two"),
        (("sweep", "goal.yaml", "robot.lag=0:1:3"), "[0, 0.05] s"),
    ],
)
def test_a_bad_study_is_refused_before_anything_runs(
    goal: Experiment, tmp_path: Path, arguments: tuple[str, ...], words: str
) -> None:
    (tmp_path / "bad.yaml").write_text("gains:\n  nu: {low: 1, high: 0.5}\n")
    (tmp_path / "bad-fit.yaml").write_text("fields:\n  robot.lag: {low: 1, high: 0}\n")
    done = slidetune(*arguments, folder=tmp_path)
    assert done.returncode in (1, 2)
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


def test_robustness_tells_quantiles_and_the_worst_found(goal: Experiment, tmp_path: Path) -> None:
    arguments = ("robustness", "goal.yaml", "--draws", "12", "--worst", "16")
    files = ("--json", "r.json", "--csv", "r.csv", "--parquet", "r.parquet")
    done = slidetune(*arguments, *files, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "p95" in done.stdout
    assert "Worst found (no proof that there is none worse)" in done.stdout
    document = strict((tmp_path / "r.json").read_text(encoding="utf-8"))
    masses = [draw["values"]["payload"] for draw in document["draws"]]
    assert len(masses) == 12
    assert all(0.0 <= mass <= 3.0 for mass in masses)
    errors = sorted(draw["outcome"]["figures"]["mae"] for draw in document["draws"])
    assert document["quantiles"]["figures"]["mae"]["worst"] == errors[-1]
    for table in (pd.read_csv(tmp_path / "r.csv"), pd.read_parquet(tmp_path / "r.parquet")):
        assert table["payload"].tolist() == masses


def test_sweep_writes_one_row_a_combination(goal: Experiment, tmp_path: Path) -> None:
    arguments = ("sweep", "goal.yaml", "k1=50:500:3:log", "robot.payload.mass=0:2:2")
    done = slidetune(*arguments, "--csv", "s.csv", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "chattering" in done.stdout
    with (tmp_path / "s.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0][:4] == ["number", "k1", "robot.payload.mass", "mae [rad]"]
    assert len(rows) == 7
    assert all(len(row) == len(rows[0]) for row in rows)
    swept = goal.patched({"lanes": {LANE: {"k1": 500.0}}, "robot": {"payload": {"mass": 2.0}}})
    mae = simulate(swept, estimate=False).lanes[LANE].metrics.mae.mean()
    assert float(rows[-1][3]) == pytest.approx(mae, rel=1e-6)
