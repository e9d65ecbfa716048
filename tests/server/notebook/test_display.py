"""Results in a notebook: the numbers with their units, in three forms that need no network."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import plotly.graph_objects as go
import pytest

import slidetune
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run
from slidetune.server.client.whole_response import LaneResponse, WholeResponse
from slidetune.server.notebook.display import PLOTLY

ODD = "A & 'B' \"C\""
"""A lane's name with every sign that HTML and Plotly would read; < and > no name can have."""
SHORT: dict[str, Any] = {"simulation": {"horizon": 0.3}}


def bundle(shown: Any) -> dict[str, Any]:
    made: dict[str, Any] = shown._repr_mimebundle_(include=None, exclude=None)
    return made


def texts(html: str) -> list[str]:
    """The texts of an HTML fragment, which must be well formed."""
    return [text for text in ElementTree.fromstring(html).itertext() if text.strip()]


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    patch: dict[str, Any] = {
        "title": "a <b>bold</b> & 'quoted' title",
        "lanes": {"RBFNN-SMC": None, "RBFNN-NFTSM": None, ODD: {"law": "smc"}},
        **SHORT,
    }
    return slidetune.load_preset("paper").patched(patch)


@pytest.fixture(scope="module")
def run(experiment: Experiment) -> Run:
    return slidetune.simulate(experiment)


@pytest.fixture(scope="module")
def diverged() -> Run:
    """A lane that can't hold, sampled at 250 Hz, beside one that can."""
    lanes = {"calm": {"law": "computed_torque"}, "wild": {"law": "smc", "k1": 1000.0}}
    gone = dict.fromkeys(("NFTSM", "RBFNN-NFTSM", "RBFNN-SMC"))
    simulation = {"mode": "sampled", "control_rate": 250.0, "horizon": 1.0}
    patch: dict[str, Any] = {"lanes": {**gone, **lanes}, "simulation": simulation}
    experiment = slidetune.load_preset("paper").patched(patch)
    return slidetune.simulate(experiment)


def test_a_run_shows_every_lanes_figures_with_their_units(run: Run) -> None:
    shown = texts(bundle(run)["text/html"])
    for name, lane in run.lanes.items():
        assert name in shown
        assert f"{1e3 * lane.metrics.mae.mean():.4g}" in shown
        assert lane.accuracy.error_estimate is not None
        assert any(f"{1e3 * lane.accuracy.error_estimate:.4g}" in text for text in shown)
    assert "mean |e| [mrad]" in shown
    assert "chattering [N·m/s]" in shown
    assert "estimated error of the angles [mrad]" in shown
    assert shown.count("ran to its end") == len(run.lanes)


def test_the_curves_of_a_run_are_its_columns(run: Run) -> None:
    figure = bundle(run)[PLOTLY]
    curves = [one for one in figure["data"] if one["type"] == "scatter"]
    assert len(curves) == 2 * 6 * len(run.lanes)  # error and torque of every joint
    lane = run.lanes["NFTSM"]
    for joint in range(6):
        axis = f"y{joint + 1}" if joint else "y"
        mine = [one for one in curves if one["name"] == "NFTSM" and one["yaxis"] == axis]
        error, torque = mine
        assert (error["visible"], torque["visible"]) == (True, False)
        rows = np.searchsorted(run.time, np.array(error["x"]) - 1e-9)
        assert error["y"] == pytest.approx(lane.e[rows, joint], rel=1e-4, abs=1e-12)
        assert max(error["y"]) == pytest.approx(lane.e[:, joint].max(), rel=1e-4)
        assert min(torque["y"]) == pytest.approx(lane.tau[:, joint].min(), rel=1e-4)


def test_the_choice_of_torque_shows_it_with_its_unit(run: Run) -> None:
    figure = bundle(run)[PLOTLY]
    _, torque = figure["layout"]["updatemenus"][0]["buttons"]
    visible, axes = torque["args"]
    kinds = [one["type"] for one in figure["data"]]
    assert len(visible["visible"]) == len(kinds)
    for shown, trace in zip(visible["visible"], figure["data"], strict=True):
        assert shown is (trace["type"] == "table" or not trace["visible"])
    assert set(axes.values()) == {"τ [N·m]"}


def test_plotly_itself_accepts_the_figure_and_html_is_well_formed(run: Run) -> None:
    forms = bundle(run)
    figure = {name: forms[PLOTLY][name] for name in ("data", "layout")}
    go.Figure(figure)  # raises for what it doesn't know
    json.dumps(forms[PLOTLY], allow_nan=False)
    assert texts(forms["text/html"])
    assert "<script" not in forms["text/html"]
    assert not re.search(r"(https?:)?//\w", forms["text/html"])
    assert sum(len(json.dumps(form)) for form in forms.values()) < 500_000


def test_names_are_text_and_no_markup(run: Run) -> None:
    forms = bundle(run)
    assert ODD in texts(forms["text/html"])
    assert ODD in forms["text/plain"]
    names = {one.get("name") for one in forms[PLOTLY]["data"]} - {None}
    assert names == {"NFTSM", "A &amp; 'B' \"C\""}
    title = forms[PLOTLY]["layout"]["title"]["text"]
    assert title.startswith("a &lt;b&gt;bold&lt;/b&gt; &amp; 'quoted' title")
    assert any("a <b>bold</b>" in text for text in texts(forms["text/html"]))


def test_a_lane_that_left_its_bounds_says_so_in_words(diverged: Run) -> None:
    freeze = diverged.lanes["wild"].freeze
    assert freeze is not None
    forms = bundle(diverged)
    words = f"wild diverged: {freeze.cause}"
    assert words in forms["text/plain"]
    assert any(words in text for text in texts(forms["text/html"]))
    assert f"diverged at {freeze.time:.4g} s" in texts(forms["text/html"])
    tables = [one for one in forms[PLOTLY]["data"] if one["type"] == "table"]
    assert len(tables) == 2  # remarks above the figures
    assert tables[0]["cells"]["values"][0][0].startswith("wild diverged: ")
    json.dumps(forms[PLOTLY], allow_nan=False)


def test_an_error_that_may_be_many_times_its_estimate_is_marked(diverged: Run) -> None:
    accuracy = diverged.lanes["wild"].accuracy
    assert accuracy.at_least
    assert "≥ " in bundle(diverged)["text/plain"]


def test_lines_that_are_flat_or_end_at_once_are_drawn_too(run: Run) -> None:
    lane = run.lanes["NFTSM"]
    flat = replace(lane, e=np.zeros_like(lane.e), tau=np.full_like(lane.tau, 5e-324))
    gone = replace(lane, q=np.full_like(lane.q, np.nan), e=np.full_like(lane.e, np.nan))
    for lanes in ({"flat": flat}, {"gone": gone}, {"flat": flat, "gone": gone}):
        forms = bundle(replace(run, lanes=lanes))
        json.dumps(forms[PLOTLY], allow_nan=False)
        assert "nan" not in forms["text/html"]
        assert "inf" not in forms["text/html"]


def test_a_search_in_which_nothing_came_to_its_end_is_shown(diverged: Run) -> None:
    goals: dict[str, Any] = {"near": {"kind": "figure", "figure": "max_error", "bound": 0.001}}
    experiment = diverged.experiment.patched({"goals": goals})
    tuned = slidetune.tune(experiment, "wild", gains={"k1": (999.0, 1000.0)}, trials=3)
    assert tuned.after.diverged_at is not None
    forms = bundle(tuned)
    assert "No set of gains keeps every hard goal." in texts(forms["text/html"])[1]
    json.dumps(forms[PLOTLY], allow_nan=False)
    assert "score —" in repr(tuned)


def test_an_experiment_shows_gains_and_what_differs_from_its_preset() -> None:
    experiment = slidetune.load_preset("paper").patched(
        {"lanes": {"NFTSM": {"nu": 30.0}}, "goals": {"near": {"kind": "figure", "bound": 0.01}}}
    )
    forms = bundle(experiment)
    assert PLOTLY not in forms
    shown = texts(forms["text/html"])
    assert any("nu 30" in text for text in shown)
    place = shown.index("lanes.NFTSM.nu")
    assert shown[place : place + 3] == ["lanes.NFTSM.nu", "0.3", "30"]
    assert "goals.near" in shown
    assert "preset paper" in shown
    same = texts(bundle(slidetune.load_preset("paper"))["text/html"])
    assert not any(text.startswith("preset ") for text in same)


def test_a_search_shows_before_and_after_and_the_score_of_every_trial() -> None:
    goals: dict[str, Any] = {"near": {"kind": "figure", "figure": "max_error", "bound": 0.001}}
    experiment = slidetune.load_preset("paper").patched({**SHORT, "goals": goals})
    tuned = slidetune.tune(experiment, "NFTSM", gains={"nu": (0.1, 30.0)}, trials=9, quiet=False)
    forms = bundle(tuned)
    shown = texts(forms["text/html"])
    assert "near: maximum error ≤ 0.001 rad (soft)" in shown
    assert f"{tuned.before.ratios['near']:.4g}" in shown
    place = shown.index("nu")
    assert shown[place + 1 : place + 3] == ["0.3", f"{tuned.after.gains['nu']:.4g}"]
    tried, best = (one for one in forms[PLOTLY]["data"] if one["type"] == "scatter")
    assert tried["y"] == pytest.approx(tuned.columns["score"], rel=1e-4)
    assert best["y"] == pytest.approx(np.minimum.accumulate(tuned.columns["score"]), rel=1e-4)
    go.Figure({name: forms[PLOTLY][name] for name in ("data", "layout")})


def test_a_response_of_a_dashboard_is_shown_like_a_run(run: Run) -> None:
    lanes = {
        name: LaneResponse(
            lane.time,
            {"e": lane.e, "tau": lane.tau},
            lane.metrics.document(),
            None,
            lane.accuracy.document(),
            {},
        )
        for name, lane in run.lanes.items()
    }
    here, there = bundle(run), bundle(WholeResponse(1, 0.3, lanes))
    tables = [form["text/plain"].splitlines()[1:] for form in (here, there)]
    assert [line for line in tables[1] if not line.startswith("Units are those")] == tables[0]
    assert "m for rad" in there["text/html"]  # of which joints slide, it knows nothing
    assert "m for rad" not in here["text/html"]
    assert here[PLOTLY]["data"] == there[PLOTLY]["data"]
