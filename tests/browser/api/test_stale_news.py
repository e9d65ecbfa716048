"""News that comes late, and a server that is busy: the page keeps what is newer and tries again."""

from __future__ import annotations

import json
import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, Route, WebSocketRoute, expect

from tests.browser.conftest import Complaints, Dashboard
from tests.browser.response.test_response import open_response, type_in, until_estimated

# What listens to a WebSocket stays with its page.
pytestmark = pytest.mark.fresh

GAIN = "lanes.RBFNN-NFTSM.nu"


def until(page: Page, done: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60.0
    while not done():
        assert time.monotonic() < deadline, "the server says no more"
        page.wait_for_timeout(50)


def test_a_patch_that_comes_late_takes_nothing_back(page: Page, dashboard: Dashboard) -> None:
    patches: list[str] = []
    states: list[str] = []
    news = {"patch": patches, "state": states}
    routes: list[WebSocketRoute] = []

    def listen(route: WebSocketRoute) -> None:
        server = route.connect_to_server()
        routes.append(route)

        def pass_on(message: str | bytes) -> None:
            kind = json.loads(message)["type"] if isinstance(message, str) else ""
            if isinstance(message, str) and kind in news:
                news[kind].append(message)
            route.send(message)

        server.on_message(pass_on)

    page.route_web_socket("**/api/live", listen)
    page.goto(dashboard.url)
    box = page.locator(f"[data-path='{GAIN}'] .number-box").first
    for count, value in enumerate(("1", "2"), start=1):
        type_in(page, GAIN, value)
        until(page, lambda count=count: len(patches) == count)
    box.blur()
    routes[-1].send(patches[0])
    # Messages keep their order: what the server says next is heard after it.
    heard = len(states)
    until(page, lambda: len(states) >= heard + 2)
    page.evaluate("new Promise(requestAnimationFrame)")
    expect(box).to_have_value("2")


def test_a_busy_server_is_told_and_asked_again(
    page: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("503")
    open_response(page, dashboard)
    text = "256 tasks are waiting already: try again in a moment"
    refused: list[str] = []

    def refuse(route: Route) -> None:
        if refused:
            route.continue_()
            return
        refused.append(route.request.url)
        error = {"error": {"code": "busy", "message": text, "fields": []}}
        route.fulfill(status=503, content_type="application/json", body=json.dumps(error))

    page.route("**/api/preview", refuse)
    type_in(page, GAIN, "3")
    expect(page.locator(".response")).to_contain_text(text)
    until_estimated(page, dashboard)
    expect(page.locator(".response")).not_to_contain_text(text)
