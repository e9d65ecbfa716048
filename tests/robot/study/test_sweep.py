"""Sweeps: every combination, in order, each the run of its own experiment."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.study.outcome import outcome
from slidetune.robot.study.sweep import Axis, axis, combination, sweep

LANE = "RBFNN-NFTSM"


def short(patch: dict[str, Any] | None = None) -> Experiment:
    return load_preset("paper").patched({"simulation": {"horizon": 0.3}}).patched(patch or {})


def test_every_combination_is_run_in_order_with_the_last_axis_the_fastest() -> None:
    six = [60.0, 50.0, 40.0, 30.0, 20.0, 10.0]
    experiment = short({"lanes": {LANE: {"k1": six}}})
    axes = [axis("k1", 30.0, 120.0, 3, True), axis("robot.payload.mass", 0.0, 2.0, 2, False)]
    with ThreadPoolExecutor(2) as pool:
        points = list(sweep(experiment, LANE, axes, pool))
    np.testing.assert_allclose(
        [one.values for one in points],
        [(k1, mass) for k1 in (30.0, 60.0, 120.0) for mass in (0.0, 2.0)],
    )
    for one in points:
        k1, mass = one.values
        patch = {
            "lanes": {LANE: {"k1": np.multiply(six, k1 / 60.0).tolist()}},
            "robot": {"payload": {"mass": mass}},
        }
        assert one.outcome.figures["mae"] == pytest.approx(
            outcome(experiment.patched(patch), LANE).figures["mae"], rel=1e-9
        )


@pytest.mark.parametrize(
    ("names", "found"),
    [
        (
            ("disturbance.constant[1]", "disturbance.constant[2]"),
            {"disturbance": {"constant": [1.0, 2.0, 0.5, 0.5, 0.5, 0.5]}},
        ),
        (("k1", f"lanes.{LANE}.k1[2]"), {"lanes": {LANE: {"k1": [1.0, 2.0, 1.0, 1.0, 1.0, 1.0]}}}),
        (
            ("disturbance.constant", "disturbance.sine.frequency"),
            {"disturbance": {"constant": 1.0, "sine": {"frequency": 2.0}}},
        ),
    ],
)
def test_both_axes_count_even_where_they_set_the_same_list(
    names: tuple[str, str], found: dict[str, Any]
) -> None:
    experiment = short({"disturbance": {"constant": 0.5}, "lanes": {LANE: {"k1": 5.0}}})
    both = experiment.patched(combination(experiment, LANE, names, (1.0, 2.0)))
    assert both == experiment.patched(found)


@pytest.mark.parametrize(
    ("axes", "path", "words"),
    [
        ([Axis("lanes.NFTSM.nu", (1.0, 2.0))], "lanes.NFTSM.nu", f"only {LANE} is run here"),
        (
            [Axis("nu", (1.0, 2.0)), Axis(f"lanes.{LANE}.nu", (1.0, 2.0))],
            f"lanes.{LANE}.nu",
            "twice",
        ),
        ([Axis("robot.lag[1]", (0.0, 0.01)), Axis("robot.lag", (0.0, 0.01))], "robot.lag", "twice"),
        ([Axis("mass", (1.0, 2.0))], "mass", "no gain mass"),
        ([Axis("robot.mass", (1.0, 2.0))], "robot.mass", "no number stands"),
        ([Axis("robot.payload", (1.0, 2.0))], "robot.payload", "no number to set"),
        ([Axis("robot.lag", (0.0, 1.0))], "robot.lag", "[0, 0.05] s"),
        ([Axis("nu", (1.0, 2.0)), Axis("nu", (1.0, 2.0))], "nu", "twice"),
        ([Axis("nu", tuple(np.linspace(1.0, 2.0, 10001)))], "nu", "at most 10,000"),
    ],
)
def test_a_sweep_that_can_not_be_is_refused_before_it_runs(
    axes: list[Axis], path: str, words: str
) -> None:
    with pytest.raises(InvalidExperimentError) as caught, ThreadPoolExecutor(1) as pool:
        sweep(short(), LANE, axes, pool)
    assert caught.value.fields[0].path == path
    assert words in caught.value.fields[0].message


@pytest.mark.parametrize(
    ("low", "high", "count", "logarithmic", "words"),
    [
        (1.0, 1.0, 5, False, "least to the greatest"),
        (1.0, 2.0, 1, False, "two values"),
        (0.0, 1.0, 5, True, "above 0"),
    ],
)
def test_an_empty_axis_is_refused(
    low: float, high: float, count: int, logarithmic: bool, words: str
) -> None:
    with pytest.raises(InvalidExperimentError, match=words):
        axis("nu", low, high, count, logarithmic)
