"""Lists that open at a button: presets, and what can be done with a lane."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard

CHOOSE = """(item) => {
  const undo = () => new KeyboardEvent(
    'keydown', {key: 'z', ctrlKey: true, bubbles: true, cancelable: true});
  const taken = () => !item.dispatchEvent(undo());
  const open = taken();
  item.click();
  return [open, taken()];
}"""
"""Press Ctrl Z on an item, choose it, press again before the page is drawn; was either an undo?"""


@pytest.mark.parametrize(
    ("opener", "item"),
    [(".preset-button", "A realistic arm"), (".lane [aria-haspopup=menu]", "Duplicate")],
)
def test_a_key_after_a_choice_is_the_page_s_and_no_longer_the_list_s(
    page: Page, dashboard: Dashboard, opener: str, item: str
) -> None:
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    page.locator(opener).first.click()
    chosen = page.locator("[popover]:popover-open .menu-item", has_text=item)
    assert chosen.evaluate(CHOOSE) == [False, True]
