"""A and B: the live lane with one set of gains or the other, accepted as one edit or taken back."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import patch
from tests.browser.study_search.searches import GOALS, HARD, LANE, mounted, searched
from tests.browser.study_search.test_search_result import (
    choose,
    gains_of,
    lane,
    part,
    undo_label,
    until_gains,
    until_label,
)

NUMBER = 5
PRESENT = {"nu": 0.3, "c": 10.0}


@pytest.fixture
def study(page: Page, dashboard: Dashboard) -> dict[str, Any]:
    """A search whose trial 5 is chosen on the page."""
    found = searched(dashboard, {**GOALS, **HARD}, trials=8)
    mounted(page, dashboard, found)
    choose(page, NUMBER)
    return found


def side(page: Page, name: str) -> Locator:
    return part(page).get_by_role("radio", name=re.compile(f"^{name} "))


def test_the_switch_changes_gains_by_keys_and_leaves_nothing_to_undo(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    before = {key: lane(dashboard)[key] for key in PRESENT}
    epoch = page.evaluate("harness.api.session.epoch")
    side(page, "A").focus()
    for _ in range(2):
        page.keyboard.press("ArrowRight")
        until_gains(dashboard, gains_of(study, NUMBER))
        expect(side(page, "B")).to_be_enabled()
        expect(side(page, "B")).to_be_checked()
        side(page, "B").focus()
        page.keyboard.press("ArrowLeft")
        until_gains(dashboard, before)
        expect(side(page, "A")).to_be_enabled()
        side(page, "A").focus()
    assert undo_label(page) is None
    # Time and states went on.
    assert page.evaluate("harness.api.session.epoch") == epoch


def test_reject_takes_the_gains_back(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    before = {key: lane(dashboard)[key] for key in PRESENT}
    side(page, "B").check(force=True)
    until_gains(dashboard, gains_of(study, NUMBER))
    part(page).get_by_role("button", name="Reject").click()
    until_gains(dashboard, before)
    assert undo_label(page) is None
    best = study["result"]["best"]["number"]
    expect(part(page).locator(".search-title")).to_have_text(f"Trial {best}")


def test_accept_is_one_edit_that_undo_takes_back(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    before = {key: lane(dashboard)[key] for key in PRESENT}
    side(page, "B").check(force=True)
    until_gains(dashboard, gains_of(study, NUMBER))
    part(page).get_by_role("button", name="Accept").click()
    expect(page.locator(".notice").filter(has_text="strong")).to_contain_text(
        f"{LANE} has the gains of trial {NUMBER}. For 10 s"
    )
    until_gains(dashboard, gains_of(study, NUMBER))
    until_label(page, f"accepted gains of {LANE}")
    expect(part(page).get_by_role("button", name="Accept")).to_be_disabled()
    page.evaluate("harness.history.undo()")
    until_gains(dashboard, before)
    assert undo_label(page) is None


def test_gains_that_leave_a_hard_goal_go_back_by_themselves(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    impossible = {"kind": "response", "channel": "e", "bound": 1e-9, "priority": "hard"}
    patch(dashboard, {"goals": {"exact": impossible}})
    before = {key: lane(dashboard)[key] for key in PRESENT}
    part(page).get_by_role("button", name="Accept").click()
    notice = page.locator(".notice").filter(has_text="went back to its former gains")
    expect(notice.first).to_contain_text(LANE)
    until_gains(dashboard, before)


def test_an_edit_of_something_else_ends_the_comparison(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    side(page, "B").check(force=True)
    until_gains(dashboard, gains_of(study, NUMBER))
    patch(dashboard, {"lanes": {LANE: {"nu": 7.5}}})
    expect(part(page).locator(".search-actions .search-note")).to_contain_text(
        "the comparison has ended"
    )
    expect(side(page, "A")).to_be_checked()
    assert lane(dashboard)["nu"] == 7.5
