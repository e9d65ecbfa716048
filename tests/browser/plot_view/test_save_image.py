"""Plots without a toolbar are saved as pictures, with all that is drawn over them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import open_lens
from tests.browser.study_search.searches import GOALS, mounted, searched

SCALE = 3
"""Pixels of a PNG for each one on the screen."""


def save(page: Page, figure: Locator, what: str, path: Path) -> str:
    figure.scroll_into_view_if_needed()
    figure.hover(position={"x": 30, "y": 10})
    figure.get_by_role("button", name="Save this plot").click()
    with page.expect_download() as saved:
        page.locator("[popover]:popover-open .menu-item", has_text=what).click()
    saved.value.save_as(path)
    return saved.value.suggested_filename


def colors(path: Path) -> set[tuple[int, ...]]:
    with Image.open(path) as picture:
        pixels = np.asarray(picture.convert("RGB")).reshape(-1, 3)
    return {tuple(color) for color in np.unique(pixels, axis=0).tolist()}


def test_a_lens_is_saved_as_it_is_seen(page: Page, dashboard: Dashboard, tmp_path: Path) -> None:
    open_lens(page, dashboard, "Chattering")
    figure = page.locator(".lens-figure:visible").first
    expect(figure.locator(".main-svg").first).to_be_visible()
    name = save(page, figure, "PNG", tmp_path / "lens.png")
    assert name.startswith("slidetune-")
    size = figure.bounding_box()
    assert size is not None
    with Image.open(tmp_path / "lens.png") as picture:
        head = picture.height - SCALE * size["height"]  # says what is seen
        assert 20 * SCALE <= head <= 60 * SCALE
        assert abs(picture.width - SCALE * size["width"]) <= SCALE
    assert len(colors(tmp_path / "lens.png")) > 20
    save(page, figure, "SVG", tmp_path / "lens.svg")
    text = (tmp_path / "lens.svg").read_text(encoding="utf-8")
    assert text.count("<path") > 3
    assert "Hz" in text
    label = figure.locator(".lens-graph").get_attribute("aria-label")
    assert label
    assert label.split()[0] in text


def test_points_of_a_search_are_in_its_picture(
    page: Page, dashboard: Dashboard, tmp_path: Path
) -> None:
    study = searched(dashboard, GOALS, trials=8)
    mounted(page, dashboard, study)
    figure = page.locator(".search-figure:visible").filter(has=page.locator(".plot-save")).first
    drawn = figure.locator("canvas").evaluate(
        """canvas => {
            const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
            const seen = new Set();
            for (let at = 0; at < data.length; at += 4) {
                if (data[at + 3] === 255) seen.add([...data.slice(at, at + 3)].join());
            }
            return [...seen];
        }"""
    )
    assert drawn
    save(page, figure, "PNG", tmp_path / "points.png")
    seen = colors(tmp_path / "points.png")
    near = [
        any(
            max(abs(a - b) for a, b in zip(map(int, one.split(",")), other, strict=True)) < 4
            for other in seen
        )
        for one in drawn
    ]
    assert sum(near) > 0.8 * len(near)
    page.get_by_role("tab", name="Gains and score").click()
    lines = page.locator(".search-figure:visible").filter(has=page.locator(".search-strips"))
    assert "parallel" in save(page, lines, "SVG", tmp_path / "lines.svg")
    assert "<image" in (tmp_path / "lines.svg").read_text(encoding="utf-8")
    save(page, lines, "PNG", tmp_path / "lines.png")
    assert len(colors(tmp_path / "lines.png")) > 20
