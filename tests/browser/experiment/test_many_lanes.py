"""With six lanes the plots stay readable, and their table says that it goes on beyond its box."""

from __future__ import annotations

import re
import time

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.response.test_response import open_response

LEAST_PANEL = 110.0
EXTRA = {f"Extra {number}": {"law": "smc"} for number in range(3)}
HEIGHTS = """() => [...document.querySelectorAll('.response .ylines-above')].map((line) => {
  const [, top, bottom] = /,([\\d.]+)V([\\d.]+)/.exec(line.getAttribute('d'));
  return bottom - top;
})"""
CORNERS = """box => [...box.querySelectorAll('thead th:first-child, tbody:last-child th')]
  .map((cell) => cell.getBoundingClientRect())
  .map(({left, top}) => [left, top].map(Math.round))"""


def until_readable(page: Page) -> None:
    deadline = time.monotonic() + 60.0
    while not (len(found := page.evaluate(HEIGHTS)) == 3 and min(found) >= LEAST_PANEL - 1):
        assert time.monotonic() < deadline, found
        page.wait_for_timeout(50)


def test_plots_of_six_lanes_stay_readable_and_their_table_in_sight(
    page: Page, dashboard: Dashboard
) -> None:
    patch = {"lanes": EXTRA, "simulation": {"horizon": 1.0}}
    dashboard.client.patch("/api/experiment", json=patch).raise_for_status()
    open_response(page, dashboard)
    table, panel = page.locator(".response-figures"), page.locator("#plots")
    frame = page.locator(".response .scroll-frame")
    for width, height in ((1440, 900), (1024, 700)):
        page.set_viewport_size({"width": width, "height": height})
        until_readable(page)
        expect(table).to_be_in_viewport(ratio=1)
        place, around = table.bounding_box(), panel.bounding_box()
        assert place is not None
        assert around is not None
        assert 75 < place["height"] < 0.45 * around["height"]
        assert place["y"] + place["height"] <= around["y"] + around["height"] + 1
        expect(frame).to_have_class(re.compile("goes-down"))

    expect(frame).to_have_class(re.compile("goes-right"))
    head, last = table.evaluate(CORNERS)
    table.evaluate("box => box.scrollTo(box.scrollWidth, box.scrollHeight)")
    expect(frame).not_to_have_class(re.compile("goes-"))
    # Whose the figures are and what they are stays in sight.
    assert table.evaluate(CORNERS)[0] == head
    assert table.evaluate(CORNERS)[1][0] == last[0]
    expect(page.locator(".response-lane").last).to_be_in_viewport(ratio=1)
