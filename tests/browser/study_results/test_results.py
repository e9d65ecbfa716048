"""What studies show in the page is what the server has: bands, the worst found, sweeps."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.study.outcome import outcome
from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import card, experiment, fact
from tests.browser.studies.test_studies import (
    GOALS,
    LANE,
    RANGES,
    SHORT,
    begun,
    ended,
    entries,
    open_kept,
    prepare,
)

HARD = {
    "goals": {
        "near": {
            "kind": "response",
            "channel": "e",
            "start": 0.1,
            "bound": 0.05,
            "priority": "hard",
        }
    }
}
DEADLINE = 60.0


def drawn(place: Locator, panel: str, uid: str) -> dict[str, Any]:
    """Return a trace of a picture, once it is drawn."""
    graph = place.locator(f'[data-panel="{panel}"] .lens-graph')
    expect(graph.locator(".main-svg").first).to_be_attached()
    found: dict[str, Any] = graph.evaluate(
        "(graph, uid) => { const one = graph.data.find((each) => each.uid === uid);"
        " return one && {x: [...one.x ?? []], y: [...one.y ?? []],"
        " z: (one.z ?? []).map((row) => [...row]), fill: one.fill ?? '', line: one.line ?? {}}; }",
        uid,
    )
    return found


def until(dashboard: Dashboard, document: dict[str, Any]) -> None:
    end = time.monotonic() + DEADLINE
    while (now := experiment(dashboard)) != document:
        assert time.monotonic() < end, now
        time.sleep(0.05)


def until_marked(page: Page, value: float) -> None:
    """Wait until the curve of the mean error marks this value as the present one."""
    page.wait_for_function(
        """(value) => {
          const graph = document.querySelector('[data-panel="mae"] .lens-graph');
          const now = graph.data.find(({uid}) => uid === 'now');
          return now && Math.abs(now.x[0] - value) < 1e-6;
        }""",
        arg=value,
    )


def click_point(page: Page, dashboard: Dashboard, view: Locator, words: str) -> None:
    """Point at the fourth point of a curve and click it once it says what it is."""
    before, end = experiment(dashboard), time.monotonic() + DEADLINE
    point = view.locator('[data-panel="mae"] .scatterlayer .point').nth(3)
    while experiment(dashboard) == before:
        assert time.monotonic() < end, "no click goes where the point says"
        point.scroll_into_view_if_needed()
        place = point.bounding_box()
        assert place is not None
        middle = place["x"] + place["width"] / 2, place["y"] + place["height"] / 2
        # A redraw of the plot takes the words away: who misses then aims once more.
        page.mouse.move(middle[0] + 1.0, middle[1])
        page.mouse.move(*middle)
        page.wait_for_timeout(100)
        if words in (view.locator('[data-panel="mae"] .hoverlayer').text_content() or ""):
            page.mouse.click(*middle)
            page.wait_for_timeout(500)


def test_bands_are_those_of_the_draws_with_the_goals_as_lines(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, SHORT, HARD, RANGES)
    number = begun(dashboard, "robustness", draws=12)
    found = ended(dashboard, number)
    view = open_kept(page, dashboard, number)
    bands = dashboard.client.get(f"/api/studies/{number}/bands").json()
    expect(view.locator(".study-bands > *")).to_have_count(6)
    median = drawn(view, "e2", "median")
    assert median["x"] == pytest.approx(bands["time"])
    assert median["y"] == pytest.approx(bands["curves"]["e2"]["median"])
    band = drawn(view, "e2", "band")
    assert band["fill"] == "toself"
    assert np.max(band["y"][:-1]) == pytest.approx(np.max(bands["curves"]["e2"]["high"]))
    assert np.min(band["y"][:-1]) == pytest.approx(np.min(bands["curves"]["e2"]["low"]))
    bound = drawn(view, "e2", "bound near -1")
    assert bound["x"] == pytest.approx([0.1, 0.3])
    assert bound["y"] == pytest.approx([-0.05, -0.05])
    view.get_by_role("button", name="Flange error").click()
    expect(view.locator(".study-bands > *")).to_have_count(1)
    flange = drawn(view, "flange-error", "high")
    assert flange["y"] == pytest.approx([1e3 * v for v in bands["curves"]["flange_error"]["high"]])
    kept = fact(page, "How many held", "kept the hard goals")
    expect(kept).to_have_text(f"{100 * found['result']['kept']:.0f} %")
    row = card(page, "Figures and goals").get_by_role("row").filter(has_text="error |e|")
    ratios = found["result"]["quantiles"]["ratios"]["near"]
    for place, name in enumerate(("p5", "median", "p95", "worst")):
        cell = row.get_by_role("cell").nth(place)
        assert float(cell.inner_text()) == pytest.approx(ratios[name], rel=0.01)
        expect(cell).to_have_class("is-kept" if ratios[name] <= 1 else "is-missed")


def test_draws_that_left_their_bounds_are_counted_and_their_bands_end(
    page: Page, dashboard: Dashboard
) -> None:
    lane = "RBFNN-SMC"
    patch = {
        "simulation": {"horizon": 0.1, "mode": "sampled"},
        "lanes": {lane: {"k1": 1.0, "k2": 4.0}},
        "uncertainty": {"input_delay": [0.0, 0.05]},
    }
    prepare(dashboard, patch)
    number = begun(dashboard, "robustness", lane=lane, draws=12)
    ended(dashboard, number)
    times = [entry["outcome"]["diverged_at"] for entry in entries(dashboard, number)]
    gone = [time for time in times if time is not None]
    assert gone
    view = open_kept(page, dashboard, number)
    told = card(page, "Within what the responses lie").locator(".lens-finding")
    expect(told).to_contain_text(f"{len(gone)} of 12 draws left their bounds")
    curves = dashboard.client.get(f"/api/studies/{number}/bands").json()["curves"]["e1"]
    assert None in curves["high"]
    greatest = drawn(view, "e1", "greatest")
    assert greatest["y"] == pytest.approx(curves["greatest"])
    band = drawn(view, "e1", "band")
    assert 0.0 < max(x for x in band["x"] if x is not None) <= sorted(gone)[1]


def test_the_worst_found_is_never_guaranteed_and_runs_here(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, SHORT, HARD, RANGES)
    number = begun(dashboard, "worst", trials=10)
    found = ended(dashboard, number)["result"]["worst_found"]
    view = open_kept(page, dashboard, number)
    expect(view.get_by_text("Worst found, not guaranteed")).to_be_visible()
    payload = view.get_by_role("list", name="Values of the worst found").get_by_role("listitem")
    expect(payload).to_contain_text("of 0 kg to 3 kg")
    shown = payload.locator(".study-range-value").inner_text().removesuffix(" kg")
    assert float(shown) == pytest.approx(found["values"]["payload"], rel=1e-3)
    before = experiment(dashboard)
    nominal = outcome(Experiment.from_document(before), LANE)
    row = card(page, "Beside the nominal").get_by_role("row").filter(has_text="error |e|")
    cells = row.get_by_role("cell")
    expect(cells.first).not_to_have_text("…")
    assert float(cells.nth(0).inner_text()) == pytest.approx(nominal.ratios["near"], rel=0.01)
    ratio = found["outcome"]["ratios"]["near"]
    assert float(cells.nth(1).inner_text()) == pytest.approx(ratio, rel=0.01)
    view.get_by_role("button", name="Run it here").click()
    address = f"/api/studies/{number}/entries/{found['index']}/experiment"
    until(dashboard, dashboard.client.get(address).json())
    again = outcome(Experiment.from_document(experiment(dashboard)), LANE)
    assert again.document() == found["outcome"]
    page.locator(".notice").get_by_role("button", name="Undo").click()
    until(dashboard, before)


def test_a_sweep_of_one_field_is_curves_and_a_click_goes_there(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, SHORT, GOALS)
    axis = {"field": "nu", "low": 1.0, "high": 16.0, "count": 5, "logarithmic": True}
    number = begun(dashboard, "sweep", axes=[axis])
    ended(dashboard, number)
    points = entries(dashboard, number)
    view = open_kept(page, dashboard, number)
    curve = drawn(view, "mae", "curve")
    assert curve["x"] == pytest.approx([1, 2, 4, 8, 16])
    errors = [1e3 * point["outcome"]["figures"]["mae"] for point in points]
    assert curve["y"] == pytest.approx(errors)
    score = drawn(view, "score", "curve")
    assert score["y"] == pytest.approx([point["outcome"]["score"] for point in points])
    before = experiment(dashboard)
    # The present value lies below the range: a line marks it from the click on.
    assert before["lanes"][LANE]["nu"] < 1.0
    assert drawn(view, "mae", "now") is None
    click_point(page, dashboard, view, "ν = 8 ")
    address = f"/api/studies/{number}/entries/3/experiment"
    until(dashboard, dashboard.client.get(address).json())
    until_marked(page, 8.0)
    page.locator(".notice").get_by_role("button", name="Undo").click()
    until(dashboard, before)
    view.locator(".study-chosen select").select_option(label="2")
    expect(view.locator(".study-numbers")).to_contain_text("mrad")
    view.get_by_role("button", name="Go there").press("Enter")
    address = f"/api/studies/{number}/entries/1/experiment"
    until(dashboard, dashboard.client.get(address).json())


def test_a_sweep_of_two_fields_is_a_map_in_their_order(page: Page, dashboard: Dashboard) -> None:
    prepare(dashboard, SHORT)
    axes = [
        {"field": "nu", "low": 1.0, "high": 9.0, "count": 3},
        {"field": "robot.payload.mass", "low": 0.0, "high": 1.0, "count": 2},
    ]
    number = begun(dashboard, "sweep", axes=axes)
    ended(dashboard, number)
    points = entries(dashboard, number)
    view = open_kept(page, dashboard, number)
    view.get_by_label("Figure").select_option("chattering")
    cells = np.array(drawn(view, "chattering", "map")["z"], dtype=float)
    assert cells.shape == (2, 3)
    for point in points:
        column, row = axes[0], axes[1]
        at = [
            (value - one["low"]) / (one["high"] - one["low"]) * (one["count"] - 1)
            for value, one in zip(point["values"], (column, row), strict=True)
        ]
        expected = point["outcome"]["figures"]["chattering"]
        assert cells[round(at[1]), round(at[0])] == pytest.approx(expected)
    lists = view.locator(".study-chosen select")
    lists.nth(0).select_option(label="9")
    lists.nth(1).select_option(label="1")
    view.get_by_role("button", name="Go there").click()
    until_values(dashboard, 9.0, 1.0)


def until_values(dashboard: Dashboard, nu: float, mass: float) -> None:
    end = time.monotonic() + DEADLINE
    while True:
        now = experiment(dashboard)
        found = (now["lanes"][LANE]["nu"], now["robot"]["payload"]["mass"])
        if found == (nu, mass):
            return
        assert time.monotonic() < end, found
        time.sleep(0.05)
