"""The whole response says how good its numbers are, and mends them."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.response.test_response import (
    AGREEMENT,
    KEEP_SHOWN,
    LANES,
    MILLI,
    held,
    open_response,
    row,
    simulated,
    stage_box,
    until_estimated,
    until_shown,
)


def test_a_response_says_how_good_it_is_and_a_button_makes_it_better(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    estimate = row(page, "NFTSM").locator(".metrics-estimate")
    error = simulated(dashboard).lanes["NFTSM"].accuracy.error_estimate
    assert error is not None
    shown = estimate.inner_text()
    assert shown.startswith("±")
    assert float(shown[1:].replace("−", "-")) == pytest.approx(error * MILLI, rel=AGREEMENT)
    remarks = page.locator(".response-remarks li")
    expect(remarks).to_have_count(0)

    coarse = {"step": 0.005, "scheme": "plain", "horizon": 2.0}
    dashboard.client.patch("/api/experiment", json={"simulation": coarse})
    until_estimated(page, dashboard)
    said = {name: lane.accuracy for name, lane in simulated(dashboard).lanes.items()}
    error = said["NFTSM"].error_estimate
    assert error is not None
    assert error > 1e-3
    expect(estimate).to_have_text(re.compile(rf"±{int(error * MILLI)}\.\d+ ⚠"))
    expect(estimate).to_have_class(re.compile("is-doubtful"))
    expect(remarks).to_have_count(len(LANES))
    expect(remarks.first).to_contain_text("RBFNN-NFTSM")
    expect(remarks.first).to_contain_text(said["RBFNN-NFTSM"].remark)
    patch = said["RBFNN-NFTSM"].patch
    assert patch is not None
    step = f"Set h = {patch['simulation']['step']:g}"
    remarks.first.get_by_role("button", name=re.compile(re.escape(step))).click()
    until_estimated(page, dashboard)
    expect(remarks).to_have_count(0)
    expect(estimate).not_to_have_class(re.compile("is-doubtful"))
    error = simulated(dashboard).lanes["NFTSM"].accuracy.error_estimate
    assert error is not None
    assert error < 1e-3


def test_only_the_dragged_lane_waits_for_its_estimate(page: Page, dashboard: Dashboard) -> None:
    open_response(page, dashboard)
    dragged, other = (
        row(page, lane).locator(".metrics-estimate") for lane in ("RBFNN-NFTSM", "NFTSM")
    )
    known = other.inner_text()
    dragged.evaluate(KEEP_SHOWN)
    with held(page, "lanes.RBFNN-NFTSM.c"):
        until_shown(page, "…")
        expect(other).to_have_text(known)
    until_estimated(page, dashboard)
    expect(dragged).to_have_text(re.compile("±"))


def test_a_remark_of_before_the_drag_is_grey_and_offers_nothing(
    page: Page, dashboard: Dashboard
) -> None:
    coarse = {"step": 0.005, "scheme": "plain", "horizon": 2.0}
    dashboard.client.patch("/api/experiment", json={"simulation": coarse})
    open_response(page, dashboard)
    remarks = page.locator(".response-remarks")
    mine = remarks.locator("li").filter(has_text=re.compile("^RBFNN-NFTSM"))
    offer = mine.get_by_role("button")
    expect(offer).to_be_enabled()
    height = remarks.evaluate("node => node.offsetHeight")
    page.locator(".response-status").evaluate(KEEP_SHOWN)
    with held(page, "lanes.RBFNN-NFTSM.c"):
        until_shown(page, "false")
        expect(mine).to_have_class(re.compile("is-due"))
        expect(offer).to_be_disabled()
        expect(remarks.locator("li").last).not_to_have_class(re.compile("is-due"))
        assert remarks.evaluate("node => node.offsetHeight") == height
    until_estimated(page, dashboard)
    expect(remarks.locator(".is-due")).to_have_count(0)


def bottom(part: Locator) -> float:
    box = part.bounding_box()
    assert box is not None
    return box["y"] + box["height"]


@pytest.mark.parametrize("size", [(1440, 900), (390, 844)])
def test_long_remarks_fold_and_leave_the_time_axis_and_the_toolbar_in_sight(
    page: Page, dashboard: Dashboard, size: tuple[int, int]
) -> None:
    dashboard.client.patch(
        "/api/experiment", json={"simulation": {"mode": "sampled", "control_rate": 250}}
    )
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.goto(dashboard.url)
    if size[0] < 900:
        page.get_by_role("tab", name="Plots").click()
    page.locator("[data-view=response]").click()
    remarks = page.locator(".response-remarks")
    expect(remarks.locator(".is-frozen")).to_have_count(len(LANES), timeout=60_000)
    table = page.locator(".response > .scroll-frame")
    axis = page.locator(".response .xtitle")
    expect(axis).to_be_attached()
    pin = page.get_by_role("button", name="Pin as baseline")
    expect(pin).to_be_enabled()
    top = table.bounding_box()
    assert top is not None
    assert bottom(axis) < bottom(pin) <= top["y"] + 1.0
    folded = stage_box(page)
    page.get_by_role("button", name="more", exact=True).click()
    assert stage_box(page) == folded
    last = remarks.locator(".response-remark").last
    assert last.evaluate("node => node.scrollHeight <= node.clientHeight + 1")
    page.get_by_role("button", name="less", exact=True).click()
    expect(page.get_by_role("button", name="more", exact=True)).to_be_visible()
