"""Studies of every kind: read from plain values, written to them, and gone on with."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.stats import spearmanr

from slidetune.robot.errors import InvalidExperimentError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.study.curves import bands, curve_names, curves_of, edges
from slidetune.robot.study.draws import drawn
from slidetune.robot.study.outcome import outcome
from slidetune.robot.study.results import bands_of, result_of, table_of
from slidetune.robot.study.study import Entry, Study

LANE = "NFTSM"
WANTED: dict[Any, dict[str, Any]] = {
    "tune": {"lane": LANE, "trials": 28, "gains": {"nu": {"low": 0.1, "high": 30.0}}},
    "robustness": {"lane": LANE, "draws": 10},
    "worst": {"lane": LANE, "trials": 20},
    "sweep": {"lane": LANE, "axes": [{"field": "k1", "low": 10.0, "high": 200.0, "count": 6}]},
}


def uncertain() -> Experiment:
    goals = {
        # Names of goals are the user's: one is a figure's, one a quantile's.
        "mae": {"kind": "figure", "figure": "mae", "bound": 0.01},
        "worst": {"kind": "figure", "figure": "chattering", "bound": 100.0},
    }
    patch = {"simulation": {"horizon": 0.3}, "goals": goals, "uncertainty": {"payload": [0, 3]}}
    return load_preset("paper").patched(patch)


def made(study: Study, known: list[Entry] | None = None) -> list[Entry]:
    with ThreadPoolExecutor(2) as pool:
        return list(study.entries(pool, known or []))


@pytest.mark.parametrize("kind", WANTED)
def test_a_study_goes_on_where_it_stopped(kind: Any) -> None:
    study = Study.from_document(kind, uncertain(), WANTED[kind])
    whole = made(study)
    assert len(whole) == study.total
    told = [json.dumps(one.document(), allow_nan=False) for one in whole]
    for count in (0, 3, 8, study.total - 1, study.total):
        if count > study.total:
            continue
        known = study.read(told[:count])
        rest = made(study, known)
        assert [one.document() for one in (*known, *rest)] == [one.document() for one in whole]
    assert json.dumps(result_of(study, whole), allow_nan=False)
    assert study.read(told) == whole


def test_a_goal_may_have_the_name_of_a_figure() -> None:
    study = Study.from_document("robustness", uncertain(), WANTED["robustness"])
    entries = made(study)
    found = result_of(study, entries)["quantiles"]
    errors = [one.outcome.figures["mae"] for one in entries]
    assert found["figures"]["mae"]["worst"] == max(errors)
    assert found["ratios"]["mae"]["worst"] == max(errors) / 0.01
    table = table_of(entries)
    assert table["mae"] == errors
    assert table["ratio of mae"] == [error / 0.01 for error in errors]
    assert {len(column) for column in table.values()} == {len(entries)}


@pytest.mark.parametrize(
    ("kind", "change", "path"),
    [
        ("tune", {"trials": 0}, "trials"),
        ("tune", {"gains": {"nu": {"low": 3.0, "high": 3.0}}}, "gains.nu.high"),
        ("tune", {"gains": {"wings": {"low": 1.0, "high": 3.0}}}, "gains.wings"),
        ("robustness", {"draws": 0}, "draws"),
        ("robustness", {"trials": 3}, "trials"),
        ("worst", {"lane": "X"}, "lane"),
        ("sweep", {"axes": []}, "axes"),
        ("sweep", {"axes": [{"field": "wings"}]}, "wings"),
        ("sweep", {"axes": [{"field": "k1", "low": 2.0, "high": 1.0}]}, "k1"),
        ("sweep", {"axes": [{"field": "k1", "logarithmic": True}]}, "k1"),
        ("sweep", {"axes": [{"field": "robot.lag", "high": 1.0}]}, "robot.lag"),
        ("sweep", {"axes": [{"field": "k1", "low": 1.0, "high": 9.0, "count": 1}]}, "axes.0.count"),
    ],
)
def test_what_can_come_to_nothing_is_refused_by_field(
    kind: Any, change: dict[str, Any], path: str
) -> None:
    with pytest.raises(InvalidExperimentError) as caught:
        Study.from_document(kind, uncertain(), {**WANTED[kind], **change}).check()
    assert path in [field.path for field in caught.value.fields]


def test_what_is_missing_is_said_to_be() -> None:
    with pytest.raises(InvalidExperimentError) as caught:
        Study.from_document("sweep", uncertain(), {})
    assert [str(field) for field in caught.value.fields] == ["axes: axes is missing"]


def test_without_goals_or_ranges_there_is_nothing_to_study() -> None:
    plain = load_preset("paper")
    for kind, path in (("tune", "goals"), ("worst", "goals"), ("robustness", "draws")):
        experiment = plain.patched({"uncertainty": {"payload": [0, 3]}} if kind == "worst" else {})
        with pytest.raises(InvalidExperimentError) as caught:
            Study.from_document(kind, experiment, {}).check()  # type: ignore[arg-type]
        assert [field.path for field in caught.value.fields] == [path]


def test_bands_hold_nine_tenths_of_the_draws() -> None:
    experiment = uncertain()
    study = Study.from_document("robustness", experiment, {"lane": LANE, "draws": 40})
    entries = made(study)
    found = bands_of(study, [one.curves for one in entries])  # type: ignore[union-attr]
    # By hand: of the whole rows of each draw's run, piece by piece.
    runs = [simulate(drawn(experiment, i), estimate=False).lanes[LANE] for i in range(40)]
    cut = edges(len(runs[0].e))
    for joint in (0, 3):
        rows = np.stack([run.e[:, joint] for run in runs])
        pieces = [rows[:, a:b] for a, b in pairwise(cut)]
        curve = found["curves"][f"e{joint + 1}"]
        for place, piece in enumerate(pieces):
            lows, highs = np.sort(piece.min(axis=1)), np.sort(piece.max(axis=1))
            assert curve["least"][place] == pytest.approx(lows[0], rel=1e-6)
            assert curve["greatest"][place] == pytest.approx(highs[-1], rel=1e-6)
            assert curve["low"][place] == pytest.approx(lows[1], rel=1e-6)
            assert curve["high"][place] == pytest.approx(highs[37], rel=1e-6)
    assert found["draws"] == 40


def test_a_draw_that_left_its_bounds_is_beyond_all() -> None:
    experiment = uncertain()
    good = curves_of(simulate(experiment, estimate=False).lanes[LANE])
    gone = good.copy()
    gone[:, :, 60:] = np.nan
    one_of_thirty = bands([good] * 29 + [gone], 0.3)["curves"]["e1"]
    assert one_of_thirty["greatest"][70] is None
    assert one_of_thirty["least"][70] is None
    assert one_of_thirty["high"][70] == pytest.approx(float(good[0, 1, 70]))
    most = bands([good] + [gone] * 2, 0.3)["curves"]["e1"]
    assert most["median"][70] is None
    assert most["high"][70] is None
    assert most["median"][10] is not None
    assert set(bands([good], 0.3)["curves"]) == set(curve_names(6))
    assert json.dumps(bands([good, gone], 0.3), allow_nan=False)


def test_the_gain_that_acts_is_the_one_that_counts() -> None:
    goals = {"quick": {"kind": "figure", "figure": "mae", "bound": 0.01}}
    experiment = load_preset("paper").patched({"simulation": {"horizon": 0.3}, "goals": goals})
    # Within so narrow a range k2 changes nothing, as long as gains may chatter a little more.
    gains = {"nu": {"low": 0.1, "high": 30.0}, "k2": {"low": 149.0, "high": 151.0}}
    wanted = {"lane": "RBFNN-NFTSM", "trials": 64, "gains": gains, "quiet": False}
    study = Study.from_document("tune", experiment, wanted)
    entries = made(study)
    found = result_of(study, entries)["importance"]
    assert next(iter(found)) == "nu"
    assert found["nu"] > 3.0 * found["k2"]
    assert sum(found.values()) == pytest.approx(1.0)
    assert result_of(study, entries[:8])["importance"] is None


def test_sobol_covers_the_ranges_and_tells_which_way_a_figure_goes() -> None:
    goals = {"quick": {"kind": "figure", "figure": "mae", "bound": 0.01}}
    experiment = load_preset("paper").patched({"simulation": {"horizon": 0.3}, "goals": goals})
    gains = {"k1": {"low": 20.0, "high": 600.0}, "c": {"low": 9.99, "high": 10.01}}
    wanted = {"lane": LANE, "trials": 64, "gains": gains, "sampler": "sobol", "seed": 3}
    study = Study.from_document("tune", experiment, wanted)
    entries = made(study)
    spread = np.sort([one.values["k1"] for one in entries[1:]])  # type: ignore[call-overload]
    # Scrambled, but even: no gap of more than a few parts of the range, which is logarithmic.
    assert np.max(np.diff(np.log(spread))) < 5.0 * np.log(30.0) / 63
    assert [one.document() for one in made(study)] == [one.document() for one in entries]
    found = result_of(study, entries)["correlations"]
    # By hand, with SciPy's own.
    for gain in gains:
        for figure in ("mae", "chattering"):
            values = [one.values[gain] for one in entries]  # type: ignore[call-overload]
            told = [one.outcome.figures[figure] for one in entries]
            assert found[gain][figure] == pytest.approx(spearmanr(values, told).statistic)
    assert found["k1"]["mae"] < -0.9
    assert abs(found["c"]["mae"]) < 0.4
    assert result_of(study, entries[:9])["correlations"] is None


def test_an_even_cover_is_not_raced_and_what_was_given_up_tells_of_no_figure() -> None:
    gains = {"k1": {"low": 20.0, "high": 600.0}}
    wanted = {"lane": "RBFNN-NFTSM", "trials": 40, "draws": 20, "gains": gains}
    even = Study.from_document("tune", uncertain(), {**wanted, "sampler": "sobol"})
    assert not any(one.beaten for one in made(even))  # type: ignore[union-attr]
    raced = Study.from_document("tune", uncertain(), wanted)
    entries = made(raced)
    whole = [one for one in entries if not one.beaten]  # type: ignore[union-attr]
    assert 0 < len(whole) < 24 < len(entries)
    assert result_of(raced, entries)["correlations"] is None


def test_a_figure_that_no_goal_asks_for_is_not_taken_and_one_that_is_asked_for_is_right() -> None:
    figure = {"kind": "figure", "figure": "high_frequency_torque", "bound": 2.0}
    plain = uncertain()
    asked = plain.patched({"goals": {"calm": figure}})
    metrics = simulate(asked, estimate=False).lanes[LANE].metrics
    assert metrics.high_frequency_torque is not None
    found = outcome(asked, LANE)
    assert found.ratios["calm"] == metrics.high_frequency_torque / 2.0
    assert outcome(plain, LANE).figures == found.figures
