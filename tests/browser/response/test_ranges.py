"""What was before the last change is seen whole, and only where it is a change of what is shown."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.response.test_response import (
    lines_before,
    open_response,
    row,
    type_in,
    until_estimated,
)

GAIN = "lanes.RBFNN-NFTSM.nu"
GREAT = [-100.0, -170.0, -100.0, 0.0, 0.0, 0.0]
FITTED = [-22.5, -33.0, -20.0, 0.0, 0.0, 0.0]
"""Constant torques [N m]; the second is the preset's."""
OUTSIDE = """lines => lines.map(line => {
  const curve = line.getBBox();
  const clip = line.closest('[clip-path]').getAttribute('clip-path').match(/#[^'")]+/)[0];
  const height = Number(document.querySelector(`${clip} rect`).getAttribute('height'));
  return Math.max(-curve.y, curve.y + curve.height - height);
})"""
"""How far each curve leaves its panel in pixels."""


def test_every_panel_shows_the_curves_before_an_undo_whole(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    for torque in (GREAT, FITTED):
        dashboard.client.patch("/api/experiment", json={"disturbance": {"constant": torque}})
        until_estimated(page, dashboard)
    expect(lines_before(page)).to_have_count(9)
    assert max(lines_before(page).evaluate_all(OUTSIDE)) < 1.0


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
