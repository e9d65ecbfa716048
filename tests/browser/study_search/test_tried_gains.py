"""Gains that are tried as B outlast a reload of the page, with the way back to A."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.study_search.searches import GOALS, LANE, searched
from tests.browser.study_search.test_search_result import gains_of, lane, until_gains

PRESENT = {"nu": 0.3, "c": 10.0}


@pytest.fixture
def tried(page: Page, dashboard: Dashboard) -> dict[str, Any]:
    """A search of which the live lane has a trial that is not the best, as B."""
    study = searched(dashboard, GOALS, trials=8)
    best = study["result"]["best"]["number"]
    number = next(one for one in range(1, 8) if one != best)
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Studies").click()
    page.locator(".study-item").click()
    page.get_by_label("Trial", exact=True).fill(str(number))
    expect(page.locator(".search-title")).to_have_text(f"Trial {number}")
    page.get_by_text("B candidate").click()
    until_gains(dashboard, gains_of(study, number))
    expect(page.get_by_role("radio", name="B candidate")).to_be_enabled()
    return {**study, "number": number}


def notice(page: Page) -> Locator:
    return page.locator(".notice").filter(has_text="which were tried as B")


def test_a_comparison_goes_on_after_a_reload(
    page: Page, dashboard: Dashboard, tried: dict[str, Any]
) -> None:
    page.reload()
    expect(page.locator(".search-title")).to_have_text(f"Trial {tried['number']}")
    expect(page.get_by_role("radio", name="B candidate")).to_be_checked()
    expect(notice(page)).to_contain_text(f"{LANE} has the gains of trial {tried['number']}")
    until_gains(dashboard, gains_of(tried, tried["number"]))
    page.get_by_text("A present").click()
    until_gains(dashboard, PRESENT)
    expect(notice(page)).to_have_count(0)
    page.reload()
    expect(page.locator(".search-title")).not_to_be_empty()
    expect(notice(page)).to_have_count(0)


def test_the_way_back_is_offered_where_the_study_is_not_shown(
    page: Page, dashboard: Dashboard, tried: dict[str, Any]
) -> None:
    page.get_by_role("tab", name="Live", exact=True).click()
    page.reload()
    notice(page).get_by_role("button", name="Back to A").click()
    until_gains(dashboard, PRESENT)
    page.reload()
    expect(page.locator("#header")).to_contain_text("live")
    expect(notice(page)).to_have_count(0)


def test_what_was_accepted_is_not_tried_any_more(
    page: Page, dashboard: Dashboard, tried: dict[str, Any]
) -> None:
    page.get_by_role("button", name="Accept").click()
    expect(page.locator(".notice").filter(has_text="has the gains of trial")).to_be_visible()
    page.reload()
    expect(page.locator(".search-title")).not_to_be_empty()
    expect(notice(page)).to_have_count(0)
    assert {key: lane(dashboard)[key] for key in PRESENT} == gains_of(tried, tried["number"])
