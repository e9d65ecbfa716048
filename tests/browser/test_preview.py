"""When the page asks for a response, and what it shows until that is there."""

from __future__ import annotations

import itertools
import re

from playwright.sync_api import Page, Route, expect

from tests.browser.conftest import Dashboard
from tests.browser.test_response import held, open_response, revision, slider, until_exact

QUICK_RUNS = 3
"""So many end during a drag, before the last one."""
REST_MS = 800
"""A hand that rests on a slider for so long gets the exact run."""


def test_a_hand_that_lets_go_before_its_quick_run_ends_gets_no_second_exact_run(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    asked: list[bool] = []
    waiting: list[Route] = []

    def take(route: Route) -> None:
        asked.append(route.request.post_data_json["quick"])
        if asked.count(True) > QUICK_RUNS and not waiting:
            waiting.append(route)
        else:
            route.continue_()

    page.route("**/api/preview", take)
    track = slider(page, "lanes.RBFNN-NFTSM.c").bounding_box()
    assert track is not None
    with held(page, "lanes.RBFNN-NFTSM.c"):
        for step in itertools.count():
            if waiting:
                break
            share = 0.4 + 0.1 * (step % 2)
            page.mouse.move(track["x"] + track["width"] * share, track["y"] + track["height"] / 2)
            page.wait_for_timeout(50)
    waiting[0].continue_()
    until_exact(page, dashboard)
    before = len(asked)
    page.wait_for_timeout(REST_MS + 500)
    assert len(asked) == before


def test_a_response_that_stays_behind_is_seen_to_be_out_of_date(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    waiting: list[Route] = []
    page.route("**/api/preview", lambda route: waiting.append(route))
    before = revision(dashboard)
    dashboard.client.post("/api/presets/realistic/load").raise_for_status()
    response, status = page.locator(".response"), page.locator(".response-status")
    expect(response).to_have_class(re.compile("is-behind"))
    expect(page.locator(".response-table tbody").first).to_have_css("opacity", "0.4")
    expect(status).to_have_text(f"rev {before}, now {before + 1} · exact run")
    for route in waiting:
        route.continue_()
    page.unroute("**/api/preview")
    until_exact(page, dashboard)
    expect(response).not_to_have_class(re.compile("is-behind"))
