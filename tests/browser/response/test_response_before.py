"""The response as it was before the last change stays in sight behind the present one."""

from __future__ import annotations

import time
from collections.abc import Callable

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.response.test_response import (
    KEEP_SHOWN,
    LANES,
    held,
    lines_before,
    lines_shown,
    open_response,
    paths,
    type_in,
    until_estimated,
    until_shown,
)

GAIN = "lanes.RBFNN-NFTSM.nu"
LOOK = """lines => lines.map(line => [
  Number(getComputedStyle(line.closest('.trace')).opacity), getComputedStyle(line).strokeDasharray,
  parseFloat(getComputedStyle(line).strokeWidth), getComputedStyle(line).stroke,
])"""


def present(page: Page) -> list[str]:
    """Return the present curves of the first lane, panel by panel."""
    return paths(page.locator(".response .trace[class*=traceactual][class$='-0'] path.js-line"))


def before(page: Page) -> list[str]:
    return paths(lines_before(page))


def until(page: Page, done: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60.0
    while not done():
        assert time.monotonic() < deadline, "the curves are others"
        page.wait_for_timeout(50)


def test_the_response_before_the_last_change_stays_as_a_faint_curve(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    first = present(page)
    assert before(page) == []
    page.locator(".response-status").evaluate(KEEP_SHOWN)
    with held(page, GAIN):
        until_shown(page, "false")
        expect(lines_before(page)).to_have_count(3)
    until_estimated(page, dashboard)
    # One drag of many patches; only the lane that it is about. Its axes hold still.
    until(page, lambda: before(page) == first)
    faint, solid = (lines(page).evaluate_all(LOOK) for lines in (lines_before, lines_shown))
    for opacity, dash, width, color in faint:
        assert 0.1 < opacity < 0.5
        assert dash == "none"
        assert all(width > 1.5 * each[2] for each in solid)
        assert color in [each[3] for each in solid]

    second = present(page)
    assert second != first
    page.keyboard.press("Control+z")
    until(page, lambda: (before(page), present(page)) == (second, first))
    page.keyboard.press("Control+Shift+Z")
    until(page, lambda: (before(page), present(page)) == (first, second))
    for tab, panels in (("Torque", 3), ("Surface", 3), ("Flange error", 1), ("Error", 3)):
        page.locator(".response").get_by_role("tab", name=tab, exact=True).click()
        expect(lines_before(page)).to_have_count(panels)
    dashboard.client.patch("/api/experiment", json={"trajectory": {"amplitude": 0.9}})
    expect(lines_before(page)).to_have_count(3 * len(LANES))

    switch = page.locator(".response").get_by_role("button", name="before the last change")
    switch.click()
    expect(lines_before(page)).to_have_count(0)
    page.reload()
    until_estimated(page, dashboard)
    expect(switch).to_have_attribute("aria-pressed", "false")
    type_in(page, GAIN, "1")
    until_estimated(page, dashboard)
    expect(lines_before(page)).to_have_count(0)
    switch.click()
    expect(lines_before(page)).to_have_count(3)


def test_what_was_before_a_change_that_nobody_saw_is_computed(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    page.locator("[data-view=live]").click()
    for value in ("1", "2"):
        type_in(page, GAIN, value)
        expect(page.locator(f"[data-path='{GAIN}'].is-changed")).to_have_count(1)
    page.locator("[data-view=response]").click()
    until_estimated(page, dashboard)
    expect(lines_before(page)).to_have_count(3)
    faint = before(page)
    page.keyboard.press("Control+z")
    until_estimated(page, dashboard)
    until(page, lambda: present(page) == faint)
