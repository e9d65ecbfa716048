"""The dashboard under a finger, on a screen as small as a phone's."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from playwright.sync_api import CDPSession, Locator, Page, expect

from tests.browser.conftest import Dashboard

GAIN = "lanes.RBFNN-NFTSM.c"
SCROLLED = "() => document.getElementById('tune').scrollTop"

Point = tuple[float, float]


@pytest.fixture(scope="module")
def window() -> dict[str, Any]:
    return {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}


@pytest.fixture
def phone(page: Page, dashboard: Dashboard) -> Page:
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    # The remarks come later, and would move the sliders away under a finger.
    expect(page.get_by_text("On the surface the error").first).to_be_visible()
    slider(page).scroll_into_view_if_needed()
    return page


def slider(page: Page) -> Locator:
    return page.locator(f"[data-path='{GAIN}'] .slider").first


def gain(dashboard: Dashboard) -> float:
    lanes = dashboard.client.get("/api/experiment").json()["experiment"]["lanes"]
    return float(lanes["RBFNN-NFTSM"]["c"])


def revision(dashboard: Dashboard) -> int:
    return int(dashboard.client.get("/api/experiment").json()["revision"])


def until_gain(dashboard: Dashboard, least: float, greatest: float) -> None:
    deadline = time.monotonic() + 60.0
    while not least < gain(dashboard) < greatest:
        assert time.monotonic() < deadline, gain(dashboard)
        time.sleep(0.05)


def along(page: Page, share: float, down: float = 0.0) -> Point:
    """Return a point of the slider's track, or so many pixels below."""
    box = slider(page).bounding_box()
    assert box is not None
    return box["x"] + share * box["width"], box["y"] + box["height"] / 2 + down


@contextmanager
def swiped(page: Page, start: Point, end: Point) -> Iterator[None]:
    """Move one finger in a straight line; it is lifted after what is done inside."""
    finger: CDPSession = page.context.new_cdp_session(page)

    def touch(kind: str, *points: Point) -> None:
        places = [{"x": x, "y": y} for x, y in points]
        finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    touch("touchStart", start)
    for step in range(1, 21):
        share = step / 20
        touch(
            "touchMove",
            *[(start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))],
        )
    yield
    touch("touchEnd")


def swipe(page: Page, start: Point, end: Point) -> None:
    with swiped(page, start, end):
        pass


def until(page: Page, done: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + 60.0
    while not done():
        assert time.monotonic() < deadline, what
        page.wait_for_timeout(50)


def test_a_finger_drags_a_slider_and_the_page_stays(phone: Page, dashboard: Dashboard) -> None:
    before = phone.evaluate(SCROLLED)
    swipe(phone, along(phone, 0.7), along(phone, 0.3, down=30))
    # The track has the logarithm of 0.05 to 50 along it.
    until_gain(dashboard, 0.3, 0.5)
    assert phone.evaluate(SCROLLED) == before
    x, y = along(phone, 0.6)
    phone.touchscreen.tap(x, y)
    until_gain(dashboard, 2.5, 4.0)


def test_a_finger_that_scrolls_over_a_slider_sets_nothing(
    phone: Page, dashboard: Dashboard
) -> None:
    first = revision(dashboard)
    before = phone.evaluate(SCROLLED)
    swipe(phone, along(phone, 0.2), along(phone, 0.2, down=-250))
    phone.wait_for_function(f"before => ({SCROLLED})() > before + 100", arg=before)
    box = phone.locator(f"[data-path='{GAIN}'] .number-box").first
    expect(box).to_have_value("10")
    # Anything sent before has arrived by now.
    box.fill("9")
    box.press("Enter")
    until_gain(dashboard, 8.9, 9.1)
    assert revision(dashboard) == first + 1


def test_what_a_dragged_slider_does_is_in_sight_above_it(phone: Page, dashboard: Dashboard) -> None:
    asked: list[str] = []
    phone.on("request", lambda r: asked.append(r.url) if r.url.endswith("/preview") else None)
    strip, lines = phone.locator(".strip"), phone.locator(".strip-line")
    mean, change = strip.locator("dd").first, strip.locator(".response-change").first
    empty = strip.bounding_box()
    # The first response waits until the server's processes for such runs have started.
    expect(lines).to_have_count(3, timeout=60_000)
    # Nothing below it has moved away under the finger.
    assert strip.bounding_box() == empty
    before = mean.inner_text()
    drawn = lines.first.get_attribute("d")
    with swiped(phone, along(phone, 0.7), along(phone, 0.3)):
        until(phone, lambda: mean.inner_text() != before, "the figures stand still")
        expect(change).to_have_text(re.compile("better|worse"))
        expect(phone.locator(".strip-line.is-before")).to_have_count(1)
        until(phone, lambda: lines.last.get_attribute("d") != drawn, "the curves stand still")
        for part in (strip, slider(phone)):
            expect(part).to_be_in_viewport(ratio=1)
    until_gain(dashboard, 0.3, 0.5)
    for width, height in ((820, 1180), (390, 844)):
        phone.set_viewport_size({"width": width, "height": height})
        place = strip.bounding_box()
        assert place is not None
        assert 100 < place["height"] <= height / 4
        assert strip.evaluate("one => one.scrollHeight <= one.clientHeight")

    # It is the response of the plots, run once for both.
    status = phone.locator(".response-status")
    until(
        phone,
        lambda: (
            status.get_attribute("data-estimated") == "true"
            and status.get_attribute("data-response") == str(revision(dashboard))
        ),
        "no response with its estimate",
    )
    runs = len(asked)
    label = strip.locator("dt").first.inner_text()
    value = mean.inner_text().split()[0]
    strip.tap()
    expect(phone.get_by_role("tab", name="Response")).to_be_focused()
    joint = phone.locator(f".response-table .metrics-mae{label[-1]}").first
    expect(joint).to_have_text(value)
    assert len(asked) == runs
    expect(strip).to_be_hidden()


def test_every_tab_is_under_the_thumb_and_shows_its_part(phone: Page) -> None:
    for part in ("scene", "plots", "metrics", "tune"):
        tab = phone.locator(f"#tabs [data-tab={part}]")
        place = tab.bounding_box()
        assert place is not None
        assert min(place["width"], place["height"]) >= 44
        tab.tap()
        expect(tab).to_have_attribute("aria-selected", "true")
        expect(phone.locator(f"#{part}")).to_be_visible()
        assert phone.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_lesson_leaves_three_joints_and_their_time_axis_in_sight(phone: Page) -> None:
    phone.keyboard.press("l")
    phone.locator("[data-lesson=chattering]").click()
    expect(phone.locator(".lesson-title small")).to_contain_text("Step 1 of")
    stage = phone.locator("#plots .plots-stage").first
    expect(stage.locator(".ylines-above")).to_have_count(3)
    axis = stage.locator(".xtitle").first
    expect(axis).to_have_text("t [s]")
    parts = (stage, axis, phone.locator(".lesson").first)
    # A plot that is drawn anew has no axis for a moment.
    places: list[Any] = []

    def drawn() -> bool:
        places[:] = [part.bounding_box() for part in parts]
        return all(places)

    until(phone, drawn, "not all of it is drawn")
    box, title, lesson = places
    assert title["y"] + title["height"] <= box["y"] + box["height"] + 1
    assert box["y"] + box["height"] <= lesson["y"]
    assert stage.evaluate("one => one.scrollHeight <= one.clientHeight")
    # There is still enough of the lesson to read.
    assert phone.locator(".lesson-body").evaluate("one => one.clientHeight") > 150
    sideways = "one => one.scrollWidth <= one.clientWidth"
    assert phone.locator(".lesson-body").evaluate(sideways)
