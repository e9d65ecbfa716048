"""The page that mirrors the paper's figures."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import Run, simulate
from slidetune.server.hosting.static_paths import PLOTLY
from slidetune.server.live.lane_colors import PALETTE
from slidetune.server.report.paper_figures import paper_page
from slidetune.server.report.paper_table import LAWS, PRESETS, comparison

AXES = {
    **dict.fromkeys((4, 5, 6), "q [rad]"),
    **dict.fromkeys((7, 8, 9), "e [rad]"),
    **dict.fromkeys((10, 11, 12), "v [rad/s]"),
    **dict.fromkeys((13, 14, 15), "de [rad/s]"),
    17: "X [m]",
    18: "Y [m]",
    19: "Z [m]",
}
WITH_DESIRED = (4, 5, 6, 10, 11, 12, 17, 18, 19)


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    return {name: simulate(load_preset(name)) for name in PRESETS}


@pytest.fixture(scope="module")
def page(runs: dict[str, Run]) -> str:
    return paper_page(runs)


@pytest.fixture(scope="module")
def figures(page: str) -> dict[int, Any]:
    """The figures by the paper's number."""
    data = re.search(r'id="data">(.*?)</script>', page, re.DOTALL)
    assert data is not None
    drawn = [figure for section in json.loads(data[1]) for figure in section["figures"]]
    return {int(re.findall(r"Figure (\d+)", item["caption"])[0]): item for item in drawn}


def test_every_figure_is_there_with_its_axes(figures: dict[int, Any]) -> None:
    assert {number: figure["axis"] for number, figure in figures.items()} == AXES
    assert all(figure["range"] == [0.0, 10.0] for figure in figures.values())


def test_every_figure_shows_the_three_laws_in_their_colours(figures: dict[int, Any]) -> None:
    for number, figure in figures.items():
        drawn = [(curve["name"], curve["color"]) for curve in figure["curves"]]
        desired = [("desired", "")] if number in WITH_DESIRED else []
        assert drawn == [*zip(LAWS, PALETTE, strict=False), *desired]


def test_curves_reach_the_greatest_error_of_the_run(
    figures: dict[int, Any], runs: dict[str, Run]
) -> None:
    for joint in range(3):
        for curve in figures[7 + joint]["curves"]:
            greatest = runs["paper"].lanes[curve["name"]].metrics.max_error[joint]
            assert max(map(abs, curve["y"])) == pytest.approx(greatest, rel=1e-4)


def test_the_page_asks_no_other_machine_for_anything(page: str) -> None:
    own = page.replace(PLOTLY.read_text(encoding="utf-8"), "")
    assert len(own) < len(page)
    assert not re.search(r"https?:|//\w+\.\w|src=|href=|@import|url\(", own)
    assert "default-src 'none'" in own


def test_the_page_holds_the_table_and_stays_below_8_megabytes(
    page: str, runs: dict[str, Run]
) -> None:
    for row in comparison(runs):
        assert all(f"<td>{cell.text()}</td>" in page for cell in row.cells)
    assert len(page.encode()) < 8e6
