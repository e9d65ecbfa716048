"""A range that is off until it is switched on: what robustness draws from."""

from __future__ import annotations

import re
import time
from typing import Any

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import experiment


def until(dashboard: Dashboard, wanted: Any) -> None:
    end = time.monotonic() + 60.0
    while (now := experiment(dashboard)["uncertainty"]["payload"]) != wanted:
        assert time.monotonic() < end, f"payload stayed {now}"
        time.sleep(0.05)


def test_a_range_is_switched_on_with_what_is_usual_and_refuses_to_be_upside_down(
    page: Page, dashboard: Dashboard
) -> None:
    page.goto(dashboard.url)
    group = page.locator("details.group", has=page.locator("summary", has_text="Uncertainty"))
    group.locator("summary").click()
    control = page.locator('.control[data-path="uncertainty.payload"]')
    control.get_by_role("switch").check()
    expect(control.locator(".joint-values")).to_have_text("0 to 2")
    until(dashboard, [0, 2])
    control.locator("button[aria-expanded]").click()
    rows = control.locator(".joint-row")
    expect(rows).to_have_count(2)
    expect(rows.locator(".joint-name")).to_have_text(["from", "to"])
    box = rows.nth(0).locator("input:not([type=range])")
    box.fill("5")
    box.press("Enter")
    expect(control).to_contain_text(re.compile("from the least to the greatest"))
    assert experiment(dashboard)["uncertainty"]["payload"] == [0, 2]
    control.get_by_role("switch").uncheck()
    expect(control.locator(".joint-row").first).to_be_hidden()
    until(dashboard, None)
