"""What the live plots and the response have in common, as their users and files know it."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard

CHOSEN = """() => Object.fromEntries(['plots', 'response'].flatMap((screen) => (
  ['view', 'joints'].map((what) => `${screen}.${what}`)
)).map((key) => [key, localStorage.getItem(`slidetune.${key}`)]))"""
ARRIVED = """(time) => {
  const {data} = document.querySelector('#plots .plots-graph');
  return Math.max(...data.map(({x}) => x.at(-1))) > time - 0.1;
}"""
"""A thinned curve may end a little before its last sample."""
SHOWS = """([graph, ends, slack]) => (
  graph.layout.xaxis.range.every((end, index) => Math.abs(end - ends[index]) < slack)
)"""
MOVES_ALONG = """() => {
  const {layout, data} = document.querySelector('#plots .plots-graph');
  const [from, to] = layout.xaxis.range;
  return to - from < 3 && data.some(({x}) => x?.length && x[x.length - 1] > to - 0.05);
}"""
"""The window is 2 s long, and full: it ends at the newest sample."""
TAKE_LONG = """() => {
  const {toImage} = window.Plotly;
  const time = async () => (await (await fetch('/api/session')).json()).time;
  window.Plotly.toImage = async (figure, how) => {
    window.shown = figure.layout.xaxis.range[1];
    while (await time() < window.shown + 0.5);
    return toImage(figure, how);
  };
}"""
"""Half a second passes while an image is made; when its axis ends is noted."""


def open_screen(page: Page, dashboard: Dashboard, screen: str) -> Locator:
    """Open the dashboard with one of the screens; return it once its curves are drawn."""
    page.goto(dashboard.url)
    page.locator(f"[data-view={screen}]").click()
    shown = page.locator("#plots .right-view:visible")
    expect(shown.locator("path.js-line").nth(8)).to_be_attached()
    return shown


def pressed(screen: Locator) -> str:
    """Return the joints whose buttons are pressed."""
    return "".join(screen.locator(".plots-toggle[aria-pressed=true]").all_inner_texts())


def download(page: Page, screen: Locator, what: str) -> str:
    """Return the name of the file."""
    screen.get_by_role("button", name="Download these plots").click()
    with page.expect_download() as saved:
        page.get_by_role("menuitem", name=re.compile(what)).click()
    return str(saved.value.suggested_filename)


def pause(page: Page, dashboard: Dashboard) -> float:
    """Pause the session; return its time in [s] once the page has drawn until then."""
    dashboard.client.post("/api/session/pause").raise_for_status()
    time = float(dashboard.client.get("/api/session").json()["time"])
    page.wait_for_function(ARRIVED, arg=time)
    return time


@pytest.mark.parametrize(("name", "key"), [("live", "plots"), ("response", "response")])
def test_each_screen_keeps_its_choices_under_names_of_its_own(
    page: Page, dashboard: Dashboard, name: str, key: str
) -> None:
    screen = open_screen(page, dashboard, name)
    screen.get_by_role("tab", name="Torque").click()
    screen.get_by_role("button", name="Joint 2").click()
    page.keyboard.press("6")
    assert pressed(screen) == "136"
    nothing = dict.fromkeys(("plots.view", "plots.joints", "response.view", "response.joints"))
    kept = {f"{key}.view": "torque", f"{key}.joints": "136"}
    assert page.evaluate(CHOSEN) == {**nothing, **kept}
    screen = open_screen(page, dashboard, name)
    expect(screen.get_by_role("tab", name="Torque")).to_have_attribute("aria-selected", "true")
    assert pressed(screen) == "136"


def test_files_are_named_after_what_they_show(page: Page, dashboard: Dashboard) -> None:
    screen = open_screen(page, dashboard, "live")
    time = pause(page, dashboard)
    for what, ending in (("PNG", "png"), ("SVG", "svg"), ("CSV", "csv")):
        name = download(page, screen, what)
        parts = re.fullmatch(rf"slidetune-error-(\d+\.\d\d)s\.{ending}", name)
        assert parts
        assert float(parts[1]) == pytest.approx(time, abs=0.2)
    screen = open_screen(page, dashboard, "response")
    revision = screen.locator(".response-status").get_attribute("data-response")
    screen.get_by_role("tab", name="Flange error").click()
    for what, ending in (("PNG", "png"), ("SVG", "svg"), ("CSV", "csv")):
        name = download(page, screen, what)
        assert name == f"slidetune-response-flange-error-rev{revision}.{ending}"


def test_an_image_is_named_after_the_moment_that_it_shows(page: Page, dashboard: Dashboard) -> None:
    screen = open_screen(page, dashboard, "live")
    screen.get_by_label("window").select_option("2")
    page.wait_for_function(MOVES_ALONG)
    page.evaluate(TAKE_LONG)
    name = download(page, screen, "PNG")
    assert name == f"slidetune-error-{page.evaluate('shown'):.2f}s.png"


@pytest.mark.parametrize("name", ["live", "response"])
def test_a_window_is_moved_magnified_and_let_go_with_keys(
    page: Page, dashboard: Dashboard, name: str
) -> None:
    screen = open_screen(page, dashboard, name)
    if name == "live":
        pause(page, dashboard)
    graph = screen.locator(".plots-graph")
    first, last = graph.evaluate("graph => graph.layout.xaxis.range")
    tenth = (last - first) / 10

    def becomes(start: float, end: float) -> None:
        page.wait_for_function(SHOWS, arg=[graph.element_handle(), [start, end], tenth / 5])

    screen.locator(".plots-stage").focus()
    page.keyboard.press("Shift+ArrowRight")
    becomes(first + tenth, last + tenth)
    page.keyboard.press("Shift+ArrowLeft")
    becomes(first, last)
    page.keyboard.press("Shift+ArrowUp")
    becomes(first + tenth, last - tenth)
    page.keyboard.press("Escape")
    becomes(first, last)
