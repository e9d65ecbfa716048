"""The page of the paper's figures, opened from disk in a real Chromium."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

from robot.presets import load_preset
from robot.simulate import simulate
from server.paper_figures import paper_page
from server.paper_table import PRESETS

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine"),
]

DRAWN = "() => document.querySelectorAll('.plot .scatterlayer .trace').length"
PAPER = "() => document.querySelector('.plot')._fullLayout.paper_bgcolor"


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "paper.html"
    runs = {name: simulate(load_preset(name)) for name in PRESETS}
    path.write_text(paper_page(runs), encoding="utf-8")
    return path


def test_all_figures_are_drawn_without_a_word_to_any_network(page_file: Path) -> None:
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page(color_scheme="light", viewport={"width": 420, "height": 800})
        asked: list[str] = []
        complaints: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(page_file.as_uri())
        # Six figures with three curves, nine with the desired one beside them.
        page.wait_for_function(f"({DRAWN})() === 6 * 3 + 9 * 4")
        light = page.evaluate(PAPER)
        page.emulate_media(color_scheme="dark")
        page.wait_for_function(f"light => ({PAPER})() !== light", arg=light)
        assert page.evaluate(DRAWN) == 6 * 3 + 9 * 4
        assert page.evaluate("document.documentElement.scrollWidth") <= 420
        assert asked == [page_file.as_uri()]
        assert complaints == []
        browser.close()
