"""Bounds are drawn and moved with a finger, on a screen as small as a phone's."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.bounds.test_bounds import NEAR, SHORT, at, grip, middle, until, until_one
from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import patch
from tests.browser.screen.test_touch import swipe


@pytest.fixture(scope="module")
def window() -> dict[str, Any]:
    return {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}


def open_plots(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Plots").tap()
    page.get_by_role("tab", name="Response", exact=True).tap()
    expect(page.locator(".response .trace path.js-line").nth(8)).to_be_attached()


def test_a_finger_draws_a_band(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, SHORT)
    open_plots(page, dashboard)
    page.locator(".response").get_by_role("button", name="Draw a bound").tap()
    expect(page.locator(".bound-sheet")).to_be_visible()
    swipe(page, at(page, 1, 0.5, 0.0), at(page, 1, 1.5, 0.05))
    goal = until_one(dashboard)
    assert (goal["channel"], goal["joint"]) == ("e", 2)
    assert goal["start"] == pytest.approx(0.5, abs=0.02)
    assert goal["end"] == pytest.approx(1.5, abs=0.02)
    assert goal["bound"] == pytest.approx(0.05, rel=0.1)
    expect(page.get_by_role("status").filter(has_text="New goal")).to_be_visible()


def test_a_finger_takes_the_knob_of_a_line(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"goals": {"near": NEAR}, **SHORT})
    open_plots(page, dashboard)
    start = middle(grip(page, "value"))
    swipe(page, start, (start[0], at(page, 1, 1.0, 0.03)[1]))
    until(dashboard, lambda goals: goals["near"]["bound"] == pytest.approx(0.03, rel=0.1))


def test_without_escape_drawing_is_cancelled_with_a_button(
    page: Page, dashboard: Dashboard
) -> None:
    patch(dashboard, SHORT)
    open_plots(page, dashboard)
    page.locator(".response").get_by_role("button", name="Draw a bound").tap()
    page.get_by_role("button", name="Cancel").tap()
    expect(page.locator(".bound-sheet")).to_be_hidden()
