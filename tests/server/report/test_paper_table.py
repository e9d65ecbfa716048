"""The paper's Table 2 and ours."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.report.paper_table import (
    DISTURBED,
    LAWS,
    PRESETS,
    PUBLISHED,
    SOURCES,
    UNDISTURBED,
    Cell,
    comparison,
    figures,
    flange_rows,
    print_comparison,
)

# Computed once with an implicit Runge-Kutta method of high order, independent of this program:
# mean |e| of joints 1 to 3, max |e|, max |de| for t > 1 s, and the last digit of each.
EXPECTED = {
    UNDISTURBED: {
        "RBFNN-NFTSM": ((0.0021, 0.0320, 0.0054, 0.049, 0.034), (4, 4, 4, 3, 3)),
        "RBFNN-SMC": ((0.0070, 0.0433, 0.0202, 0.182, 0.155), (4, 4, 4, 3, 3)),
        "NFTSM": ((0.0091, 0.0120, 0.0036, 0.014, 0.0003), (4, 4, 4, 3, 4)),
    },
    DISTURBED: {
        "RBFNN-NFTSM": ((0.0043, 0.0261, 0.0049, 0.044, 0.034), (4, 4, 4, 3, 3)),
        "RBFNN-SMC": ((0.0060, 0.0413, 0.0195, 0.138, 0.170), (4, 4, 4, 3, 3)),
        "NFTSM": ((0.0340, 0.0499, 0.0302, 0.095, 0.011), (4, 4, 4, 3, 3)),
    },
}
FLANGE = {"RBFNN-NFTSM": (30.4, 19.6), "RBFNN-SMC": (47.5, 18.5), "NFTSM": (114.0, 67.3)}


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    return {name: simulate(load_preset(name)) for name in PRESETS}


@pytest.mark.parametrize("preset", EXPECTED)
@pytest.mark.parametrize("law", LAWS)
def test_our_figures_agree_with_an_independent_solution(
    preset: str, law: str, runs: dict[str, Run]
) -> None:
    expected, digits = EXPECTED[preset][law]
    ours = figures(runs[preset].lanes[law])
    for value, wanted, digit in zip(ours, expected, digits, strict=True):
        assert abs(value - wanted) <= 2.0 * 10.0**-digit


def test_a_lane_that_stopped_early_has_a_dash_for_a_velocity_error() -> None:
    simulation = {"mode": "sampled", "horizon": 0.5}
    document = {"lanes": {"A": {"law": "nftsm"}}, "simulation": simulation}
    stopped = simulate(Experiment.from_document(document), estimate=False).lanes["A"]
    assert stopped.freeze is not None
    *others, velocity = figures(stopped)
    assert np.isfinite(others).all()
    assert Cell(velocity, "different").text() == "—"


def test_flange_errors_agree_with_an_independent_solution(runs: dict[str, Run]) -> None:
    for law, _, greatest, effective in flange_rows(runs):
        assert (float(greatest), float(effective)) == pytest.approx(FLANGE[law], abs=0.2)


def test_published_figures_stand_as_printed_beside_ours(runs: dict[str, Run]) -> None:
    rows = comparison(runs)
    assert [row.law for row in rows] == [law for law in LAWS for _ in range(3)]
    first = [cell.text() for cell in rows[0].cells]
    assert first == ["0.004", "0.03", "0.004", "0.05", "0.03"]
    for row in rows[::3]:
        assert row.source == "published"
        assert tuple(cell.value for cell in row.cells) == PUBLISHED[row.law]


def test_what_was_fitted_is_never_called_reproduced(runs: dict[str, Run]) -> None:
    rows = {(row.law, row.source): row for row in comparison(runs)}
    verdicts = [cell.verdict for cell in rows["NFTSM", SOURCES[DISTURBED]].cells]
    assert verdicts == ["fitted"] * 3 + ["different"] * 2
    fitted = [key for key, row in rows.items() if any(c.verdict == "fitted" for c in row.cells)]
    assert fitted == [("NFTSM", SOURCES[DISTURBED])]


def test_what_does_not_come_out_is_marked(runs: dict[str, Run]) -> None:
    rows = {(row.law, row.source): row for row in comparison(runs)}
    smc = [cell.verdict for cell in rows["RBFNN-SMC", SOURCES[DISTURBED]].cells]
    assert smc == ["different", "same", "different", "different", "different"]
    proposed = rows["RBFNN-NFTSM", SOURCES[DISTURBED]].cells
    assert [cell.verdict for cell in proposed] == ["same"] * 5


def test_the_printed_table_holds_all_cells_and_says_what_failed(runs: dict[str, Run]) -> None:
    output = io.StringIO()
    print_comparison(runs, Console(file=output, width=160))
    text = output.getvalue()
    for row in comparison(runs):
        assert all(cell.text() in text for cell in row.cells)
    assert "Not reproduced" in text
