"""When the page asks for a response, and what it shows until that is there."""

from __future__ import annotations

import itertools
import math
import re
import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, Route, expect

from tests.browser.conftest import Complaints, Dashboard, StartDashboard, stop
from tests.browser.response.test_response import (
    AGREEMENT,
    KEEP_SHOWN,
    LANES,
    expected_figures,
    figures,
    held,
    lines_before,
    open_response,
    revision,
    row,
    simulated,
    slider,
    until_estimated,
)

RUNS_BEFORE = 3
"""So many end during a drag, before the last one."""
MANY = 25
"""So many responses are a drag."""
COUNT_FIGURES = """() => {
  const {react} = Plotly;
  window.figures = 0;
  Plotly.react = (graph, ...more) => {
    if (graph.closest('.response')) window.figures += 1;
    return react(graph, ...more);
  };
}"""
REST_MS = 800
"""A hand that rests on a slider for so long gets the estimate."""


def test_a_hand_that_lets_go_before_its_run_ends_asks_for_one_estimate(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    asked: list[bool] = []
    waiting: list[Route] = []

    def take(route: Route) -> None:
        asked.append(route.request.post_data_json["estimate"])
        if asked.count(False) > RUNS_BEFORE and not waiting:
            waiting.append(route)
        else:
            route.continue_()

    page.route("**/api/preview", take)
    track = slider(page, "lanes.RBFNN-NFTSM.c").bounding_box()
    assert track is not None
    with held(page, "lanes.RBFNN-NFTSM.c"):
        deadline = time.monotonic() + 60.0
        for step in itertools.count():
            if waiting:
                break
            assert time.monotonic() < deadline, "too few runs"
            share = 0.4 + 0.1 * (step % 2)
            page.mouse.move(track["x"] + track["width"] * share, track["y"] + track["height"] / 2)
            page.wait_for_timeout(50)
    waiting[0].continue_()
    until_estimated(page, dashboard)
    before = len(asked)
    page.wait_for_timeout(REST_MS + 500)
    assert len(asked) == before


def move_to_and_fro(page: Page, gain: str, enough: Callable[[], bool]) -> None:
    """Move the slider that is held until there is enough."""
    track = slider(page, gain).bounding_box()
    assert track is not None
    deadline = time.monotonic() + 60.0
    for step in itertools.count():
        if enough():
            return
        assert time.monotonic() < deadline, "too few responses"
        share = 0.55 + 0.2 * math.sin(step / 8)
        page.mouse.move(track["x"] + track["width"] * share, track["y"] + track["height"] / 2)
        page.wait_for_timeout(15)


def test_a_drag_moves_its_curves_without_another_figure(page: Page, dashboard: Dashboard) -> None:
    open_response(page, dashboard)
    gain = "lanes.RBFNN-NFTSM.c"
    shown = page.locator(".response-status")
    shown.evaluate(KEEP_SHOWN)
    with held(page, gain):
        expect(lines_before(page)).to_have_count(3)
        page.evaluate(COUNT_FIGURES)
        before = page.evaluate("window.shown.length")
        move_to_and_fro(page, gain, lambda: page.evaluate("window.shown.length") > before + MANY)
        assert page.evaluate("window.figures") == 0
    until_estimated(page, dashboard)


def test_a_drag_shows_the_response_itself_and_its_release_adds_only_the_estimate(
    page: Page, dashboard: Dashboard
) -> None:
    # No other test has had the server estimate, and keep, what this one comes by.
    apart = {"simulation": {"initial_error": 0.0123}}
    dashboard.client.patch("/api/experiment", json=apart).raise_for_status()
    open_response(page, dashboard)
    estimates: list[Route] = []
    released: list[bool] = []

    def take(route: Route) -> None:
        if route.request.post_data_json["estimate"] and not released:
            estimates.append(route)
        else:
            route.continue_()

    status = page.locator(".response-status")
    estimate = row(page, "RBFNN-NFTSM").locator(".metrics-estimate")
    until_estimated(page, dashboard)
    page.route("**/api/preview", take)
    with held(page, "lanes.RBFNN-NFTSM.c"):
        expect(estimate).to_have_text("…")
        expect(estimate).to_have_attribute("title", "estimated on release")
        deadline = time.monotonic() + 60.0
        while status.get_attribute("data-response") != str(revision(dashboard)):
            assert time.monotonic() < deadline, "the response stays behind the hand"
            page.wait_for_timeout(50)
        expect(status).to_have_attribute("data-estimated", "false")
        expect(status).to_have_text(f"rev {revision(dashboard)}")
        run = simulated(dashboard)
        shown = {lane: figures(page, lane) for lane in LANES}
        for lane in LANES:
            assert shown[lane] == pytest.approx(expected_figures(run, lane), rel=AGREEMENT)
    released.append(True)
    for route in estimates:
        route.continue_()
    until_estimated(page, dashboard)
    expect(estimate).to_have_text(re.compile("±"))
    assert {lane: figures(page, lane) for lane in LANES} == shown


def test_a_response_that_stays_behind_is_seen_to_be_out_of_date(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    waiting: list[Route] = []
    released: list[bool] = []
    page.route(
        "**/api/preview", lambda route: route.continue_() if released else waiting.append(route)
    )
    before = revision(dashboard)
    dashboard.client.post("/api/presets/realistic/load").raise_for_status()
    response, status = page.locator(".response"), page.locator(".response-status")
    expect(response).to_have_class(re.compile("is-behind"))
    expect(page.locator(".response-table tbody").first).to_have_css("opacity", "0.4")
    expect(status).to_have_text(f"rev {before}, now {before + 1}")
    released.append(True)
    for route in waiting:
        route.continue_()
    until_estimated(page, dashboard)
    expect(response).not_to_have_class(re.compile("is-behind"))


@pytest.mark.fresh
def test_a_response_of_a_server_that_was_there_before_is_not_taken_for_the_present_one(
    page: Page, start_dashboard: StartDashboard, complaints: Complaints
) -> None:
    complaints.allow("ERR_|WebSocket|closed before|connection")
    first = start_dashboard()
    open_response(page, first)
    page.locator("[data-view=live]").click()
    port = stop(first)
    second = start_dashboard("--port", port, "--preset", "paper-undisturbed")
    expect(page.locator(".preset-button")).to_contain_text("paper-undisturbed", timeout=60_000)
    # Both began at the same revision.
    assert revision(second) == 1
    page.locator("[data-view=response]").click()
    expect(page.locator(".response-table tbody tr")).to_have_count(len(LANES))
    until_estimated(page, second)
    run = simulated(second)
    for lane in LANES:
        assert figures(page, lane) == pytest.approx(expected_figures(run, lane), rel=AGREEMENT)
