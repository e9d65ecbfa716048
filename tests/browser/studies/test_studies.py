"""Studies in the page: what is missing is said, one is begun, followed, stopped, gone on with."""

from __future__ import annotations

import re
import time
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.knobs.knob import knob
from tests.browser.conftest import Complaints, Dashboard
from tests.browser.lenses.test_lenses import experiment, patch

LANE = "RBFNN-NFTSM"
SHORT = {"simulation": {"horizon": 0.3}}
LONG = {"simulation": {"horizon": 4.0}}
GOALS = {"goals": {"near": {"kind": "figure", "figure": "mae", "bound": 0.01}}}
RANGES = {"uncertainty": {"payload": [0.0, 3.0]}}
DEADLINE = 120.0


def prepare(dashboard: Dashboard, *patches: dict[str, Any]) -> None:
    for change in patches:
        patch(dashboard, change)


def begun(dashboard: Dashboard, kind: str, title: str = "", **wanted: Any) -> int:
    body = {"kind": kind, "title": title, "wanted": {"lane": LANE, **wanted}}
    answer = dashboard.client.post("/api/studies", json=body)
    assert answer.status_code == 201, answer.text
    return int(answer.json()["id"])


def study(dashboard: Dashboard, number: int) -> dict[str, Any]:
    return dict(dashboard.client.get(f"/api/studies/{number}").raise_for_status().json())


def entries(dashboard: Dashboard, number: int) -> list[dict[str, Any]]:
    answer = dashboard.client.get(f"/api/studies/{number}/entries").raise_for_status()
    return list(answer.json()["entries"])


def ended(dashboard: Dashboard, number: int) -> dict[str, Any]:
    end = time.monotonic() + DEADLINE
    while (found := study(dashboard, number))["state"] in ("waiting", "running"):
        assert time.monotonic() < end, found
        time.sleep(0.05)
    assert found["state"] == "done", found["message"]
    return found


def open_view(page: Page, dashboard: Dashboard) -> Locator:
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Studies").click()
    return page.locator(".studies")


def open_form(page: Page, dashboard: Dashboard, kind: str) -> Locator:
    view = open_view(page, dashboard)
    form = view.get_by_role("form", name="New study")
    form.get_by_text(kind, exact=True).click()
    return form


def open_kept(page: Page, dashboard: Dashboard, number: int) -> Locator:
    view = open_view(page, dashboard)
    view.locator(f'[data-study="{number}"] button').click()
    expect(view.locator(".study-head .study-state")).to_have_text("done", timeout=DEADLINE * 1000)
    return view


@pytest.mark.parametrize(
    ("kind", "lacks"),
    [
        ("Auto-tune", ["Set a goal first"]),
        ("Robustness", ["Give a quantity of Uncertainty a range"]),
        ("Worst case", ["Set a goal first", "Give a quantity of Uncertainty a range"]),
        ("Sweep", []),
    ],
)
def test_what_is_missing_is_said_and_mended(
    page: Page, dashboard: Dashboard, kind: str, lacks: list[str]
) -> None:
    form = open_form(page, dashboard, kind)
    begin = form.get_by_role("button", name="Begin")
    missing = form.locator(".study-missing li")
    expect(missing).to_have_count(len(lacks))
    for place, text in enumerate(lacks):
        expect(missing.nth(place)).to_contain_text(text)
    if not lacks:
        expect(begin).to_be_enabled()
        return
    expect(begin).to_be_disabled()
    for group, key in (("Goals", "goals"), ("Uncertainty", "uncertainty")):
        button = form.get_by_role("button", name=f"Open {group}")
        if button.count():
            button.click()
            opened = page.locator(f'#tune details[data-group="{key}"]')
            expect(opened).to_have_attribute("open", "")
            expect(opened.locator("> summary")).to_be_focused()
    prepare(dashboard, GOALS, RANGES)
    expect(missing).to_have_count(0)
    expect(begin).to_be_enabled()


def test_a_search_without_a_bound_on_chattering_is_warned_of(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, GOALS)
    form = open_form(page, dashboard, "Auto-tune")
    warning = form.get_by_text("No goal bounds chattering")
    expect(warning).to_be_hidden()
    form.get_by_label("No more chattering than now").uncheck()
    expect(warning).to_be_visible()
    expect(form.get_by_role("button", name="Begin")).to_be_enabled()
    quiet = {"kind": "figure", "figure": "chattering", "bound": 200}
    prepare(dashboard, {"goals": {"quiet": quiet}})
    expect(warning).to_be_hidden()


def test_a_search_has_draws_where_something_is_uncertain_and_keeps_what_was_typed(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, GOALS)
    form = open_form(page, dashboard, "Auto-tune")
    draws = form.locator('[data-field="draws"]').get_by_role("textbox")
    expect(draws).to_have_value("0")
    prepare(dashboard, RANGES)
    expect(draws).to_have_value("50")
    prepare(dashboard, {"uncertainty": None})
    expect(draws).to_have_value("0")
    draws.fill("7")
    prepare(dashboard, RANGES)
    expect(draws).to_have_value("7")


def test_the_best_gains_of_a_search_from_the_form_chatter_no_more_than_now(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, SHORT, GOALS, RANGES)
    form = open_form(page, dashboard, "Auto-tune")
    form.locator('[data-field="trials"] input').fill("17")
    form.get_by_role("button", name="Begin").click()
    view = page.locator(".studies")
    expect(view.locator(".study-head .study-state")).to_have_text("done", timeout=DEADLINE * 1000)
    (found,) = dashboard.client.get("/api/studies").json()["studies"]
    told = study(dashboard, found["id"])
    assert told["wanted"]["quiet"] is True
    assert told["wanted"]["draws"] == 50
    means = [told["result"][one]["draws"]["means"]["chattering"] for one in ("present", "best")]
    assert means[1] <= means[0]
    table = view.locator(".search-table")
    for name in ("mean error", "chattering"):
        expect(table).to_contain_text(f"{name}, mean")


def test_the_ranges_of_other_values_at_other_joints_are_those_of_the_greatest(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, {"lanes": {LANE: {"k1": 80}}})
    form = open_form(page, dashboard, "Auto-tune")
    told = form.get_by_text("those of the joint with the greatest")
    expect(told).to_be_hidden()
    prepare(dashboard, {"lanes": {LANE: {"k1": [80, 80, 40, 8, 8, 8]}}})
    expect(told).to_be_visible()
    expect(form.get_by_label("Proportional reaching gain, to")).to_have_value("800")


def test_a_search_has_every_acting_gain_from_a_tenth_to_ten_times(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, SHORT, GOALS)
    form = open_form(page, dashboard, "Auto-tune")
    nu = form.locator('[data-gain="nu"]')
    value = experiment(dashboard)["lanes"][LANE]["nu"]
    bounds = knob(Experiment.from_document(experiment(dashboard)), LANE, "nu")
    expect(nu.get_by_role("checkbox")).to_be_checked()
    low, high = (nu.get_by_role("textbox").nth(place).input_value() for place in (0, 1))
    assert float(low) == pytest.approx(max(value / 10, bounds.low), rel=1e-3)
    assert float(high) == pytest.approx(min(value * 10, bounds.high), rel=1e-3)
    for tick in form.locator(".study-gains input[type=checkbox]").all():
        tick.uncheck()
    expect(form.locator(".study-missing")).to_contain_text("Tick a gain")
    nu.get_by_role("checkbox").check()
    form.locator('[data-field="trials"] input').fill("9")
    form.get_by_label("Title").fill("only ν")
    form.get_by_role("button", name="Begin").click()
    view = page.locator(".studies")
    expect(view.locator(".study-head h3")).to_have_text("only ν")
    expect(view.locator(".study-head h3")).to_be_focused()
    expect(view.locator(".study-head .study-state")).to_have_text("done", timeout=DEADLINE * 1000)
    expect(view.locator(".study-words")).to_contain_text("9 of 9 trials")
    (found,) = dashboard.client.get("/api/studies").json()["studies"]
    told = study(dashboard, found["id"])
    assert list(told["wanted"]["gains"]) == ["nu"]
    best = told["result"]["best"]["outcome"]["score"]
    shown = re.search(r"best score ([\d.]+)", view.locator(".study-words").inner_text())
    assert shown
    assert float(shown[1]) == pytest.approx(best, rel=0.01)
    links = view.get_by_role("group", name="Download").get_by_role("link")
    expect(links).to_have_text(["YAML", "CSV", "Parquet", "Preset"])
    for link in links.all():
        answer = dashboard.client.get(link.get_attribute("href") or "")
        assert answer.status_code == 200


def test_a_refusal_is_said_at_its_field_and_nothing_is_begun(
    page: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("422")
    prepare(dashboard, SHORT, GOALS, RANGES)
    form = open_form(page, dashboard, "Auto-tune")
    begin = form.get_by_role("button", name="Begin")
    nu, trials = form.locator('[data-gain="nu"]'), form.locator('[data-field="trials"]')
    nu.get_by_role("textbox").nth(1).fill("1e8")
    begin.click()
    expect(nu.get_by_role("alert")).to_contain_text("must lie in")
    nu.get_by_role("textbox").nth(1).fill("wide")
    trials.get_by_role("textbox").fill("0")
    begin.click()
    expect(nu.get_by_role("alert")).to_have_text("Give a number.")
    nu.get_by_role("textbox").nth(1).fill("20")
    begin.click()
    expect(trials.get_by_role("alert")).not_to_be_empty()
    expect(trials.get_by_role("textbox")).to_have_attribute("aria-invalid", "true")
    form.get_by_text("Sweep", exact=True).click()
    axis = form.locator(".study-axis")
    axis.get_by_label("To").fill("-5")
    begin.click()
    expect(axis.get_by_role("alert")).to_contain_text("from the least to the greatest")
    assert dashboard.client.get("/api/studies").json()["studies"] == []


def test_a_study_is_stopped_found_again_gone_on_with_and_deleted(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, LONG, GOALS)
    number = begun(dashboard, "tune", title="long", trials=5000)
    view = open_view(page, dashboard)
    # What is under way is followed without a word.
    expect(view.locator(".study-head h3")).to_have_text("long")
    expect(view.locator(".study-words")).to_contain_text(re.compile(r"[1-9]\d* of 5000 trials"))
    page.reload()
    expect(view.locator(".study-head h3")).to_have_text("long")
    view.get_by_role("button", name="Stop").click()
    expect(view.locator(".study-head .study-state")).to_have_text("stopped")
    made = study(dashboard, number)["made"]
    assert 0 < made < 5000
    view.get_by_role("button", name="Resume").click()
    expect(view.locator(".study-head .study-state")).to_have_text("running")
    end = time.monotonic() + DEADLINE
    while (now := study(dashboard, number)["made"]) <= made:
        assert time.monotonic() < end, now
        time.sleep(0.05)
    view.get_by_role("button", name="Stop").click()
    expect(view.locator(".study-head .study-state")).to_have_text("stopped")
    view.get_by_role("button", name="All studies").click()
    expect(view.locator(f'[data-study="{number}"]')).to_contain_text("stopped")
    view.locator(f'[data-study="{number}"] button').click()
    view.get_by_role("button", name="Delete").click()
    page.get_by_role("dialog").get_by_role("button", name="Delete").click()
    expect(view.locator(".study-none")).to_be_visible()
    assert dashboard.client.get("/api/studies").json()["studies"] == []


def test_a_study_of_another_experiment_says_in_what_and_loads_its_own(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, SHORT, GOALS, RANGES)
    number = begun(dashboard, "robustness", draws=4)
    ended(dashboard, number)
    view = open_kept(page, dashboard, number)
    other = view.locator(".study-other")
    expect(other).to_be_hidden()
    before = experiment(dashboard)
    patch(dashboard, {"lanes": {LANE: {"nu": 2.5}}, "goals": {"near": None}})
    expect(other).to_contain_text("differs in ν, its goals")
    other.get_by_role("button", name="Load its experiment").click()
    expect(other).to_be_hidden()
    assert experiment(dashboard) == before
    page.locator("body").press("Control+z")
    expect(other).to_be_visible()


@pytest.mark.parametrize("gains", [{"nu": {"low": 1, "high": 100}}, {}])
def test_other_values_of_what_a_search_turns_are_no_other_experiment(
    page: Page, dashboard: Dashboard, gains: dict[str, Any]
) -> None:
    prepare(dashboard, SHORT, GOALS)
    number = begun(dashboard, "tune", trials=2, gains=gains)
    ended(dashboard, number)
    view = open_kept(page, dashboard, number)
    other = view.locator(".study-other")
    patch(dashboard, {"lanes": {LANE: {"nu": 2.5, "switching": "sign"}}})
    expect(other).to_contain_text("differs in sw.")
    patch(dashboard, {"lanes": {LANE: {"switching": "tanh"}}})
    expect(other).to_be_hidden()


def test_who_leaves_a_search_leaves_the_gains_that_were_tried(
    page: Page, dashboard: Dashboard
) -> None:
    prepare(dashboard, SHORT, GOALS)
    gains = {"nu": {"low": 1, "high": 100}}
    number = begun(dashboard, "tune", trials=4, gains=gains)
    ended(dashboard, number)
    view = open_kept(page, dashboard, number)
    before = experiment(dashboard)["lanes"][LANE]
    tried = entries(dashboard, number)[3]["values"]["nu"]
    view.get_by_label("Trial", exact=True).fill("3")
    # The button itself is hidden behind its label.
    view.get_by_text("B candidate").click()
    expect(view.locator(".search-actions")).to_contain_text("has the gains of trial 3")
    assert experiment(dashboard)["lanes"][LANE]["nu"] == tried
    view.get_by_role("button", name="All studies").click()
    end = time.monotonic() + DEADLINE
    while (now := experiment(dashboard)["lanes"][LANE]) != before:
        assert time.monotonic() < end, now
        time.sleep(0.05)


def test_a_server_that_is_lost_is_heard_again(
    page: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("api/studies/")
    complaints.allow("Failed to load resource")
    prepare(dashboard, LONG, GOALS)
    begun(dashboard, "tune", trials=5000)
    lost = True
    page.route(
        "**/api/studies/*/events*",
        lambda route: route.abort("connectionfailed") if lost else route.continue_(),
    )
    view = open_view(page, dashboard)
    expect(view.locator(".study-lost")).to_contain_text(re.compile("can.t be (heard|followed)"))
    lost = False
    expect(view.locator(".study-lost")).to_be_hidden(timeout=60_000)
    expect(view.locator(".study-words")).to_contain_text(re.compile(r"[1-9]\d* of 5000 trials"))
    view.get_by_role("button", name="Stop").click()
    expect(view.locator(".study-head .study-state")).to_have_text("stopped")


def test_the_keyboard_begins_a_sweep_of_two_fields(page: Page, dashboard: Dashboard) -> None:
    prepare(dashboard, SHORT)
    form = open_form(page, dashboard, "Auto-tune")
    kind = form.get_by_role("radio", name="Auto-tune")
    kind.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    expect(form.get_by_role("radio", name="Sweep")).to_be_checked()
    more = form.get_by_role("button", name="Add a second field")
    more.press("Enter")
    second = form.locator(".study-axis").nth(1)
    expect(second.get_by_label("Field", exact=True)).to_be_focused()
    second.get_by_label("Field", exact=True).select_option("robot.payload.mass")
    for axis in form.locator(".study-axis").all():
        axis.get_by_label("Values").fill("2")
    expect(form.locator(".study-total")).to_have_text("4 runs")
    form.get_by_role("button", name="Begin").press("Enter")
    view = page.locator(".studies")
    expect(view.locator(".study-words")).to_contain_text("4 of 4", timeout=DEADLINE * 1000)
    (found,) = dashboard.client.get("/api/studies").json()["studies"]
    axes = study(dashboard, found["id"])["wanted"]["axes"]
    assert axes[1]["field"] == "robot.payload.mass"
    assert [axis["count"] for axis in axes] == [2, 2]


def test_on_a_phone_nothing_is_wider_than_the_screen(page: Page, dashboard: Dashboard) -> None:
    prepare(dashboard, SHORT, GOALS, RANGES)
    number = begun(dashboard, "worst", trials=4)
    ended(dashboard, number)
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(dashboard.url)
    page.locator("#tabs").get_by_role("tab", name="Plots").click()
    page.get_by_role("tab", name="Studies", exact=True).click()
    view = page.locator(".studies")
    expect(view.locator(f'[data-study="{number}"]')).to_be_visible()
    wide = (
        "root => [...root.querySelectorAll('.study-scroller, .study-scroll, .lens-scroll')]"
        ".filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.className)"
    )
    for kind in ("Auto-tune", "Robustness", "Worst case", "Sweep"):
        view.locator(".study-kinds").get_by_text(kind, exact=True).click()
        assert view.evaluate(wide) == [], kind
    # The group that mends what is missing lies in another part of a narrow screen.
    patch(dashboard, {"goals": {"near": None}})
    view.locator(".study-kinds").get_by_text("Auto-tune", exact=True).click()
    view.get_by_role("button", name="Open Goals").click()
    expect(page.locator('#tune details[data-group="goals"] > summary')).to_be_focused()
    page.locator("#tabs").get_by_role("tab", name="Plots").click()
    view.locator(f'[data-study="{number}"] button').click()
    expect(view.get_by_text("Worst found, not guaranteed")).to_be_visible()
    assert view.evaluate(wide) == []
