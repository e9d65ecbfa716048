"""The table of the live session: it says since when it counts, and what it is not."""

from __future__ import annotations

import re

from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard


def row(page: Page, lane: str) -> Locator:
    name = page.get_by_role("button", name=lane, exact=True)
    return page.locator("#metrics tbody tr").filter(has=name)


def patch(dashboard: Dashboard, lanes: dict[str, object]) -> None:
    dashboard.client.patch("/api/experiment", json={"lanes": lanes}).raise_for_status()


def test_each_lane_says_since_when_its_live_figures_count(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    for lane in ("RBFNN-NFTSM", "RBFNN-SMC", "NFTSM"):
        expect(row(page, lane).locator("th")).to_contain_text("since reset")
    patch(dashboard, {"NFTSM": {"nu": 3}})
    changed = row(page, "NFTSM").locator(".metrics-since")
    expect(changed).to_have_text(re.compile(r"^since \d+\.\d s \(last change\)$"))
    expect(row(page, "RBFNN-SMC").locator("th")).to_contain_text("since reset")
    # Over different times none is the best.
    expect(page.locator("#metrics .is-best")).to_have_count(0)
    words = changed.inner_text()
    gains = dashboard.client.get("/api/experiment").json()["experiment"]["lanes"]["NFTSM"]
    patch(dashboard, {"NFTSM": None, "Other name": gains})
    expect(row(page, "Other name").locator("td").first).to_have_text(re.compile(r"\d"))
    expect(row(page, "Other name").locator(".metrics-since")).to_have_text(words)
    page.locator("[data-view=response]").click()
    heads = page.locator(".metrics-title, .response-table thead th:first-child").all_inner_texts()
    assert len(set(heads)) == 2
    page.locator("#metrics").get_by_role("button", name="Reset").click()
    expect(row(page, "Other name").locator("th")).to_contain_text("since reset")
    expect(page.locator("#metrics .is-best").first).to_be_visible()
