"""The whole response says how good its numbers are, and mends them."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

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
