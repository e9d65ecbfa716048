"""The menu Export makes a report of the live experiment."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard


def test_a_report_is_made_of_the_live_experiment_and_it_is_said_meanwhile(
    page: Page, dashboard: Dashboard, tmp_path: Path
) -> None:
    patch = {"title": "Live now", "simulation": {"horizon": 0.3}}
    dashboard.client.patch("/api/experiment", json=patch).raise_for_status()
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    page.get_by_role("button", name="Export").click()
    with page.expect_download(timeout=180_000) as saved:
        page.get_by_role("menuitem", name="Report (HTML)").click()
        expect(page.locator(".notice")).to_contain_text("The report is being made")
    expect(page.locator(".notice")).to_have_count(0)
    assert saved.value.suggested_filename == "paper-report.html"
    path = tmp_path / "report.html"
    saved.value.save_as(path)
    page.goto(path.as_uri())
    expect(page.locator("h1")).to_have_text("Live now")
    expect(page.locator("#command")).to_contain_text("python -m slidetune run 1.paper.")
    expect(page.locator(".plot .scatterlayer path.js-line").first).to_be_attached()
