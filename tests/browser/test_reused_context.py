"""A page that tests use one after another keeps nothing of the one before."""

from __future__ import annotations

from playwright.sync_api import Page

from tests.browser.conftest import Dashboard
from tests.browser.reused_context import EMPTY, ReusedContext

STATE = """() => ({
  cookies: document.cookie,
  stored: localStorage.length,
  width: innerWidth,
  dark: matchMedia('(prefers-color-scheme: dark)').matches,
  still: matchMedia('(prefers-reduced-motion: reduce)').matches,
})"""
SET = """() => { document.cookie = 'a=1'; localStorage.setItem('theme', 'dark'); }"""


def test_what_a_test_stored_routed_and_set_is_gone_for_the_next_one(
    page: Page, dashboard: Dashboard, reused: ReusedContext
) -> None:
    address = f"{dashboard.url}docs"
    page.goto(address)
    before = page.evaluate(STATE)
    page.evaluate(SET)
    page.set_viewport_size({"width": 390, "height": 844})
    page.emulate_media(color_scheme="dark", reduced_motion="reduce")
    page.route("**/docs", lambda route: route.fulfill(body="routed"))
    page.context.route("**/docs", lambda route: route.fulfill(body="routed"))
    page.context.new_page()
    page.goto(address)
    assert "routed" in page.content()
    changed = page.evaluate(STATE)
    assert all(changed[key] != before[key] for key in before)

    reused.clean()
    assert page.context.pages == [page]
    assert page.url == EMPTY
    page.goto(address)
    assert page.evaluate(STATE) == before
    assert "routed" not in page.content()
