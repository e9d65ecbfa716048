"""What the screen owes to those who come by keyboard, by ear, with weak eyes or a shaky hand."""

from __future__ import annotations

import io
import re
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard

TARGET = 24.0
"""Least size of a target in pixels (WCAG 2.2, 2.5.8)."""
CONTRAST = 4.5
"""Least contrast of small text (WCAG 2.2, 1.4.3)."""


@pytest.fixture
def screen(dashboard: Dashboard, page: Page) -> Page:
    """The dashboard with runs of one second, without the 3D scene."""
    patch = {"simulation": {"horizon": 1.0}}
    dashboard.client.patch("/api/experiment", json=patch).raise_for_status()
    page.goto(dashboard.url)
    expect(page.locator(".lane")).to_have_count(3)
    return page


def pixels(part: Locator) -> np.ndarray:
    """Return the colours of an element as drawn. Shape (height, width, 3)."""
    return np.asarray(Image.open(io.BytesIO(part.screenshot())).convert("RGB"))


def luminance(colour: np.ndarray) -> float:
    share = colour / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(part: Locator) -> float:
    """Return the contrast of an element's text to what lies behind it."""
    colours, counts = np.unique(pixels(part).reshape(-1, 3), axis=0, return_counts=True)
    ink = part.evaluate("node => getComputedStyle(node).color")
    text = luminance(np.array([float(value) for value in re.findall(r"[\d.]+", ink)[:3]]))
    ground = luminance(colours[counts.argmax()].astype(float))
    return (max(text, ground) + 0.05) / (min(text, ground) + 0.05)


@pytest.mark.parametrize("width", [1440, 390])
def test_the_first_stops_of_the_tab_key_skip_to_the_parts(screen: Page, width: int) -> None:
    screen.set_viewport_size({"width": width, "height": 900})
    for part in ("controls", "play", "plots"):
        screen.reload()
        expect(screen.locator(".control").first).to_be_attached()
        link = screen.get_by_role("link", name=f"Skip to {part}")
        for _ in range(3):
            screen.keyboard.press("Tab")
            if link.evaluate("node => node === document.activeElement"):
                break
        expect(link).to_be_focused()
        expect(link).to_have_css("clip-path", "none")
        expect(link).to_be_in_viewport(ratio=1)
        screen.keyboard.press("Enter")
        place = {"controls": "tune", "play": "transport", "plots": "plots"}[part]
        expect(screen.locator(f"#{place} :focus")).to_be_visible()


def test_a_legend_says_which_curves_are_shown(screen: Page) -> None:
    entry = screen.locator(".plots-legend").first.get_by_role("button", name="NFTSM", exact=True)
    expect(entry).to_have_attribute("aria-pressed", "true")
    entry.click()
    expect(entry).to_have_attribute("aria-pressed", "false")


def test_a_way_back_is_named_with_its_unit_as_it_is_written(screen: Page) -> None:
    dot = screen.locator('[data-path="lanes.RBFNN-NFTSM.k1"] .control-dot')
    expect(dot).to_have_attribute("aria-label", re.compile(r": back to 150 N·m·s/rad$"))


def test_small_buttons_are_large_enough_to_hit(screen: Page) -> None:
    screen.get_by_role("button", name="Which knob next?").click()
    expect(screen.locator(".tornado-progress")).to_be_hidden(timeout=60_000)
    rows = [row.bounding_box() for row in screen.locator(".tornado-row").all()]
    assert len(rows) > 4
    assert min(row["height"] for row in rows if row) >= TARGET
    joints = [button.bounding_box() for button in screen.locator(".plots-toggle:visible").all()]
    places = [box for box in joints if box]
    assert len(places) == 6
    assert min(box["height"] for box in places) >= TARGET
    # Neighbours overlap by their border: a target ends where the next begins.
    steps = [right["x"] - left["x"] for left, right in pairwise(places)]
    assert min(steps) >= TARGET


def test_the_state_of_the_chosen_lane_is_legible(screen: Page) -> None:
    for lane in screen.locator(".lane").all():
        lane.locator(".lane-pick").click()
        screen.mouse.move(2, 2)
        status = lane.locator(".lane-status")
        expect(status).to_have_text("running")
        assert contrast(status) >= CONTRAST


def test_a_long_description_ends_with_an_ellipsis_and_is_read_in_full_when_asked(
    screen: Page, dashboard: Dashboard
) -> None:
    text, more = screen.locator(".about-text"), screen.get_by_role("button", name="Read all")
    expect(more).to_be_visible()
    sizes = text.evaluate(
        "node => [node.clientHeight, node.scrollHeight,"
        " parseFloat(getComputedStyle(node).lineHeight)]"
    )
    assert sizes[0] < sizes[1]
    # Whole lines, the last of which ends in an ellipsis.
    assert sizes[0] / sizes[2] == pytest.approx(round(sizes[0] / sizes[2]), abs=0.1)
    expect(text).to_have_css("-webkit-line-clamp", "5")
    more.click()
    assert text.evaluate("node => node.scrollHeight - node.clientHeight") == 0
    screen.get_by_role("button", name="Show less").click()
    assert text.evaluate("node => node.clientHeight") == sizes[0]
    patch = {"description": "Look at joint 2."}
    dashboard.client.patch("/api/experiment", json=patch).raise_for_status()
    expect(text).to_have_text("Look at joint 2.")
    expect(more).to_be_hidden()


def test_a_line_of_the_table_runs_through_all_its_columns(screen: Page) -> None:
    second = screen.locator("#metrics tbody tr").nth(1)
    expect(second.locator("td").first).not_to_be_empty()
    box = second.bounding_box()
    assert box is not None
    clip = {"x": box["x"], "y": box["y"] - 2, "width": box["width"], "height": 5}
    drawn = Image.open(io.BytesIO(screen.screenshot(clip=clip))).convert("RGB")
    strip = np.asarray(drawn).astype(int).sum(axis=2)
    line = strip[np.median(strip, axis=1).argmin()]
    assert np.ptp(line) == 0
