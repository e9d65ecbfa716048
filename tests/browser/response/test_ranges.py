"""What was before the last change is seen whole, and only where it is a change of what is shown."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.response.test_response import (
    curves,
    lines_before,
    open_response,
    row,
    type_in,
    until_estimated,
)
from tests.browser.response.test_response_before import until

GAIN = "lanes.RBFNN-NFTSM.nu"
GREAT = "-120"
"""Largest constant torque [N m], almost four times that of the preset."""
OUTSIDE = """lines => lines.map(line => {
  const curve = line.getBBox();
  const clip = line.closest('[clip-path]').getAttribute('clip-path').match(/#[^'")]+/)[0];
  const panel = document.querySelector(`${clip} rect`);
  const [width, height] = ['width', 'height'].map(name => Number(panel.getAttribute(name)));
  return Math.max(
    -curve.y, curve.y + curve.height - height, width - curve.x - curve.width);
})"""
"""How far each curve leaves its panel, or ends before its right edge, in pixels."""


def test_every_panel_shows_the_curves_before_an_undo_whole(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    page.locator("summary", has_text="Disturbance").click()
    type_in(page, "disturbance.constant", GREAT)
    until_estimated(page, dashboard)
    page.keyboard.press("Control+z")
    expect(page.locator("[data-path='disturbance.constant'].is-changed")).to_have_count(0)
    until_estimated(page, dashboard)
    # The ranges begin anew.
    for tab in ("Torque", "Error"):
        shown = curves(page)
        page.locator(".response").get_by_role("tab", name=tab, exact=True).click()
        until(page, lambda shown=shown: curves(page) != shown)
    # Curves and ranges may be drawn one after the other.
    until(page, lambda: max(lines_before(page).evaluate_all(OUTSIDE), default=1.0) < 1.0)


def test_a_loaded_experiment_is_compared_with_no_other(page: Page, dashboard: Dashboard) -> None:
    open_response(page, dashboard)
    type_in(page, GAIN, "3")
    until_estimated(page, dashboard)
    expect(lines_before(page)).to_have_count(3)
    for preset in ("paper", "chattering-tanh"):
        dashboard.client.post(f"/api/presets/{preset}/load").raise_for_status()
        expect(page.locator(".response-status")).to_have_attribute("data-estimated", "true")
        expect(lines_before(page)).to_have_count(0)


def test_the_best_of_each_column_is_bold_and_a_diverged_lane_has_no_figures(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    cells = page.locator(".response-table .metrics-mae1")
    figures = [float(text) for text in cells.all_inner_texts()]
    best = page.locator(".response-table .metrics-mae1.is-best")
    expect(best).to_have_count(1)
    assert float(best.inner_text()) == min(figures)
    dashboard.client.patch("/api/experiment", json={"simulation": {"mode": "sampled"}})
    expect(row(page, "NFTSM")).to_contain_text("diverged", timeout=60_000)
    assert set(cells.all_inner_texts()) == {"–"}
    expect(best).to_have_count(0)
