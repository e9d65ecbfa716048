"""Which knob, which way: strips, ranking, remarks, edits and branches on the screen."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from tests.browser.conftest import Dashboard

PROPOSED = "RBFNN-NFTSM"
SLOW = 60_000
"""Longest that a study may take in milliseconds, on a machine with other things to do."""


@pytest.fixture
def screen(dashboard: Dashboard, page: Page) -> Page:
    """The dashboard with runs of one second, so that a study is short."""
    change(dashboard, {"simulation": {"horizon": 1.0}})
    page.goto(dashboard.url)
    expect(page.locator(".knob-tools")).to_be_visible(timeout=SLOW)
    # The remarks come later, and would move the sliders away under a pointer.
    expect(page.get_by_role("button", name="Set ν = 30")).to_be_visible()
    return page


def change(dashboard: Dashboard, patch: dict[str, Any]) -> None:
    answer = dashboard.client.patch("/api/experiment", json=patch)
    assert answer.status_code == 200, answer.text


def experiment(dashboard: Dashboard) -> dict[str, Any]:
    document: dict[str, Any] = dashboard.client.get("/api/experiment").json()["experiment"]
    return document


def control(page: Page, path: str) -> Locator:
    return page.locator(f'.control[data-path="{path}"]')


def box(page: Page, path: str) -> Locator:
    return control(page, path).locator(".control-input > .number-box")


def slider(page: Page, path: str) -> Locator:
    return control(page, path).locator(".control-input > .slider")


def select(page: Page, lane: str) -> None:
    page.locator(f'.lane[data-lane="{lane}"] .lane-pick').click()
    expect(page.locator(".gains-head h2")).to_have_text(lane)


def study(dashboard: Dashboard, kind: str, **body: Any) -> list[dict[str, Any]]:
    answer = dashboard.client.post(f"/api/studies/{kind}", json=body, timeout=SLOW / 1000)
    assert answer.status_code == 200, answer.text
    return [json.loads(line) for line in answer.text.splitlines()]


def test_a_strip_lies_along_the_track_and_names_the_best_position(
    dashboard: Dashboard, screen: Page
) -> None:
    select(screen, "NFTSM")
    path = "lanes.NFTSM.c"
    slider(screen, path).hover()
    words = control(screen, path).locator(".heat-best")
    expect(words).to_contain_text("best near", timeout=SLOW)
    rows = study(dashboard, "strip", lane="NFTSM", field="c", count=20)
    best = min((row for row in rows if row["state"] == "good"), key=lambda row: row["mae"])
    shown = re.fullmatch(r"best near (\S+): (\S+) mrad", words.inner_text())
    assert shown is not None
    assert float(shown[1]) == float(f"{best['value']:.2g}")
    assert float(shown[2]) == float(f"{1000 * best['mae']:.3g}")
    strip = control(screen, path).locator(".heat-strip").bounding_box()
    track = slider(screen, path).bounding_box()
    assert strip is not None
    assert track is not None
    assert strip["x"] == pytest.approx(track["x"], abs=1.0)
    assert strip["width"] == pytest.approx(track["width"], abs=1.0)


def test_a_strip_leaves_with_the_pointer_and_comes_with_the_keyboard(screen: Page) -> None:
    path = f"lanes.{PROPOSED}.mu"
    slider(screen, path).hover()
    strip = control(screen, path).locator(".heat-strip")
    expect(strip).to_be_visible(timeout=SLOW)
    screen.mouse.move(2, 2)
    expect(strip).to_have_count(0)
    box(screen, f"lanes.{PROPOSED}.c").focus()
    for _ in range(4):
        if slider(screen, path).evaluate("node => node === document.activeElement"):
            break
        screen.keyboard.press("Tab")
    aloud = control(screen, path).locator(".control-input [role=status]")
    expect(aloud).to_contain_text(re.compile("best near|no effect"), timeout=SLOW)


def test_a_strip_of_another_experiment_is_not_shown(dashboard: Dashboard, screen: Page) -> None:
    path = f"lanes.{PROPOSED}.c"
    slider(screen, path).hover()
    words = control(screen, path).locator(".heat-best")
    expect(words).to_contain_text("best near", timeout=SLOW)
    before = words.inner_text()
    change(dashboard, {"lanes": {PROPOSED: {"k1": 300.0}}})
    expect(words).not_to_have_text(before)
    expect(words).to_contain_text("best near", timeout=SLOW)


def test_a_pressed_slider_has_its_strip_at_once_and_keeps_it_while_it_is_moved(
    dashboard: Dashboard, screen: Page
) -> None:
    path = f"lanes.{PROPOSED}.c"
    change(dashboard, {"lanes": {PROPOSED: {"k1": 310.0}}})
    studies: list[str] = []
    screen.on("request", lambda r: studies.append(r.url) if "/api/studies" in r.url else None)
    track = slider(screen, path).bounding_box()
    assert track is not None
    middle = track["y"] + track["height"] / 2
    screen.mouse.move(track["x"] + 0.5 * track["width"], middle)
    screen.mouse.down()
    strip = control(screen, path).locator(".heat-strip")
    words = control(screen, path).locator(".heat-best")
    expect(strip).to_have_count(1)
    expect(words).to_contain_text("best near", timeout=SLOW)
    known = words.inner_text()
    asked = len(studies)
    before = experiment(dashboard)["lanes"][PROPOSED]["c"]
    for share in (0.55, 0.6, 0.65, 0.7):
        screen.mouse.move(track["x"] + share * track["width"], middle)
        expect(words).to_have_text(known)
    screen.mouse.up()
    expect(words).to_have_text(known)
    assert len(studies) == asked
    assert experiment(dashboard)["lanes"][PROPOSED]["c"] != before


def test_a_strip_s_runs_wait_while_its_slider_is_moved(dashboard: Dashboard, screen: Page) -> None:
    path = f"lanes.{PROPOSED}.c"
    waiting: list[Route] = []
    given_up: list[str] = []
    released: list[bool] = []
    screen.route(
        "**/api/studies/strip",
        lambda route: route.continue_() if released else waiting.append(route),
    )
    screen.on("requestfailed", lambda r: given_up.append(r.url) if "/strip" in r.url else None)
    track = slider(screen, path).bounding_box()
    assert track is not None
    middle = track["y"] + track["height"] / 2
    screen.mouse.move(track["x"] + 0.5 * track["width"], middle)
    screen.mouse.down()
    until(screen, lambda: bool(waiting), "no runs begin when the slider is pressed")
    for share in (0.55, 0.6, 0.65):
        screen.mouse.move(track["x"] + share * track["width"], middle)
    until(screen, lambda: bool(given_up), "the runs go on while the slider is moved")
    released.append(True)
    words = control(screen, path).locator(".heat-best")
    expect(words).to_contain_text("best near", timeout=SLOW)
    screen.mouse.up()


def until(page: Page, done: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + 60.0
    while not done():
        assert time.monotonic() < deadline, what
        page.wait_for_timeout(20)


def test_a_joint_has_a_strip_of_its_own_share(dashboard: Dashboard, screen: Page) -> None:
    path = f"lanes.{PROPOSED}.nu"
    nu = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    change(dashboard, {"lanes": {PROPOSED: {"nu": nu}}})
    control(screen, path).locator(".disclosure").click()
    second = control(screen, path).locator(".joint-row").nth(1)
    second.locator(".slider").hover()
    words = second.locator(".heat-words")
    expect(words).to_contain_text("ν of J2", timeout=SLOW)
    expect(second.locator(".heat-best")).to_contain_text(
        re.compile("best near|no effect"), timeout=SLOW
    )
    rows = study(dashboard, "strip", lane=PROPOSED, field="nu", count=20, joint=2)
    best = min((row for row in rows if row["state"] == "good"), key=lambda row: row["mae"])
    shown = re.search(r"([\d.]+) mrad$", second.locator(".heat-best").inner_text())
    assert shown is not None
    assert float(shown[1]) == float(f"{1000 * best['mae']:.3g}")
    assert experiment(dashboard)["lanes"][PROPOSED]["nu"] == nu

    # Another joint's share is part of what this strip depends on, its own isn't.
    before = second.locator(".heat-best").inner_text()
    change(dashboard, {"lanes": {PROPOSED: {"nu": [20.0, *nu[1:]]}}})
    expect(second.locator(".heat-best")).not_to_have_text(before)
    screen.mouse.move(2, 2)
    expect(second.locator(".heat-strip")).to_have_count(0)
    third = control(screen, path).locator(".joint-row").nth(2)
    second.locator(".number-box").focus()
    screen.keyboard.press("Tab")
    expect(third.locator(".slider")).to_be_focused()
    expect(third.locator("[role=status]")).to_contain_text(
        re.compile("best near|no effect"), timeout=SLOW
    )


def test_gains_of_six_have_bars_that_set_all_six(dashboard: Dashboard, screen: Page) -> None:
    nu = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    change(dashboard, {"lanes": {PROPOSED: {"nu": nu}}})
    screen.get_by_role("button", name="Which knob next?").click()
    expect(screen.locator(".tornado-progress")).to_be_hidden(timeout=SLOW)
    up = screen.get_by_role("button", name=re.compile(r"^Error gain \+10 %, to 1.1, 2.2, 3.3, …"))
    up.click()
    expect(control(screen, f"lanes.{PROPOSED}.nu").locator(".joint-values")).to_contain_text("6.6")
    taken = experiment(dashboard)["lanes"][PROPOSED]["nu"]
    assert taken == pytest.approx([1.1 * value for value in nu])


def test_a_bar_moves_its_slider_and_undo_brings_it_back(dashboard: Dashboard, screen: Page) -> None:
    screen.get_by_role("button", name="Which knob next?").click()
    up = screen.get_by_role("button", name=re.compile(r"^Velocity gain \+10 %"))
    down = screen.get_by_role("button", name=re.compile(r"^Velocity gain −10 %"))
    expect(screen.locator(".tornado-progress")).to_be_hidden(timeout=SLOW)
    rows = study(dashboard, "sensitivity", lane=PROPOSED)
    effects = {row["factor"]: row["mae"] / rows[0]["mae"] - 1 for row in rows if row["name"] == "c"}
    for bar, factor in ((up, 1.1), (down, 0.9)):
        words = bar.locator(".tornado-words").inner_text().replace("−", "-")
        shown = float(words.removeprefix("MAE ").removesuffix(" %"))
        assert shown == pytest.approx(100 * effects[factor], abs=0.06 + 0.05 * abs(shown))
    up.click()
    expect(box(screen, f"lanes.{PROPOSED}.c")).to_have_value("11")
    assert experiment(dashboard)["lanes"][PROPOSED]["c"] == pytest.approx(11.0)
    expect(screen.locator(".tornado-stale")).to_contain_text("has changed")
    screen.get_by_role("button", name="Undo").click()
    expect(box(screen, f"lanes.{PROPOSED}.c")).to_have_value("10")


def test_a_remark_stands_at_its_control_and_its_button_sets_the_value(
    dashboard: Dashboard, screen: Page
) -> None:
    remark = control(screen, f"lanes.{PROPOSED}.nu").locator(".advice")
    expect(remark).to_contain_text("c/ν = 33.3 s")
    remark.get_by_role("button", name="Set ν = 30").click()
    expect(box(screen, f"lanes.{PROPOSED}.nu")).to_have_value("30")
    assert experiment(dashboard)["lanes"][PROPOSED]["nu"] == 30.0
    expect(remark).to_have_count(0)
    screen.get_by_role("button", name="Undo").click()
    expect(box(screen, f"lanes.{PROPOSED}.nu")).to_have_value("0.3")
    expect(remark).to_be_visible()


def test_remarks_on_other_lanes_are_a_badge_in_the_list(screen: Page) -> None:
    badge = screen.locator('.lane[data-lane="NFTSM"] .advice-badge')
    expect(badge).to_have_attribute("title", re.compile("c/ν"))
    expect(screen.locator(f'.lane[data-lane="{PROPOSED}"] .advice-badge')).to_have_count(0)
    select(screen, "NFTSM")
    expect(badge).to_have_count(0)
    expect(control(screen, "lanes.NFTSM.nu").locator(".advice")).to_be_visible()


def test_edits_are_listed_with_their_author_and_can_be_gone_back_to(
    dashboard: Dashboard, screen: Page
) -> None:
    box(screen, f"lanes.{PROPOSED}.c").fill("7")
    box(screen, f"lanes.{PROPOSED}.c").press("Tab")
    expect(screen.get_by_role("button", name="Undo")).to_be_enabled()
    screen.keyboard.press("h")
    first = screen.locator(".edits-item").first
    expect(first).to_contain_text(re.compile(r"you.*c of RBFNN-NFTSM 10 → 7", re.DOTALL))
    change(dashboard, {"lanes": {PROPOSED: {"nu": 3.0}}})
    expect(first).to_contain_text(re.compile(r"a program.*ν of RBFNN-NFTSM 0.3 → 3", re.DOTALL))
    screen.get_by_role("button", name="Back to here").first.click()
    expect(box(screen, f"lanes.{PROPOSED}.nu")).to_have_value("0.3")
    expect(box(screen, f"lanes.{PROPOSED}.c")).to_have_value("7")
    expect(first).to_contain_text("you")
    screen.keyboard.press("Escape")
    expect(screen.locator(".edits")).to_be_hidden()
    screen.get_by_role("button", name="Undo").click()
    expect(box(screen, f"lanes.{PROPOSED}.nu")).to_have_value("3")


def test_looking_back_pauses_and_the_way_back_plays_on(screen: Page) -> None:
    screen.get_by_role("button", name="Past").click()
    moment = screen.get_by_label("Moment to look at")
    expect(moment).to_be_enabled()
    moment.focus()
    moment.press("Home")
    expect(screen.locator(".scrub-ago")).to_contain_text("s ago")
    expect(screen.get_by_role("button", name="Play", exact=True)).to_be_visible()
    screen.get_by_role("button", name="Back to now").click()
    expect(screen.locator(".scrub-ago")).to_have_text("now")
    expect(screen.get_by_role("button", name="Pause", exact=True)).to_be_visible()


def test_a_fork_adds_a_lane_and_selects_it(dashboard: Dashboard, screen: Page) -> None:
    screen.get_by_role("button", name="Past").click()
    moment = screen.get_by_label("Moment to look at")
    expect(moment).to_be_enabled()
    moment.focus()
    moment.press("Home")
    screen.get_by_role("button", name="Fork here").click()
    screen.get_by_label("Name of the lane").fill("Variant")
    screen.get_by_role("button", name="Fork", exact=True).click()
    expect(screen.locator(".gains-head h2")).to_contain_text("Variant")
    lanes = experiment(dashboard)["lanes"]
    assert lanes["Variant"] == lanes[PROPOSED]
    expect(screen.locator(".scrub")).to_be_hidden()
    expect(screen.get_by_role("button", name="Pause", exact=True)).to_be_visible()
    screen.get_by_role("button", name="Undo").click()
    expect(screen.locator(".lane")).to_have_count(3)


def test_the_ranking_keeps_its_height_when_a_slider_below_it_is_dragged(screen: Page) -> None:
    screen.get_by_role("button", name="Which knob next?").click()
    card = screen.locator(".tornado")
    again = card.get_by_role("button", name="Try again")
    expect(card.locator(".tornado-idle")).not_to_be_empty(timeout=SLOW)
    expect(again).to_be_hidden()
    dragged = slider(screen, f"lanes.{PROPOSED}.nu")
    dragged.scroll_into_view_if_needed()
    track = dragged.bounding_box()
    assert track is not None
    screen.mouse.move(track["x"] + track["width"] * 0.4, track["y"] + track["height"] / 2)
    screen.mouse.down()
    screen.mouse.move(track["x"] + track["width"] * 0.6, track["y"] + track["height"] / 2)
    expect(again).to_be_visible()
    assert dragged.bounding_box() == track
    screen.mouse.up()
    expect(control(screen, f"lanes.{PROPOSED}.nu")).to_have_class(re.compile("is-changed"))
    assert dragged.bounding_box() == track
