"""One number, list, fraction or choice at a time: what an edit sends, shows and takes back."""

from __future__ import annotations

import time
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard

PROPOSED = "RBFNN-NFTSM"


@pytest.fixture
def screen(dashboard: Dashboard, page: Page) -> Page:
    """The dashboard at rest, without the 3D scene."""
    dashboard.client.post("/api/session/pause").raise_for_status()
    return opened(page, dashboard)


def opened(page: Page, dashboard: Dashboard) -> Page:
    page.route("**/scene/**", lambda route: route.fulfill(body="<p>", content_type="text/html"))
    page.goto(dashboard.url)
    expect(page.locator(".gains-head h2")).to_be_visible()
    return page


def control(page: Page, path: str) -> Locator:
    return page.locator(f'.control[data-path="{path}"]')


def box(page: Page, path: str) -> Locator:
    return control(page, path).locator(".control-input > .number-box")


def gain(dashboard: Dashboard, lane: str, name: str) -> Any:
    document = dashboard.client.get("/api/experiment").json()["experiment"]
    return document["lanes"][lane][name]


def until_gains(dashboard: Dashboard, lane: str, **wanted: Any) -> None:
    end = time.monotonic() + 15.0
    while (now := {name: gain(dashboard, lane, name) for name in wanted}) != wanted:
        assert time.monotonic() < end, f"{lane} stayed {now}"
        time.sleep(0.05)


def revision(dashboard: Dashboard) -> int:
    return int(dashboard.client.get("/api/experiment").json()["revision"])


def test_undo_in_a_number_box_takes_back_what_the_server_took(
    screen: Page, dashboard: Dashboard
) -> None:
    nu = box(screen, f"lanes.{PROPOSED}.nu")
    nu.focus()
    screen.keyboard.type("3")
    screen.keyboard.press("Enter")
    until_gains(dashboard, PROPOSED, nu=3.0)
    screen.keyboard.press("Control+z")
    until_gains(dashboard, PROPOSED, nu=0.3)
    expect(nu).to_have_value("0.3")
    screen.keyboard.press("Control+Shift+z")
    until_gains(dashboard, PROPOSED, nu=3.0)
    expect(nu).to_have_value("3")
    screen.keyboard.press("Tab")
    before = revision(dashboard)
    c = box(screen, f"lanes.{PROPOSED}.c")
    c.fill("7")
    c.press("Enter")
    until_gains(dashboard, PROPOSED, nu=3.0, c=7.0)
    assert revision(dashboard) == before + 1


def test_undo_while_typing_takes_back_only_what_is_typed(
    screen: Page, dashboard: Dashboard
) -> None:
    nu = box(screen, f"lanes.{PROPOSED}.nu")
    nu.focus()
    screen.keyboard.type("3")
    screen.keyboard.press("Enter")
    until_gains(dashboard, PROPOSED, nu=3.0)
    screen.keyboard.press("Control+a")
    screen.keyboard.type("45")
    screen.keyboard.press("Control+z")
    expect(nu).to_have_value("3")
    # The way of the browser's own menu.
    nu.evaluate("node => document.execCommand('undo')")
    expect(nu).to_have_value("3")
    screen.keyboard.press("Tab")
    c = box(screen, f"lanes.{PROPOSED}.c")
    c.fill("7")
    c.press("Enter")
    until_gains(dashboard, PROPOSED, nu=3.0, c=7.0)
