"""Goals in the page: added, shown against every lane as the server judges them, and taken back."""

from __future__ import annotations

import re
import time
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.loop.verdict import judge_goals
from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import experiment, patch

SETTLED = {"kind": "response", "channel": "e", "start": 0.5, "bound": 0.02}
SHORT = {"simulation": {"horizon": 2.0}}


def group(page: Page) -> Locator:
    return page.locator("details.goals")


def open_goals(page: Page, dashboard: Dashboard) -> Locator:
    page.goto(dashboard.url)
    expect(page.locator(".gains-head h2")).to_be_visible()
    group(page).locator("summary").click()
    return group(page)


def until_goals(dashboard: Dashboard, count: int) -> dict[str, Any]:
    end = time.monotonic() + 60.0
    while len(goals := experiment(dashboard)["goals"]) != count:
        assert time.monotonic() < end, goals
        time.sleep(0.05)
    return dict(goals)


def test_a_goal_is_added_and_every_lane_is_held_to_it(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, SHORT)
    goals = open_goals(page, dashboard)
    form = goals.locator("form")
    form.get_by_label("Bound", exact=True).fill("0.02")
    form.get_by_label("From").fill("0.5")
    form.get_by_label("Priority").select_option("hard")
    form.get_by_role("button", name="Add goal").click()
    (goal,) = until_goals(dashboard, 1).values()
    assert goal == {**SETTLED, "joint": 0, "priority": "hard", "end": 120}
    row = goals.locator(".goal")
    expect(row.locator(".goal-words")).to_have_text("error |e| ≤ 0.02 rad, from 0.5 s")
    run = simulate(Experiment.from_document(experiment(dashboard)), estimate=False)
    chips = row.locator(".goal-chip")
    expect(chips).to_have_count(len(run.lanes))
    for index, lane in enumerate(run.lanes.values()):
        verdict = judge_goals(run.experiment.goals, lane, lane.metrics)
        expect(chips.nth(index)).to_have_class(
            re.compile("is-kept" if verdict.kept else "is-missed")
        )
        assert float(chips.nth(index).inner_text()) == pytest.approx(verdict.score, rel=0.01)
        score = goals.locator(".goal-scores .goal-chip").nth(index).inner_text()
        assert float(score) == pytest.approx(verdict.score, rel=0.01)


def test_a_figure_is_bounded_in_the_unit_of_the_table(page: Page, dashboard: Dashboard) -> None:
    goals = open_goals(page, dashboard)
    form = goals.locator("form")
    form.get_by_label("What is bounded").select_option(label="flange RMS")
    expect(form.get_by_label("Joint")).to_be_disabled()
    expect(form.get_by_label("From")).to_be_hidden()
    form.get_by_label("Bound", exact=True).fill("5")
    form.get_by_label("Bound", exact=True).press("Enter")
    (goal,) = until_goals(dashboard, 1).values()
    assert goal["figure"] == "flange_rms"
    assert goal["bound"] == pytest.approx(0.005)
    expect(goals.locator(".goal-words")).to_have_text("flange RMS ≤ 5 mm")


@pytest.mark.parametrize(("bound", "words"), [("-1", r"\[1e-09, 1e\+09\]"), ("wide", "as numbers")])
def test_a_bad_bound_is_refused_in_words_and_stays(
    page: Page, dashboard: Dashboard, bound: str, words: str
) -> None:
    form = open_goals(page, dashboard).locator("form")
    form.get_by_label("Bound", exact=True).fill(bound)
    form.get_by_role("button", name="Add goal").click()
    expect(form.get_by_role("alert")).to_have_text(re.compile(words))
    expect(form.get_by_label("Bound", exact=True)).to_have_value(bound)
    assert experiment(dashboard)["goals"] == {}


def test_priority_changes_a_goal_is_removed_and_undo_brings_it_back(
    page: Page, dashboard: Dashboard
) -> None:
    patch(dashboard, {"goals": {"near": SETTLED}, **SHORT})
    goals = open_goals(page, dashboard)
    goals.get_by_role("button", name="near is soft: make it hard").focus()
    page.keyboard.press("Enter")
    expect(goals.get_by_role("button", name="near is hard: make it soft")).to_be_focused()
    assert experiment(dashboard)["goals"]["near"]["priority"] == "hard"
    goals.get_by_role("button", name="Remove near").click()
    until_goals(dashboard, 0)
    expect(goals.locator(".goal")).to_have_count(0)
    page.locator("body").press("Control+z")
    until_goals(dashboard, 1)
    expect(goals.locator(".goal")).to_have_count(1)


def test_bounds_are_lines_in_the_plots_of_the_response(page: Page, dashboard: Dashboard) -> None:
    goals = {"near": {**SETTLED, "joint": 2}, "far": {**SETTLED, "bound": 9.0, "joint": 2}}
    patch(dashboard, {"goals": goals, **SHORT})
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Response").click()
    script = """() => [...document.querySelectorAll('.response .js-plotly-plot')].flatMap(
        (graph) => graph.data.filter(({uid}) => uid.startsWith('bound')).map(
            ({uid, x, y, yaxis, name}) => ({uid, name, x: [...x], y: [...y], yaxis})))"""
    end = time.monotonic() + 60.0
    while len(found := page.evaluate(script)) != 4:
        assert time.monotonic() < end, found
        time.sleep(0.05)
    near = [line for line in found if line["name"] == "near"]
    assert sorted(line["y"][0] for line in near) == [-0.02, 0.02]
    assert all(line["x"] == [0.5, 2] for line in near)
    assert {line["yaxis"] for line in found} == {"y2"}
    run = simulate(Experiment.from_document(experiment(dashboard)), estimate=False)
    kept = all(
        judge_goals(run.experiment.goals, lane, lane.metrics).met for lane in run.lanes.values()
    )
    tone = "good" if kept else "bad"
    assert all(tone in line["uid"] for line in near)
    assert all("good" in line["uid"] for line in found if line["name"] == "far")


def test_a_focused_goal_moves_with_the_arrow_keys_as_one_edit(
    page: Page, dashboard: Dashboard
) -> None:
    patch(dashboard, {"goals": {"near": SETTLED}, **SHORT})
    goals = open_goals(page, dashboard)
    words = goals.get_by_role("spinbutton", name="Bound of near")
    words.focus()
    page.keyboard.down("ArrowUp")
    page.keyboard.down("ArrowUp")
    expect(words).to_have_text("error |e| ≤ 0.0208 rad, from 0.5 s")
    page.keyboard.up("ArrowUp")
    end = time.monotonic() + 60.0
    while experiment(dashboard)["goals"]["near"]["bound"] != 0.0208:
        assert time.monotonic() < end, experiment(dashboard)["goals"]
        time.sleep(0.05)
    expect(words).to_be_focused()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowLeft")
    expect(words).to_have_text("error |e| ≤ 0.0208 rad, 0.6 s to 1.9 s")
    for _ in range(3):
        page.keyboard.press("Control+z")
    expect(words).to_have_text("error |e| ≤ 0.02 rad, from 0.5 s")
    expect(page.get_by_role("button", name="Undo")).to_be_disabled()
    assert experiment(dashboard)["goals"]["near"]["end"] == 120


def test_the_joint_of_a_goal_is_changed_in_its_row(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"goals": {"near": SETTLED}, **SHORT})
    goals = open_goals(page, dashboard)
    goals.get_by_label("Joint of near").select_option(label="joint 3")
    expect(goals.locator(".goal-words")).to_have_text("error |e| of joint 3 ≤ 0.02 rad, from 0.5 s")
    assert experiment(dashboard)["goals"]["near"]["joint"] == 3


def test_a_figure_of_the_table_is_set_as_a_goal(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, SHORT)
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Response").click()
    page.locator(".lane-pick").nth(1).click()
    name = page.locator(".lane").nth(1).locator(".lane-name").inner_text()
    run = simulate(Experiment.from_document(experiment(dashboard)), estimate=False)
    expect(page.locator(".response-status")).to_have_attribute("data-estimated", "true")
    page.get_by_role("button", name="Set a goal: MAE J2").click()
    form = group(page).locator("form")
    bound = form.get_by_label("Bound", exact=True)
    expect(bound).to_be_focused()
    present = 1000 * run.lanes[name].metrics.mae[1]
    assert present <= float(bound.input_value()) == pytest.approx(present, rel=0.01)
    bound.press("Enter")
    (goal,) = until_goals(dashboard, 1).values()
    assert (goal["figure"], goal["joint"]) == ("mae", 2)
    # Rounded up: the lane that has it keeps to it.
    chip = group(page).locator(".goal .goal-chip").nth(1)
    expect(chip).to_have_class(re.compile("is-kept"))


def test_a_figure_is_no_goal_before_there_is_a_response(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, SHORT)
    held: list[Route] = []
    released = False

    def hold(route: Route) -> None:
        if released:
            route.continue_()
        else:
            held.append(route)

    page.route("**/api/preview", hold)
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Response").click()
    button = page.get_by_role("button", name="Set a goal: MAE J2")
    expect(button).to_be_disabled()
    released = True
    for route in held:
        route.continue_()
    expect(button).to_be_enabled()
    button.click()
    expect(group(page).locator("form").get_by_label("Bound", exact=True)).not_to_have_value("")


@pytest.mark.parametrize("ratio", [0.5, 0.9996, 1.0, 1.002, 1.0004, 1.00000001, 12.34, None])
def test_a_missed_bound_never_reads_as_one_that_is_met(
    page: Page, dashboard: Dashboard, ratio: float | None
) -> None:
    page.goto(f"{dashboard.url}docs")
    script = "async (ratio) => (await import('/static/goals/words.js')).ratioText(ratio)"
    text = page.evaluate(script, ratio)
    if ratio is None:
        assert text == "–"
    elif ratio <= 1.0:
        assert float(text) <= 1.0
    else:
        assert text == "> 1" or float(text) > 1.0
    if ratio is not None and text != "> 1":
        assert float(text) == pytest.approx(ratio, rel=0.005)
