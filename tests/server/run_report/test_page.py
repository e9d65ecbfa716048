"""A run as one HTML file: what stands in it, and that nothing in it can become markup."""

from __future__ import annotations

import json
import re
from html import escape

import pytest

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.robot.loop.verdict import judge_goals
from slidetune.server.report.run_report import (
    Document,
    json_text,
    overall_rows,
    per_joint_rows,
    report,
)
from slidetune.server.run_report import apart
from slidetune.server.run_report.apart import record_apart
from slidetune.server.run_report.described import difference_rows, gain_rows
from slidetune.server.run_report.page import run_report
from slidetune.server.run_report.recording import record

HOSTILE = "</script><script>alert(1)</script><!--place:plotly-->"
LANE, GOAL = "N&\"' {x}", "near & \"'"
JOINTS = (False,) * 6


@pytest.fixture(scope="module")
def run() -> Run:
    lanes = {LANE: {"law": "nftsm"}, "calm": {"law": "computed_torque", "kp": 1, "kd": 1}}
    goals = {
        GOAL: {"kind": "response", "channel": "e", "bound": 1e-6, "priority": "hard"},
        "calm": {"kind": "figure", "figure": "chattering", "bound": 1e6},
    }
    simulation = {"mode": "sampled", "horizon": 0.5}
    return simulate(
        Experiment.from_document(
            {
                "title": HOSTILE,
                "description": f"<img src=x onerror=alert(2)>\n\n{HOSTILE}",
                "lanes": lanes,
                "goals": goals,
                "simulation": simulation,
            }
        )
    )


@pytest.fixture(scope="module")
def document(run: Run) -> Document:
    return report(run)


@pytest.fixture(scope="module")
def page(run: Run, document: Document) -> str:
    return run_report(run, document, record).html


def cells(page: str) -> list[str]:
    return re.findall(r"<td>(.*?)</td>", page, re.DOTALL)


def test_its_figures_are_those_of_the_json_of_the_same_run(page: str, document: Document) -> None:
    data = re.search(r'id="report">(.*?)</script>', page, re.DOTALL)
    assert data is not None
    assert json.loads(data[1]) == json.loads(json_text(document))
    shown = cells(page)
    for rows in (overall_rows, per_joint_rows):
        for row in rows(document["lanes"], JOINTS)[1]:
            texts = [escape(text) for text in row]
            places = range(len(shown) - len(texts) + 1)
            assert any(shown[place : place + len(texts)] == texts for place in places), row


def test_nothing_that_a_person_wrote_becomes_markup(page: str, run: Run) -> None:
    visible = page.partition('<script type="application/json"')[0]
    assert "<script>alert" not in page
    assert "<img src=x" not in page
    assert page.count("plotly.js v") == 1
    assert escape(HOSTILE) in visible
    assert LANE not in visible
    assert escape(LANE) in visible
    assert escape(GOAL) in visible
    assert escape(experiment_to_yaml(run.experiment)) in page


def test_a_lane_that_diverged_says_why_and_its_goals_are_unknown(page: str, run: Run) -> None:
    freeze = run.lanes[LANE].freeze
    assert freeze is not None
    assert f"diverged: {escape(freeze.cause)}" in page
    lane = run.lanes["calm"]
    ratio = judge_goals(run.experiment.goals, lane, lane.metrics).ratios[GOAL]
    assert ratio is not None
    row = cells(page)
    place = row.index(escape(GOAL))
    assert row[place + 2 : place + 5] == ["hard", "unknown", f"{ratio:.3g} missed"]


def test_advice_and_what_is_inaccurate_stand_in_it(page: str, document: Document) -> None:
    notes = [note for lane in document["lanes"].values() for note in lane["notes"]]
    assert notes
    assert all(escape(note["message"]) in page for note in notes)
    coarse = {"step": 0.005, "scheme": "plain", "horizon": 2.0}
    lanes = {"A": {"law": "rbfnn_nftsm"}}
    inaccurate = simulate(Experiment.from_document({"lanes": lanes, "simulation": coarse}))
    remark = inaccurate.lanes["A"].accuracy.remark
    assert remark
    made = run_report(inaccurate, report(inaccurate), lambda _: b"")
    assert escape(remark) in made.html
    assert made.rate == 0.0


def test_differences_are_those_that_were_made_and_no_others() -> None:
    base = load_preset("paper")
    patch = {
        "lanes": {"NFTSM": {"nu": 30.5, "k1": [1, 2, 3, 4, 5, 6]}, "RBFNN-SMC": None},
        "robot": {"payload": {"mass": 2}},
        "title": "Another",
    }
    headings, rows = difference_rows(base, base.patched(patch))
    assert headings == ["field", "name", "preset", "here", "unit"]
    old = base.lanes["NFTSM"]
    assert {row[0]: row[2:] for row in rows} == {
        "lanes.RBFNN-SMC": ["RBFNN-SMC", "—", ""],
        "lanes.NFTSM.nu": [f"{old.nu:g}", "30.5", "1/s"],
        "lanes.NFTSM.k1": [f"{old.k1:g}", "1, 2, 3, 4, 5, 6", "N·m·s/rad"],
        "robot.payload.mass": ["0", "2", "kg"],
    }
    assert difference_rows(base, base)[1] == []


def test_every_gain_of_every_lane_is_listed() -> None:
    experiment = load_preset("paper")
    headings, rows = gain_rows(experiment)
    assert headings[2:-1] == list(experiment.lanes)
    for number, lane in enumerate(experiment.lanes.values(), 2):
        told = sum(row[number] != "—" for row in rows)
        assert told == len(type(lane).model_fields)  # its law is the first row


def test_a_replay_that_is_lost_leaves_the_report_whole(
    monkeypatch: pytest.MonkeyPatch, run: Run, document: Document
) -> None:
    monkeypatch.setattr(apart, "_MODULE", "slidetune.robot.version")
    made = run_report(run, document, record_apart)
    assert "There is no replay: what records the replay ended the process" in made.html
    assert (
        "replay-data" not in made.html.partition("<script>'use strict'")[0].rpartition("Plotly")[2]
    )
    assert overall_rows(document["lanes"], JOINTS)[1][1][1] in made.html
