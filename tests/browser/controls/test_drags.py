"""A slider in the hand: what else changes its value ends the drag, and Escape takes it back."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard
from tests.browser.controls.test_controls import PROPOSED, box, control, gain, until_gains

PATH = f"lanes.{PROPOSED}.nu"


@pytest.fixture
def screen(dashboard: Dashboard, page: Page) -> Page:
    dashboard.client.post("/api/session/pause").raise_for_status()
    page.goto(dashboard.url)
    expect(page.get_by_role("button", name=re.compile("Set ν = 3"))).to_be_visible()
    return page


def slider(page: Page) -> Locator:
    return control(page, PATH).locator(".control-input > .slider")


def mover(page: Page) -> Callable[[float], None]:
    """Return what moves the pointer to a share of the slider's track."""
    slider(page).scroll_into_view_if_needed()
    track = slider(page).bounding_box()
    assert track is not None
    return lambda share: page.mouse.move(
        track["x"] + track["width"] * share, track["y"] + track["height"] / 2
    )


def take(page: Page, dashboard: Dashboard) -> Callable[[float], None]:
    """Press the slider, move it, and wait until the server has the value; keep it pressed."""
    before = gain(dashboard, PROPOSED, "nu")
    to = mover(page)
    to(0.5)
    page.mouse.down()
    to(0.6)
    to(0.7)
    expect(box(page, PATH)).not_to_have_value(f"{before:g}")
    until_gains(dashboard, PROPOSED, nu=float(box(page, PATH).input_value()))
    return to


def expect_value(page: Page, value: str) -> None:
    expect(box(page, PATH)).to_have_value(value)
    expect(slider(page)).to_have_attribute("aria-valuetext", f"{value} 1/s")


def test_undo_ends_a_drag_and_the_hand_moves_nothing_until_it_lets_go(
    screen: Page, dashboard: Dashboard
) -> None:
    before = gain(dashboard, PROPOSED, "nu")
    to = take(screen, dashboard)
    screen.keyboard.press("Control+z")
    expect_value(screen, f"{before:g}")
    at = slider(screen).input_value()
    to(0.9)
    to(0.8)
    assert slider(screen).input_value() == at
    screen.mouse.up()
    expect_value(screen, f"{before:g}")
    assert gain(dashboard, PROPOSED, "nu") == before
    take(screen, dashboard)
    screen.mouse.up()
    assert gain(dashboard, PROPOSED, "nu") != before


def test_a_change_from_outside_ends_a_drag(screen: Page, dashboard: Dashboard) -> None:
    to = take(screen, dashboard)
    words = control(screen, PATH).locator(".heat-words")
    dashboard.client.patch("/api/experiment", json={"lanes": {PROPOSED: {"c": 11.0}}})
    expect(box(screen, f"lanes.{PROPOSED}.c")).to_have_value("11")
    to(0.75)
    until_gains(dashboard, PROPOSED, nu=float(box(screen, PATH).input_value()))
    dashboard.client.patch("/api/experiment", json={"lanes": {PROPOSED: {"nu": 50.0}}})
    expect_value(screen, "50")
    to(0.3)
    screen.mouse.up()
    expect_value(screen, "50")
    assert gain(dashboard, PROPOSED, "nu") == 50.0
    expect(words).to_be_visible()


def test_another_experiment_ends_a_drag(screen: Page, dashboard: Dashboard) -> None:
    to = take(screen, dashboard)
    dashboard.client.post("/api/presets/paper/load").raise_for_status()
    before = gain(dashboard, PROPOSED, "nu")
    expect_value(screen, f"{before:g}")
    to(0.9)
    screen.mouse.up()
    expect_value(screen, f"{before:g}")
    assert gain(dashboard, PROPOSED, "nu") == before


def test_escape_takes_a_drag_back_and_leaves_nothing_to_undo(
    screen: Page, dashboard: Dashboard
) -> None:
    before = gain(dashboard, PROPOSED, "nu")
    undo = screen.get_by_role("button", name=re.compile("^Undo"))
    expect(undo).to_be_disabled()
    to = take(screen, dashboard)
    screen.keyboard.press("Escape")
    expect_value(screen, f"{before:g}")
    to(0.9)
    screen.mouse.up()
    expect_value(screen, f"{before:g}")
    assert gain(dashboard, PROPOSED, "nu") == before
    expect(undo).to_be_disabled()


def test_a_lane_that_freezes_says_why_when_the_slider_is_let_go(
    screen: Page, dashboard: Dashboard
) -> None:
    take(screen, dashboard)
    where = slider(screen).bounding_box()
    late = {"simulation": {"mode": "sampled", "control_rate": 250}}
    dashboard.client.patch("/api/experiment", json=late).raise_for_status()
    dashboard.client.post("/api/session/play").raise_for_status()
    lane = screen.locator(f'.lane[data-lane="{PROPOSED}"]')
    expect(lane.locator(".lane-status")).to_have_text("frozen")
    expect(lane.locator(".lane-cause")).to_be_empty()
    assert slider(screen).bounding_box() == where
    screen.mouse.up()
    expect(lane.locator(".lane-cause")).to_contain_text("left its bounds")
