"""A fit finds the constants that figures were made with, and says when that proves nothing."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.number_place import number_at, number_patch
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.study.fit import Fitting, FitTrial, fit

TRUE = {"disturbance.constant[1]": -22.5, "disturbance.constant[2]": -33.0}
RANGE = {"low": -80.0, "high": 0.0}


def short() -> Experiment:
    return load_preset("paper").patched({"simulation": {"horizon": 0.6}})


def fitting(**more: Any) -> Fitting:
    run = simulate(short(), estimate=False)
    targets = []
    for lane in ("NFTSM", "RBFNN-SMC"):
        late = run.lanes[lane].metrics_since(0.2)
        whole = run.lanes[lane].metrics
        for joint in (1, 2):
            about = {"lane": lane, "joint": joint}
            values = float(whole.max_error[joint - 1]), float(late.mae[joint - 1])
            targets.append({**about, "figure": "max_error", "value": values[0]})
            targets.append({**about, "figure": "mae", "since": 0.2, "value": values[1]})
    told = {"fields": dict.fromkeys(TRUE, RANGE), "targets": targets, "trials": 160, **more}
    return Fitting.model_validate(told)


def made(experiment: Experiment, wanted: Fitting, threads: int = 2) -> list[FitTrial]:
    with ThreadPoolExecutor(threads) as pool:
        return list(fit(experiment, wanted, pool))


def test_the_constants_that_made_the_figures_are_found() -> None:
    elsewhere = short().patched({"disturbance": {"constant": [-5.0, -5.0, -20.0, 0, 0, 0]}})
    wanted = fitting()
    trials = made(elsewhere, wanted)
    assert trials[0].values == dict.fromkeys(TRUE, -5.0)
    best = min(trials, key=lambda one: one.deviation)
    assert best.deviation < 0.05 < trials[0].deviation
    for name, value in TRUE.items():
        assert best.values[name] == pytest.approx(value, abs=2.0)
    # What it says of its figures is what they are.
    run = simulate(elsewhere.patched(best.patch), estimate=False)
    late = run.lanes["NFTSM"].metrics_since(0.2).mae[0]
    assert best.figures[1] == pytest.approx(float(late))
    off = [np.log(x / one.value) for x, one in zip(best.figures, wanted.targets, strict=True) if x]
    assert best.deviation == pytest.approx(np.sqrt(np.mean(np.square(off))))
    assert [one.document() for one in made(elsewhere, wanted, 1)[:32]] == [
        one.document() for one in trials[:32]
    ]


def test_how_many_data_are_left_is_told() -> None:
    wanted = fitting()
    assert wanted.spare == 6
    few = wanted.model_copy(update={"targets": wanted.targets[:2]})
    assert few.spare == 0


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"targets": [{"lane": "X", "value": 1.0}]}, "targets.0.lane"),
        ({"targets": [{"lane": "NFTSM", "figure": "gamma", "value": 1.0}]}, "targets.0.figure"),
        (
            {"targets": [{"lane": "NFTSM", "figure": "flange_max", "joint": 2, "value": 1.0}]},
            "targets.0.joint",
        ),
        ({"fields": {"robot.wings": RANGE}}, "robot.wings"),
        ({"fields": {"robot.payload.mass": {"low": -1.0, "high": 1.0}}}, "robot.payload.mass"),
        ({"fields": {"disturbance.constant[7]": RANGE}}, "disturbance.constant[7]"),
        ({"fields": {"title": RANGE}}, "title"),
    ],
)
def test_what_can_not_be_fitted_is_refused_before_anything_runs(
    change: dict[str, Any], path: str
) -> None:
    wanted = fitting(**change)
    with pytest.raises(InvalidExperimentError) as caught:
        fit(short(), wanted, ThreadPoolExecutor(1))
    assert path in [field.path for field in caught.value.fields]


def test_the_first_trial_is_the_experiment_as_it_is_even_where_all_six_numbers_are_fitted() -> None:
    experiment = short().patched({"disturbance": {"constant": [-5.0, -30.0, -20.0, 0, 0, 0]}})
    error = simulate(experiment, estimate=False).lanes["NFTSM"].metrics.mae[1]
    targets = [{"lane": "NFTSM", "figure": "mae", "joint": 2, "value": float(error)}]
    told = {"fields": {"disturbance.constant": RANGE}, "targets": targets, "trials": 2}
    first = made(experiment, Fitting.model_validate(told))[0]
    assert experiment.patched(first.patch) == experiment
    assert first.deviation == pytest.approx(0.0)


def test_a_number_of_one_joint_is_set_alone() -> None:
    experiment = short()
    patched = experiment.patched(number_patch(experiment, "disturbance.constant[3]", 4.0))
    assert patched.disturbance.constant == (-22.5, -33.0, 4.0, 0.0, 0.0, 0.0)
    assert number_at(patched, "disturbance.constant[3]") == 4.0
    spread = experiment.patched(number_patch(experiment, "robot.viscous_friction[2]", 3.0))
    assert spread.robot.viscous_friction == (0.0, 3.0, 0.0, 0.0, 0.0, 0.0)
    quoted = 'lanes."RBFNN-SMC".lambda_'
    assert number_at(experiment.patched(number_patch(experiment, quoted, 7.0)), quoted) == 7.0
