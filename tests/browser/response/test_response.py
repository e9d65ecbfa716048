"""The whole response: it follows a drag, is compared with baselines, and cursors read it."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from slidetune.robot.experiment.document import Experiment
from slidetune.robot.loop.simulate import Run, simulate
from tests.browser.conftest import Dashboard
from tests.browser.empty_scene import empty_scene

LANES = ("RBFNN-NFTSM", "RBFNN-SMC", "NFTSM")
MILLI = 1e3
COUNT_PREVIEWS = """
  const [ask, under] = [window.fetch, {way: 0}];
  window.mostPreviews = 0;
  window.fetch = async (address, options) => {
    if (!String(address).endsWith('/api/preview')) return ask(address, options);
    under.way += 1;
    window.mostPreviews = Math.max(window.mostPreviews, under.way);
    try {
      const answer = await ask(address, options);
      const bytes = await answer.arrayBuffer();
      return new Response(answer.status === 204 ? null : bytes, answer);
    } finally {
      under.way -= 1;
    }
  };
"""
"""Counts the most previews that the page has under way at once."""
KEEP_SHOWN = """
  seen => {
    window.shown = [];
    const keep = () => window.shown.push(seen.dataset.estimated ?? seen.textContent);
    const what = {attributeFilter: ['data-estimated'], characterData: true, childList: true};
    new MutationObserver(keep).observe(seen, {...what, subtree: true});
  }
"""
"""Keeps all that an element shows from now on: what a resting hand sees is soon replaced."""
AGREEMENT = 0.01
"""Greatest relative difference between a figure on the screen, which has three digits, and ours."""


def open_response(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    page.locator("[data-view=response]").click()
    until_estimated(page, dashboard)


def revision(dashboard: Dashboard) -> int:
    return int(dashboard.client.get("/api/experiment").json()["revision"])


def until_estimated(page: Page, dashboard: Dashboard) -> None:
    """Wait for the response of the newest revision with its estimate, drawn."""
    status = page.locator(".response-status")
    expect(status).to_have_attribute("data-estimated", "true", timeout=60_000)
    expect(status).to_have_attribute("data-response", str(revision(dashboard)))
    expect(lines_shown(page).nth(8)).to_be_attached()


def simulated(dashboard: Dashboard) -> Run:
    document = dashboard.client.get("/api/experiment").json()["experiment"]
    return simulate(Experiment.from_document(document))


def row(page: Page, lane: str, baseline: str = "") -> Locator:
    """Return a lane's row of figures, or that of one of its baselines."""
    head = page.locator(".response-lane").filter(has=page.get_by_text(lane, exact=True))
    rows = head.locator("xpath=ancestor::tbody/tr")
    return rows.filter(has_text=baseline) if baseline else rows.first


def figures(page: Page, lane: str, baseline: str = "") -> list[float]:
    """Return what the row shows, in its order; see ``expected_figures``."""
    cells = row(page, lane, baseline).locator("td:not(.metrics-estimate)").all_inner_texts()
    return [float(cell.split()[0].replace("−", "-")) for cell in cells]


def expected_figures(run: Run, lane: str) -> list[float]:
    metrics = run.lanes[lane].metrics
    return [
        *(metrics.mae[:3] * MILLI),
        metrics.max_error.max() * MILLI,
        metrics.chattering,
        metrics.switches.max(),
        metrics.high_frequency_torque or 0.0,
        metrics.peak_torque.max(),
        metrics.flange_rms * MILLI,
        metrics.rms_torque.max(),
        metrics.itae.max() * MILLI,
    ]


def lines_shown(page: Page) -> Locator:
    """Return the curves drawn, panel by panel, without those before the last change."""
    return page.locator(".response .trace:not([class*=tracebefore]) path.js-line")


def lines_before(page: Page) -> Locator:
    """Return the faint curves of before the last change, panel by panel."""
    return page.locator(".response .trace[class*=tracebefore] path.js-line")


def paths(lines: Locator) -> list[str]:
    found: list[str] = lines.evaluate_all("lines => lines.map(line => line.getAttribute('d'))")
    return found


def curves(page: Page) -> list[str]:
    """Return the paths drawn, panel by panel."""
    return paths(lines_shown(page))


def slider(page: Page, gain: str) -> Locator:
    return page.locator(f"[data-path='{gain}'] .slider").first


@contextmanager
def held(page: Page, gain: str) -> Iterator[None]:
    """Move a slider by hand; what is done inside is done before the hand lets go."""
    track = slider(page, gain).bounding_box()
    assert track is not None
    middle = track["y"] + track["height"] / 2
    page.mouse.move(track["x"] + track["width"] * 0.7, middle)
    page.mouse.down()
    for share in np.linspace(0.68, 0.4, 12):
        page.mouse.move(track["x"] + track["width"] * share, middle)
    yield
    page.mouse.up()


def until_shown(page: Page, text: str) -> None:
    """Wait until what KEEP_SHOWN watches has shown a text."""
    deadline = time.monotonic() + 60.0
    while text not in page.evaluate("window.shown"):
        assert time.monotonic() < deadline, f"never showed {text}"
        page.wait_for_timeout(50)


def type_in(page: Page, gain: str, value: str) -> None:
    box = page.locator(f"[data-path='{gain}'] .number-box").first
    box.fill(value)
    box.press("Enter")


def reading(page: Page, name: str) -> float:
    """Return t_A, t_B or Δt of the readout in [s]."""
    text = page.locator(f".cursor-readout:visible [data-name='{name}']").inner_text()
    return float(text.split()[-2].replace("−", "-"))


def stage_box(page: Page) -> tuple[float, float, float, float]:
    box = page.locator(".plots-stage:visible").bounding_box()
    assert box is not None
    return box["x"], box["y"], box["width"], box["height"]


@pytest.mark.fresh
def test_a_drag_redraws_the_whole_response_and_its_figures_agree_with_simulate(
    page: Page, dashboard: Dashboard
) -> None:
    page.add_init_script(COUNT_PREVIEWS)
    open_response(page, dashboard)
    run, before = simulated(dashboard), curves(page)
    assert len(before) == 3 * len(LANES)
    for lane in LANES:
        assert figures(page, lane) == pytest.approx(expected_figures(run, lane), rel=AGREEMENT)

    page.locator(".response-status").evaluate(KEEP_SHOWN)
    with held(page, "lanes.RBFNN-NFTSM.c"):
        until_shown(page, "false")
        expect(row(page, "RBFNN-NFTSM").locator(".metrics-mae1")).not_to_have_text(
            f"{expected_figures(run, 'RBFNN-NFTSM')[0]:.3g}"
        )
    until_estimated(page, dashboard)
    assert page.evaluate("() => window.mostPreviews") == 1
    moved = simulated(dashboard)
    for lane in LANES:
        assert figures(page, lane) == pytest.approx(expected_figures(moved, lane), rel=AGREEMENT)
    changed = [old != new for old, new in zip(before, curves(page), strict=True)]
    assert changed[0::3] == [True] * 3
    dashboard.client.patch("/api/experiment", json={"trajectory": {"amplitude": 0.5}})
    until_estimated(page, dashboard)
    smaller = simulated(dashboard)
    for lane in LANES:
        assert figures(page, lane) == pytest.approx(expected_figures(smaller, lane), rel=AGREEMENT)


def test_a_baseline_is_compared_in_words_and_survives_a_reload(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    before = figures(page, "RBFNN-NFTSM")
    page.get_by_role("button", name="Pin as baseline").click()
    name = page.get_by_role("textbox", name="Name of the baseline")
    name.fill("as published")
    name.press("Enter")
    expect(row(page, "NFTSM", "as published")).to_contain_text("same")
    type_in(page, "lanes.RBFNN-NFTSM.nu", "3")
    until_estimated(page, dashboard)
    compared = row(page, "RBFNN-NFTSM", "as published")
    expect(compared.locator(".metrics-mae1")).to_have_text(re.compile(r"▼ \d+ % better"))
    type_in(page, "lanes.RBFNN-NFTSM.nu", "0.1")
    until_estimated(page, dashboard)
    expect(compared.locator(".metrics-mae1")).to_have_text(re.compile(r"▲ .+ worse"))
    assert figures(page, "RBFNN-NFTSM", "as published") == before
    lines = lines_shown(page)
    expect(lines).to_have_count(3 * 2 * len(LANES))

    page.reload()
    until_estimated(page, dashboard)
    expect(page.get_by_role("textbox", name="Name of the baseline")).to_have_value("as published")
    expect(compared.locator(".metrics-mae1")).to_have_text(re.compile(r"▲ .+ worse"))
    assert figures(page, "RBFNN-NFTSM", "as published") == before
    page.get_by_role("button", name="Show as published").click()
    expect(lines).to_have_count(3 * len(LANES))
    expect(compared).to_have_count(0)
    page.get_by_role("button", name="Remove as published").click()
    page.reload()
    until_estimated(page, dashboard)
    expect(page.locator(".response-chip")).to_have_count(0)


def names(page: Page) -> list[str]:
    """Return the names of the baselines on a page."""
    boxes = page.get_by_role("textbox", name="Name of the baseline")
    found: list[str] = boxes.evaluate_all("boxes => boxes.map(box => box.value)")
    return found


def until_names(pages: list[Page], wanted: list[str]) -> None:
    deadline = time.monotonic() + 60.0
    while any(names(page) != wanted for page in pages):
        assert time.monotonic() < deadline, [names(page) for page in pages]
        pages[0].wait_for_timeout(50)


def test_two_pages_keep_each_other_s_baselines(
    context: BrowserContext, page: Page, dashboard: Dashboard
) -> None:
    pages = [page, context.new_page()]
    empty_scene(pages[1])
    for each in pages:
        open_response(each, dashboard)
    for each in pages:
        each.get_by_role("button", name="Pin as baseline").click()
    until_names(pages, ["Baseline 1", "Baseline 2"])
    for each in pages:
        expect(row(each, "NFTSM", "Baseline 2")).to_contain_text("same")
        expect(row(each, "NFTSM", "Baseline 1")).to_contain_text("same")
    first = page.get_by_role("textbox", name="Name of the baseline").first
    first.fill("before")
    first.press("Enter")
    until_names(pages, ["before", "Baseline 2"])
    pages[1].get_by_role("button", name="Show before").click()
    expect(row(pages[1], "NFTSM", "before")).to_have_count(0)
    expect(row(page, "NFTSM", "before")).to_have_count(1)
    pages[1].get_by_role("button", name="Remove Baseline 2").click()
    until_names(pages, ["before"])
    pages[1].reload()
    until_names(pages, ["before"])


def test_cursors_read_times_values_and_differences(page: Page, dashboard: Dashboard) -> None:
    open_response(page, dashboard)
    left, top, width, height = stage_box(page)
    page.mouse.move(left + 0.4 * width, top + 0.3 * height)
    page.keyboard.press("a")
    page.mouse.move(left + 0.8 * width, top + 0.3 * height)
    page.keyboard.press("b")
    a, b = reading(page, "t_A"), reading(page, "t_B")
    assert 0.0 < a < b < 10.0
    assert reading(page, "Δt") == pytest.approx(b - a, abs=1.1e-4)
    run = simulated(dashboard)
    errors = run.lanes["RBFNN-NFTSM"].e[:, 0]
    at_a, at_b = np.interp([a, b], run.time, errors)
    cells = page.locator(".cursor-readout:visible tbody tr").first.locator("td").all_inner_texts()
    seen = [float(cell.replace("−", "-")) for cell in cells[:3]]
    assert seen == pytest.approx([at_a, at_b, at_b - at_a], abs=0.01 * np.ptp(errors))

    second = page.get_by_role("slider", name="Cursor B")
    expect(second).to_be_focused()
    page.keyboard.press("ArrowLeft")
    assert a < reading(page, "t_B") < b
    handle = page.get_by_role("slider", name="Cursor A").bounding_box()
    assert handle is not None
    page.mouse.move(handle["x"] + handle["width"] / 2, handle["y"] + 8)
    page.mouse.down()
    page.mouse.move(left + 0.6 * width, top + 40)
    page.mouse.up()
    assert a < reading(page, "t_A") < b
    page.keyboard.press("Escape")
    expect(page.locator(".cursor-readout:visible")).to_have_count(0)
    expect(page.locator(".cursor:visible")).to_have_count(0)


def test_cursors_stand_in_the_live_plots_too(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    expect(page.locator("#plots path.js-line").nth(8)).to_be_attached()
    page.keyboard.press("a")
    page.keyboard.press("b")
    expect(page.locator(".cursor:visible")).to_have_count(2)
    between = reading(page, "t_B") - reading(page, "t_A")
    assert reading(page, "Δt") == pytest.approx(between, abs=1.1e-4)
    rows = page.locator(".cursor-readout:visible tbody tr")
    expect(rows).to_have_count(3 * len(LANES))
    expect(rows.first.locator("td").first).to_have_text(re.compile(r"\d"), timeout=60_000)


def test_nobody_pays_for_a_response_that_is_not_seen(page: Page, dashboard: Dashboard) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(dashboard.url)
    expect(page.locator("#plots path.js-line").nth(8)).to_be_attached()
    tab = page.locator("[data-view=response]")
    type_in(page, "lanes.RBFNN-NFTSM.nu", "3")
    expect(tab).to_contain_text("changed")
    expect(tab).to_have_attribute("aria-selected", "false")
    assert not [url for url in asked if url.endswith("/api/preview")]
    tab.click()
    until_estimated(page, dashboard)
    expect(tab).not_to_contain_text("changed")
    page.get_by_role("switch", name="open on drag").check()
    page.locator("[data-view=live]").click()
    type_in(page, "lanes.RBFNN-NFTSM.nu", "1")
    expect(tab).to_have_attribute("aria-selected", "true")


def test_the_present_is_solid_and_what_it_is_compared_with_dashed(
    page: Page, dashboard: Dashboard
) -> None:
    open_response(page, dashboard)
    page.get_by_role("button", name="Pin as baseline").click()
    type_in(page, "lanes.RBFNN-NFTSM.nu", "3")
    until_estimated(page, dashboard)
    lines = lines_shown(page)
    expect(lines).to_have_count(2 * 3 * len(LANES))
    look = "lines => lines.map(line => getComputedStyle(line).strokeDasharray)"
    dashes = lines.evaluate_all(look)
    # Panel by panel: baselines first, below.
    panel = ["6px, 4px"] * len(LANES) + ["none"] * len(LANES)
    assert dashes == 3 * panel


def test_a_diverged_lane_says_when_where_and_why(page: Page, dashboard: Dashboard) -> None:
    open_response(page, dashboard)
    dashboard.client.patch("/api/experiment", json={"simulation": {"mode": "sampled"}})
    told = page.locator(".response-remarks .is-frozen")
    expect(told).to_have_count(len(LANES))
    words = re.compile(r"RBFNN-NFTSM.*Joint \d left its bounds .* at 0\.0\d+ s")
    expect(told.first).to_contain_text(words)
    expect(row(page, "RBFNN-NFTSM")).to_contain_text("diverged")
    deadline = time.monotonic() + 60.0
    while page.locator(".response .scatterlayer path.point").count() < 3 * len(LANES):
        assert time.monotonic() < deadline, "no crosses where the lanes stopped"
        page.wait_for_timeout(100)
