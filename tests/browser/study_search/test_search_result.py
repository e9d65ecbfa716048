"""What a search has found: plots, the trial that is looked at, and what is done with it."""

from __future__ import annotations

import re
import time
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.inspector import Inspector
from tests.browser.lenses.test_lenses import experiment, patch
from tests.browser.study_search.searches import GOALS, HARD, LANE, mounted, searched

DEADLINE = 60.0
TRIALS = 32


@pytest.fixture
def study(dashboard: Dashboard) -> dict[str, Any]:
    """A search with two soft goals and a hard one; the live experiment is the one searched."""
    return searched(dashboard, {**GOALS, **HARD}, trials=TRIALS)


def part(page: Page) -> Locator:
    return page.locator(".harness")


def choose(page: Page, number: int) -> None:
    part(page).get_by_label("Trial", exact=True).fill(str(number))
    expect(part(page).locator(".search-words")).to_contain_text(f"Trial {number}:")


def lane(dashboard: Dashboard, name: str = LANE) -> dict[str, Any]:
    found: dict[str, Any] = experiment(dashboard)["lanes"].get(name, {})
    return found


def until_gains(dashboard: Dashboard, gains: dict[str, Any], name: str = LANE) -> None:
    end = time.monotonic() + DEADLINE
    while {key: lane(dashboard, name).get(key) for key in gains} != gains:
        assert time.monotonic() < end, lane(dashboard, name)
        time.sleep(0.05)


def gains_of(study: dict[str, Any], number: int) -> dict[str, Any]:
    made = study["entries"][number]["patch"]["lanes"][LANE]
    before = study["experiment"]["lanes"][LANE]
    return {key: made.get(key, before[key]) for key in ("nu", "c")}


def undo_label(page: Page) -> str | None:
    label: str | None = page.evaluate("harness.history.undoLabel ?? null")
    return label


def until_label(page: Page, label: str) -> None:
    """Wait until that is what undo would take back: the page hears of an edit after the server."""
    page.wait_for_function("label => harness.history.undoLabel === label", arg=label)


def rows(page: Page) -> list[list[str]]:
    table: list[list[str]] = page.evaluate(
        """() => [...document.querySelectorAll('.harness .search-table tbody tr')].map(
            (row) => [...row.cells].map((cell) => cell.innerText))"""
    )
    return [row for row in table if len(row) > 1]


def test_it_speaks_of_the_best_trial_and_the_table_compares_it(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    best = study["result"]["best"]
    expect(part(page).locator(".search-words")).to_contain_text(f"Trial {best['number']}: score")
    expect(part(page).locator(".search-words")).to_contain_text("the best so far")
    table = {row[0]: row[1:] for row in rows(page)}
    assert float(table["near, soft"][1]) == pytest.approx(
        best["outcome"]["ratios"]["near"], rel=0.01
    )
    present = study["entries"][0]["outcome"]
    assert float(table["near, soft"][0]) == pytest.approx(present["ratios"]["near"], rel=0.01)
    error = 1000 * best["outcome"]["figures"]["mae"]
    assert float(table["mean error [mrad]"][1]) == pytest.approx(error, rel=0.01)
    assert float(table["ν [1/s]"][1]) == pytest.approx(best["values"]["nu"], rel=1e-4)
    assert "met" not in table


def test_with_draws_the_table_says_how_they_fared(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"uncertainty": {"payload": [0, 2]}})
    study = searched(dashboard, {**GOALS, **HARD}, trials=8, draws=8)
    mounted(page, dashboard, study)
    best = study["result"]["best"]
    table = {row[0]: row[1:] for row in rows(page)}
    assert table["run"][1] == str(best["draws"]["draws"])
    assert table["kept the hard goals"][1] == f"{100 * best['draws']['kept']:.0f} %"
    expect(part(page).locator("caption")).to_contain_text("95 % of the draws")


def test_keys_move_from_trial_to_trial_and_each_response_is_shown(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    slider = part(page).get_by_label("Trial", exact=True)
    slider.focus()
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    expect(slider).to_have_attribute("aria-valuetext", f"{words(study, 2)}")
    expect(part(page).locator(".search-preview .search-note")).to_contain_text("Trial 2")
    expect(part(page).locator(".search-preview .lens-graph")).to_have_attribute(
        "aria-label", "|e| of the worst joint over the horizon: gains before and trial 2"
    )
    plot = "document.querySelector('.harness .search-preview .js-plotly-plot')"
    page.wait_for_function(f"{plot}?.data.length === 2")
    drawn = page.evaluate(
        f"""() => {plot}.data.map(
            ({{uid, x, y}}) => [uid, x[x.length - 1], Math.max(...y)])"""
    )
    assert [curve[0] for curve in drawn] == ["present", "trial"]
    figures = [study["entries"][number]["outcome"]["figures"] for number in (0, 2)]
    for (_, end, greatest), figure in zip(drawn, figures, strict=True):
        assert end == pytest.approx(2.0)
        assert greatest == pytest.approx(figure["max_error"], rel=0.05)


def words(study: dict[str, Any], number: int) -> str:
    outcome = study["entries"][number]["outcome"]
    score = f"{outcome['score']:#.3g}".rstrip(".")
    return f"Trial {number}: score {score}, " + (
        "hard goals kept" if outcome["kept"] else "a hard goal missed"
    )


def test_a_point_is_looked_at_under_the_pointer_and_chosen_with_a_click(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    number = 3
    script = """(number) => {
      const graph = document.querySelector('.harness .search-graph');
      const {xaxis} = graph._fullLayout;
      const box = graph.getBoundingClientRect();
      const {yaxis} = graph._fullLayout;
      const {score} = harness.entries[number].outcome;
      const up = yaxis.c2p(score);
      return [box.left + xaxis._offset + xaxis.c2p(number),
        box.top + yaxis._offset + Math.max(up, 0)];
    }"""
    page.wait_for_function("document.querySelector('.harness .search-graph')?._fullLayout")
    x, y = page.evaluate(script, number)
    page.mouse.move(x, y)
    expect(part(page).locator(".search-words")).to_have_text(f"{words(study, number)}.")
    expect(part(page).locator(".search-title")).not_to_have_text(f"Trial {number}")
    page.mouse.down()
    page.mouse.up()
    expect(part(page).locator(".search-title")).to_have_text(f"Trial {number}")
    page.mouse.move(5, 5)
    expect(part(page).locator(".search-words")).to_contain_text(f"Trial {number}:")
    part(page).get_by_role("button", name="Best so far").click()
    best = study["result"]["best"]["number"]
    expect(part(page).locator(".search-title")).to_have_text(f"Trial {best}")


def test_the_front_joins_the_trials_that_the_server_names(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    part(page).get_by_role("tab", name="Compromises").click()
    front = [study["entries"][number]["outcome"]["ratios"] for number in study["result"]["front"]]
    wanted = sorted((one["near"], one["quiet"]) for one in front)
    script = """() => document.querySelector('.harness .search-graph')?.data?.find(
        ({uid}) => uid === 'front')?.x.length"""
    end = time.monotonic() + DEADLINE
    while page.evaluate(script) != len(wanted):
        assert time.monotonic() < end
        time.sleep(0.05)
    line = page.evaluate(
        """() => { const {x, y} = document.querySelector('.harness .search-graph').data.find(
        ({uid}) => uid === 'front'); return x.map((value, at) => [value, y[at]]); }"""
    )
    assert [tuple(point) for point in line] == wanted
    part(page).get_by_label("Up", exact=True).select_option(label="mean error [mrad]")
    end = time.monotonic() + DEADLINE
    while page.evaluate(script) != 0:
        assert time.monotonic() < end
        time.sleep(0.05)


def test_brushes_leave_the_trials_that_pass_by_hand_and_by_keys(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    part(page).get_by_role("tab", name="Gains and score").click()
    strip = part(page).get_by_role("slider", name="Brush of ν")
    strip.focus()
    page.keyboard.press("ArrowUp")
    note = part(page).locator(".search-pictures .search-note[role=status]")
    low, high = min_max(study, "nu")
    top = low * (high / low) ** 0.25
    passing = sum(entry["values"]["nu"] <= top for entry in study["entries"])
    expect(note).to_contain_text(f"{passing} of {TRIALS} trials pass")
    part(page).get_by_role("button", name="Clear the brushes").click()
    expect(note).to_contain_text("Drag along an axis")
    box = strip.bounding_box()
    assert box is not None
    x = box["x"] + box["width"] / 2
    page.mouse.move(x, box["y"] + 0.5 * box["height"])
    page.mouse.down()
    page.mouse.move(x, box["y"] + box["height"] + 20)
    page.mouse.up()
    expect(note).to_contain_text("pass.")
    least, greatest = (float(end) for end in value_text(strip).split(" to "))
    assert least == pytest.approx(low, rel=0.01)
    assert greatest == pytest.approx((low * high) ** 0.5, rel=0.05)
    passing = int(note.inner_text().split()[0])
    # The text has three digits.
    assert below(study, 0.99 * greatest) <= passing <= below(study, 1.01 * greatest)


def value_text(strip: Locator) -> str:
    expect(strip).to_have_attribute("aria-valuetext", re.compile(" to "))
    return strip.get_attribute("aria-valuetext") or ""


def below(study: dict[str, Any], nu: float) -> int:
    return sum(entry["values"]["nu"] <= nu for entry in study["entries"])


def min_max(study: dict[str, Any], gain: str) -> tuple[float, float]:
    values = [entry["values"][gain] for entry in study["entries"]]
    return min(values), max(values)


def test_importance_is_told_from_24_trials_on(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    part(page).get_by_role("tab", name="Importance").click()
    shares = list(study["result"]["importance"].values())
    bars = part(page).locator(".search-bar-share")
    expect(bars).to_have_count(len(shares))
    expect(bars.first).to_have_text(f"{100 * shares[0]:.0f} %")
    page.evaluate(
        """() => { const {result, study, entries} = harness;
          result.update({...study, result: {...study.result, importance: null}},
            entries.slice(0, 7)); }"""
    )
    expect(part(page).locator(".search-importance")).to_have_text("After 24 trials; there are 7.")


def test_gains_are_used_in_the_lane_or_a_new_one_as_one_edit_each(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    before = {key: lane(dashboard)[key] for key in ("nu", "c")}
    choose(page, 5)
    part(page).get_by_role("button", name="Use these gains").click()
    until_gains(dashboard, gains_of(study, 5))
    expect(part(page).get_by_role("button", name="Use these gains")).to_be_disabled()
    until_label(page, f"gains of {LANE}")
    page.evaluate("harness.history.undo()")
    until_gains(dashboard, before)
    for name in (f"{LANE} tuned", f"{LANE} tuned 2"):
        part(page).get_by_role("button", name="Apply as a new lane").click()
        until_gains(dashboard, gains_of(study, 5), name)
    until_label(page, f"new lane {LANE} tuned 2")
    page.evaluate("harness.history.undo()")
    end = time.monotonic() + DEADLINE
    while lane(dashboard, f"{LANE} tuned 2"):
        assert time.monotonic() < end
        time.sleep(0.05)
    with page.expect_download() as preset:
        part(page).get_by_role("link", name="Download preset").click()
    assert preset.value.suggested_filename == f"study-{study['id']}.preset.yaml"


@pytest.mark.parametrize("width", [390, 760])
def test_nothing_is_wider_than_a_narrow_screen(
    page: Page, dashboard: Dashboard, study: dict[str, Any], width: int
) -> None:
    size = page.viewport_size
    page.set_viewport_size({"width": width, "height": 844})
    mounted(page, dashboard, study)
    for tab in ("Progress", "Compromises", "Gains and score", "Importance"):
        part(page).get_by_role("tab", name=tab).click()
        wide = """() => { const {scrollWidth, clientWidth} = document.querySelector('.harness');
            return scrollWidth - clientWidth; }"""
        assert page.evaluate(wide) == 0, tab
    assert size is not None
    page.set_viewport_size(size)


def test_two_thousand_trials_are_taken_at_once(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    page.evaluate(
        """() => {
          const {result, study, entries} = harness;
          const many = Array.from({length: 2000}, (_, number) => (
            {...entries[number % entries.length], number}));
          result.update({...study, total: 2000}, many);
        }"""
    )
    slider = part(page).get_by_label("Trial", exact=True)
    expect(slider).to_have_attribute("max", "1999")
    choose(page, 1999)
    # The points are no elements: as many as there are trials would make the page slow.
    assert page.locator(".harness .search-figure *").count() < 200


@pytest.mark.fresh
def test_axe_finds_nothing_serious_in_light_and_in_dark(
    page: Page, dashboard: Dashboard, study: dict[str, Any]
) -> None:
    mounted(page, dashboard, study)
    inspector = Inspector(page)
    inspector.start()
    for tab in ("Progress", "Compromises", "Gains and score", "Importance"):
        part(page).get_by_role("tab", name=tab).click()
        inspector.look(tab, ".harness")
    assert inspector.found == []


@pytest.mark.parametrize("tab", ["Progress", "Compromises", "Gains and score"])
def test_a_trial_under_the_pointer_and_its_response_are_seen_together(
    page: Page, dashboard: Dashboard, study: dict[str, Any], tab: str
) -> None:
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Studies").click()
    page.locator(".study-item").click()
    page.get_by_role("tab", name=tab, exact=True).click()
    response = page.locator(".search-preview .lens-graph .main-svg").first
    expect(response).to_be_attached()
    boxes = [
        part.bounding_box()
        for part in (
            page.locator(".search-pictures"),
            page.locator(".search-preview .lens-graph"),
            page.locator(".search-actions"),
            page.locator(".study-scroller"),
        )
    ]
    plot, preview, actions, scroller = (box for box in boxes if box is not None)
    assert scroller["y"] <= plot["y"]
    assert preview["y"] + preview["height"] <= actions["y"] + 1
    assert actions["y"] + actions["height"] <= scroller["y"] + scroller["height"] + 1
