"""Bounds over the plots of the response: drawn with the mouse, dragged, and judged as it says."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.loop.verdict import judge_goals
from tests.browser.conftest import Dashboard
from tests.browser.lenses.test_lenses import experiment, patch

HORIZON = 2.0
SHORT = {"simulation": {"horizon": HORIZON}}
NEAR = {"kind": "response", "channel": "e", "joint": 2, "start": 0.5, "end": 1.5, "bound": 0.05}
PLACE = """([panel, time, value]) => {
  const graph = document.querySelector('.response .plots-graph');
  const {xaxis, [panel ? `yaxis${panel + 1}` : 'yaxis']: yaxis} = graph._fullLayout;
  const {left, top} = graph.getBoundingClientRect();
  return [left + xaxis._offset + xaxis.l2p(time), top + yaxis._offset + yaxis.l2p(value)];
}"""
"""Where the plotting library has a moment and a value of one of its panels."""
SHADED = """() => {
  const {xaxis} = document.querySelector('.response .plots-graph')._fullLayout;
  const strips = document.querySelectorAll('.bound-shading path:nth-child(even)');
  return [...strips].flatMap((strip) => (
    [...strip.getAttribute('d').matchAll(/M([\\d.]+),[\\d.]+H([\\d.]+)/g)].map(
      ([, ...ends]) => ends.map((x) => xaxis.p2l(Number(x) - xaxis._offset)))));
}"""
"""From when to when the strips along the axis are red, in [s]."""
PIXEL = 0.01
"""Seconds that a pixel takes at most."""


def open_response(page: Page, dashboard: Dashboard) -> None:
    """Open the page on the response of the newest revision, drawn."""
    page.goto(dashboard.url)
    page.get_by_role("tab", name="Response", exact=True).click()
    settled(page, dashboard)


def settled(page: Page, dashboard: Dashboard) -> None:
    revision = dashboard.client.get("api/experiment").json()["revision"]
    status = page.locator(".response-status")
    expect(status).to_have_attribute("data-response", str(revision), timeout=60_000)
    expect(status).to_have_attribute("data-estimated", "true", timeout=60_000)
    expect(page.locator(".response .trace path.js-line").first).to_be_attached()


def at(page: Page, panel: int, moment: float, value: float) -> tuple[float, float]:
    x, y = page.evaluate(PLACE, [panel, moment, value])
    return x, y


def arm(page: Page) -> None:
    page.locator(".response").get_by_role("button", name="Draw a bound").click()
    expect(page.locator(".bound-sheet")).to_be_visible()


def press_and_move(page: Page, start: tuple[float, float], end: tuple[float, float]) -> None:
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=6)


def goals_of(dashboard: Dashboard) -> dict[str, Any]:
    return dict(experiment(dashboard)["goals"])


def until(dashboard: Dashboard, done: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    end = time.monotonic() + 60.0
    while not done(goals := goals_of(dashboard)):
        assert time.monotonic() < end, goals
        time.sleep(0.05)
    return goals


def until_one(dashboard: Dashboard) -> dict[str, Any]:
    (goal,) = until(dashboard, lambda goals: len(goals) == 1).values()
    return dict(goal)


def grip(page: Page, part: str, name: str = "near") -> Locator:
    """Return what the upper line of a goal is taken by."""
    return page.locator(f".bound-grip[data-goal='{name}'][data-part={part}]").first


def middle(taken: Locator) -> tuple[float, float]:
    box = taken.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def lanes_shaded(bound: float, dashboard: Dashboard) -> tuple[float, bool]:
    """Return how long all lanes together leave the bound of NEAR, and whether all keep to it."""
    run = simulate(Experiment.from_document(experiment(dashboard)), estimate=False)
    total, kept = 0.0, True
    for lane in run.lanes.values():
        inside = (lane.time >= NEAR["start"]) & (lane.time <= NEAR["end"])
        above = np.abs(lane.e[inside, 1]) > bound
        total += float(above.mean()) * (NEAR["end"] - NEAR["start"])
        ratios = judge_goals(run.experiment.goals, lane, lane.metrics).ratios
        kept &= (ratios["near"] or np.inf) <= 1.0
    return total, kept


def test_a_band_is_drawn_and_is_a_goal_of_that_joint(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, SHORT)
    open_response(page, dashboard)
    arm(page)
    # From right to left, and below zero: it is the same band.
    press_and_move(page, at(page, 1, 1.5, 0.0), at(page, 1, 0.4, -0.05))
    label = page.locator(".bound-label").inner_text()
    page.mouse.up()
    goal = until_one(dashboard)
    assert (goal["channel"], goal["joint"], goal["priority"]) == ("e", 2, "soft")
    assert goal["start"] == pytest.approx(0.4, abs=PIXEL)
    assert goal["end"] == pytest.approx(1.5, abs=PIXEL)
    assert goal["bound"] == pytest.approx(0.05, rel=0.05)
    assert goal["bound"] == float(f"{goal['bound']:.3g}")
    shown = f"|e₂| ≤ {goal['bound']:g} rad, {goal['start']:g} to {goal['end']:g} s"
    assert label == shown
    row = page.locator(".goal")
    expect(row.get_by_label("Joint of goal 1")).to_have_value("2")
    expect(row.locator(".goal-words")).to_contain_text(f"of joint 2 ≤ {goal['bound']:g} rad")
    expect(page.locator(".bound-sheet")).to_be_hidden()
    page.keyboard.press("Control+z")
    until(dashboard, lambda goals: not goals)
    expect(page.locator(".bound-grip")).to_have_count(0)


def test_a_bound_is_drawn_in_the_unit_of_the_plot_and_kept_in_si(
    page: Page, dashboard: Dashboard
) -> None:
    patch(dashboard, SHORT)
    open_response(page, dashboard)
    page.locator(".response").get_by_role("tab", name="Flange error").click()
    expect(page.locator(".response .ytitle")).to_contain_text("mm")
    arm(page)
    press_and_move(page, at(page, 0, 0.5, 0.0), at(page, 0, 1.0, 20.0))
    expect(page.locator(".bound-label")).to_contain_text("flange error ≤")
    page.mouse.up()
    goal = until_one(dashboard)
    assert (goal["channel"], goal["joint"]) == ("flange_error", 0)
    assert goal["bound"] == pytest.approx(0.02, rel=0.05)
    expect(page.locator(".goal .goal-words")).to_contain_text(f"≤ {1000 * goal['bound']:g} mm")
    expect(page.get_by_label("Joint of goal 1")).to_be_hidden()


def test_a_click_bounds_the_whole_response(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, SHORT)
    open_response(page, dashboard)
    page.locator("details.goals summary").click()
    page.locator("details.goals").get_by_role("button", name="Draw a bound").click()
    page.locator(".response").get_by_role("tab", name="Torque").click()
    place = at(page, 0, 1.0, 0.0)
    page.mouse.move(place[0], place[1] - 20)
    expect(page.locator(".bound-label")).to_contain_text("|τ₁| ≤")
    page.mouse.down()
    page.mouse.up()
    goal = until_one(dashboard)
    assert (goal["channel"], goal["joint"], goal["start"], goal["end"]) == ("tau", 1, 0, 120)


@pytest.mark.parametrize("pressed", [True, False])
def test_escape_draws_nothing(page: Page, dashboard: Dashboard, pressed: bool) -> None:
    patch(dashboard, SHORT)
    open_response(page, dashboard)
    arm(page)
    if pressed:
        press_and_move(page, at(page, 0, 0.4, 0.0), at(page, 0, 1.5, 0.01))
    page.keyboard.press("Escape")
    expect(page.locator(".bound-sheet")).to_be_hidden()
    expect(page.locator(".bound-preview")).to_be_hidden()
    page.mouse.up()
    expect(page.get_by_role("button", name="Draw a bound").first).to_have_attribute(
        "aria-pressed", "false"
    )
    assert goals_of(dashboard) == {}


def test_a_line_follows_the_hand_and_is_one_edit(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"goals": {"near": NEAR}, **SHORT})
    open_response(page, dashboard)
    line = grip(page, "value")
    start = middle(line)
    assert start[1] == pytest.approx(at(page, 1, 1.0, NEAR["bound"])[1], abs=1.5)
    press_and_move(page, start, (start[0], at(page, 1, 1.0, 0.03)[1]))
    # Before the hand lets go.
    until(dashboard, lambda goals: goals["near"]["bound"] == pytest.approx(0.03, rel=0.07))
    expect(page.locator(".bound-label")).to_contain_text("|e₂| ≤ 0.0")
    page.mouse.up()
    settled(page, dashboard)
    bound = goals_of(dashboard)["near"]["bound"]
    assert bound == float(f"{bound:.3g}")
    expect(page.locator(".bound-label")).to_be_hidden()
    assert middle(line)[1] == pytest.approx(at(page, 1, 1.0, bound)[1], abs=1.5)
    page.keyboard.press("Control+z")
    until(dashboard, lambda goals: goals["near"]["bound"] == NEAR["bound"])
    expect(page.get_by_role("button", name="Undo")).to_be_disabled()


def test_escape_takes_a_drag_back(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"goals": {"near": NEAR}, **SHORT})
    open_response(page, dashboard)
    start = middle(grip(page, "value"))
    press_and_move(page, start, (start[0], start[1] + 15))
    until(dashboard, lambda goals: goals["near"]["bound"] < NEAR["bound"])
    page.keyboard.press("Escape")
    until(dashboard, lambda goals: goals["near"]["bound"] == NEAR["bound"])
    page.mouse.move(start[0], start[1] + 30)
    page.mouse.up()
    assert goals_of(dashboard)["near"]["bound"] == NEAR["bound"]
    expect(page.get_by_role("button", name="Undo")).to_be_disabled()


def test_both_ends_of_a_line_are_dragged(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"goals": {"near": NEAR}, **SHORT})
    open_response(page, dashboard)
    for part, moment in (("start", 0.8), ("end", 1.2)):
        place = middle(grip(page, part))
        press_and_move(page, place, (at(page, 1, moment, 0.0)[0], place[1] + 4))
        page.mouse.up()
        goals = until(
            dashboard,
            lambda goals, part=part, to=moment: goals["near"][part] == pytest.approx(to, abs=PIXEL),
        )
        assert goals["near"]["bound"] == NEAR["bound"]
        settled(page, dashboard)
    # The end stays after the beginning; at the edge it is the end of whatever horizon.
    place = middle(grip(page, "end"))
    press_and_move(page, place, (at(page, 1, 0.3, 0.0)[0], place[1]))
    until(dashboard, lambda goals: goals["near"]["start"] < goals["near"]["end"] < 0.85)
    page.mouse.move(at(page, 1, HORIZON, 0.0)[0] + 30, place[1])
    page.mouse.up()
    until(dashboard, lambda goals: goals["near"]["end"] == 120)


@pytest.mark.parametrize("bound", [0.02, 0.05, 9.0])
def test_what_is_red_is_where_lanes_leave_the_bound(
    page: Page, dashboard: Dashboard, bound: float
) -> None:
    patch(dashboard, {"goals": {"near": {**NEAR, "bound": bound}}, **SHORT})
    open_response(page, dashboard)
    total, kept = lanes_shaded(bound, dashboard)
    assert kept == (total == 0.0)
    line = page.locator(".bound-grip[data-part=value]").first
    expect(line).to_have_class(re.compile("is-kept" if kept else "is-missed"))
    spans = np.array(page.evaluate(SHADED)).reshape(-1, 2)
    assert np.sum(spans[:, 1] - spans[:, 0]) == pytest.approx(total, abs=0.02)
    assert np.all((spans >= NEAR["start"] - PIXEL) & (spans <= NEAR["end"] + PIXEL))


def test_a_bound_on_every_joint_is_red_where_a_joint_misses_it(
    page: Page, dashboard: Dashboard
) -> None:
    patch(dashboard, SHORT)
    run = simulate(Experiment.from_document(experiment(dashboard)), estimate=False)
    inside = [
        np.abs(lane.e[(lane.time >= NEAR["start"]) & (lane.time <= NEAR["end"])])
        for lane in run.lanes.values()
    ]
    greatest = np.max([np.max(error, axis=0) for error in inside], axis=0)[:3]
    bound = float(np.sqrt(np.min(greatest) * np.max(greatest)))
    patch(dashboard, {"goals": {"near": {**NEAR, "joint": 0, "bound": bound}}})
    open_response(page, dashboard)
    lines = page.locator(".bound-grip[data-goal=near][data-part=value]")
    expect(lines).to_have_count(6)
    for joint, error in enumerate(greatest):
        word = "is-missed" if error > bound else "is-kept"
        for sign in range(2):
            expect(lines.nth(2 * joint + sign)).to_have_class(re.compile(word))


def test_a_gain_that_changes_changes_the_colour(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"goals": {"near": {**NEAR, "bound": 0.04}}, **SHORT})
    open_response(page, dashboard)
    for lane in ("RBFNN-SMC", "NFTSM"):
        page.locator(".response .plots-lane").filter(has_text=lane).last.click()
    for gain, word in ((150, "is-kept"), (5, "is-missed"), (150, "is-kept")):
        patch(dashboard, {"lanes": {"RBFNN-NFTSM": {"k1": gain}}})
        run = simulate(Experiment.from_document(experiment(dashboard)), estimate=False)
        lane = run.lanes["RBFNN-NFTSM"]
        assert judge_goals(run.experiment.goals, lane, lane.metrics).met == (word == "is-kept")
        expect(grip(page, "value")).to_have_class(re.compile(word))
        settled(page, dashboard)
        shaded = page.locator(".bound-shading path")
        assert (shaded.count() > 0) == (word == "is-missed")


def test_without_goals_nothing_lies_over_the_plots(page: Page, dashboard: Dashboard) -> None:
    patch(dashboard, {"goals": {"near": NEAR}, **SHORT})
    open_response(page, dashboard)
    expect(grip(page, "value")).to_be_visible()
    patch(dashboard, {"goals": {"near": None}})
    settled(page, dashboard)
    expect(page.locator(".bound-grip, .bound-shading path")).to_have_count(0)


@pytest.mark.parametrize(
    ("values", "goal", "gap", "spans"),
    [
        ([0, 2, 0, -2, 0], {"bound": 1}, 0, [[0.5, 1.5], [2.5, 3.5]]),
        ([0, 2, 0, -2, 0], {"bound": 1}, 1, [[0.5, 3.5]]),
        ([0, 2, 0, -2, 0], {"bound": 1, "start": 1, "end": 3}, 0, [[1, 1.5], [2.5, 3]]),
        ([0, 1, -1, 0, 1], {"bound": 1}, 0, []),
        ([0, 0, 0, None, None], {"bound": 1, "end": 3.5}, 0, [[3, 3.5]]),
        ([0, 0, 0, None, None], {"bound": 1, "end": 2.5}, 0, []),
    ],
)
def test_a_bound_is_left_between_points_and_where_there_are_no_numbers_any_more(
    page: Page,
    dashboard: Dashboard,
    values: list[float | None],
    goal: dict[str, float],
    gap: float,
    spans: list[list[float]],
) -> None:
    page.goto(f"{dashboard.url}docs")
    found = page.evaluate(
        """async ([values, goal, gap]) => {
          const {violations} = await import('/static/bounds/violations.js');
          const numbers = values.map((value) => value ?? NaN);
          return violations(values.map((_, row) => row), numbers, goal, gap);
        }""",
        [values, goal, gap],
    )
    assert found == spans
