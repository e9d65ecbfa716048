"""The figures of a run, as JSON and as a table."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from slidetune.robot.advice.advice import advice_on
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.packed import pack
from slidetune.robot.loop.figures import FIGURES, figures_of
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.report.run_report import UNITS, figure_text, json_text, print_report, report


@pytest.fixture(scope="module")
def run() -> Run:
    lanes = {"A": {"law": "nftsm"}, "calm": {"law": "computed_torque", "kp": 1, "kd": 1}}
    simulation = {"mode": "sampled", "horizon": 0.5}
    return simulate(Experiment.from_document({"lanes": lanes, "simulation": simulation}))


def printed(run: Run, since: float = 0.0) -> str:
    text = io.StringIO()
    print_report(report(run, since), Console(file=text, width=160))
    return text.getvalue()


def test_every_figure_has_a_unit(run: Run) -> None:
    assert set(UNITS) == {*run.lanes["A"].metrics.document(), "error_estimate"}


def test_every_figure_of_a_run_stands_in_the_table_under_its_heading(run: Run) -> None:
    text = " ".join(printed(run).split())
    for entry in figures_of("run"):
        assert f"{entry.heading} [{entry.shown_unit}]" in text


def test_the_json_of_a_diverged_run_is_strict(run: Run) -> None:
    text = json_text(report(run))
    assert "NaN" not in text
    assert "Infinity" not in text


def test_a_lane_that_stood_still_has_no_figures_rather_than_wrong_ones(run: Run) -> None:
    freeze = run.lanes["A"].freeze
    assert freeze is not None
    later = report(run, freeze.time + 0.01)["lanes"]
    assert later["A"]["metrics"] is None
    assert later["A"]["frozen"]["cause"] == freeze.cause
    assert later["calm"]["metrics"]["diverged_at"] is None
    assert "—" in printed(run, freeze.time + 0.01)


def test_how_good_the_run_is_is_told_in_the_table_and_in_words(run: Run) -> None:
    accuracy = run.lanes["calm"].accuracy
    assert accuracy.error_estimate is not None
    document = report(run)
    assert document["lanes"]["calm"]["accuracy"] == accuracy.document()
    text = " ".join(printed(run).split())
    assert "error estimate [mrad]" in text
    assert figure_text(FIGURES["error_estimate"], accuracy.error_estimate) in text
    coarse = {"step": 0.005, "scheme": "plain", "horizon": 2.0}
    experiment = {"lanes": {"A": {"law": "rbfnn_nftsm"}}, "simulation": coarse}
    inaccurate = simulate(Experiment.from_document(experiment))
    remark = inaccurate.lanes["A"].accuracy.remark
    assert remark
    assert f"inaccurate, A: {remark}" in " ".join(printed(inaccurate).split())


def test_remarks_and_causes_are_printed_in_words(run: Run) -> None:
    text = " ".join(printed(run).split())
    freeze = run.lanes["A"].freeze
    assert freeze is not None
    assert " ".join(freeze.cause.split()) in text
    remarks = advice_on(pack(run.experiment), "A")
    assert remarks
    assert all(" ".join(note.message.split()) in text for note in remarks)


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "—"), (0.0, "0"), (999.96, "1000"), (165667.2, "165,667"), (0.00012346, "0.0001235")],
)
def test_numbers_are_printed_as_people_read_them(value: float | None, text: str) -> None:
    assert figure_text(FIGURES["chattering"], value) == text
