"""The page of the paper's figures, opened from disk."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page

from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.server.report.paper_figures import paper_page
from slidetune.server.report.paper_table import PRESETS

CURVES = 6 * 3 + 9 * 4
"""Six figures show the three laws, nine the desired motion beside them."""
DRAWN = "() => document.querySelectorAll('.plot .scatterlayer .trace').length"
BACKGROUND = "() => document.querySelector('.plot .main-svg').style.background"


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "paper.html"
    runs = {name: simulate(load_preset(name)) for name in PRESETS}
    path.write_text(paper_page(runs), encoding="utf-8")
    return path


def test_all_figures_are_drawn_without_a_word_to_any_network(file: Path, page: Page) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(file.as_uri())
    page.wait_for_function(f"({DRAWN})() === {CURVES}")
    assert asked == [file.as_uri()]


def test_figures_follow_light_and_dark(file: Path, page: Page) -> None:
    page.emulate_media(color_scheme="light")
    page.goto(file.as_uri())
    page.wait_for_function(f"({DRAWN})() === {CURVES}")
    light = page.evaluate(BACKGROUND)
    assert light
    page.emulate_media(color_scheme="dark")
    page.wait_for_function(f"light => ({BACKGROUND})() !== light", arg=light)
    assert page.evaluate(DRAWN) == CURVES


def test_the_page_fits_a_phone(file: Path, page: Page) -> None:
    page.set_viewport_size({"width": 390, "height": 800})
    page.goto(file.as_uri())
    page.wait_for_function(f"({DRAWN})() === {CURVES}")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
