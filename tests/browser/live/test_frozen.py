"""A lane that left its bounds: when it did stands in the plots, and it can be reset by itself."""

from __future__ import annotations

import re
import time
from typing import Any

from playwright.sync_api import Page, expect

from tests.browser.conftest import Dashboard

LANES = ("RBFNN-NFTSM", "RBFNN-SMC", "NFTSM")


def simulate(dashboard: Dashboard, **simulation: Any) -> None:
    dashboard.client.patch("/api/experiment", json={"simulation": simulation}).raise_for_status()


def state(dashboard: Dashboard) -> dict[str, Any]:
    session: dict[str, Any] = dashboard.client.get("/api/session").json()
    return session


def until(dashboard: Dashboard, lane: str, status: str) -> dict[str, Any]:
    end = time.monotonic() + 60.0
    while (found := state(dashboard)["lanes"][lane])["status"] != status:
        assert time.monotonic() < end, f"{lane} was never {status}"
        time.sleep(0.05)
    return dict(found)


def drawn(page: Page, lane: str) -> list[list[float | None]]:
    """Return the finite points of a lane's curve in the first panel."""
    found: list[list[float | None]] = page.evaluate(
        """lane => {
          const {data} = document.querySelector('#plots .plots-graph');
          const {x, y} = data.find(({name, mode}) => name === lane && mode === 'lines');
          return Array.from(x, (time, at) => [time, y[at]]).filter(([, y]) => Number.isFinite(y));
        }""",
        lane,
    )
    return found


def test_lanes_that_froze_say_when_and_one_alone_is_reset(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    expect(page.locator("#plots path.js-line").nth(8)).to_be_attached()
    simulate(dashboard, mode="sampled")
    stopped = {lane: until(dashboard, lane, "frozen")["time"] for lane in LANES}
    words = page.locator("#plots .textpoint text")
    for lane in LANES:
        expect(
            words.filter(has_text=f"frozen {float(f'{stopped[lane]:.3g}'):g} s").first
        ).to_be_visible()
    # Long after, the stop is still in sight; nothing is drawn of what was only held since.
    end = time.monotonic() + 60.0
    dashboard.client.patch("/api/session", json={"speed": 10}).raise_for_status()
    while state(dashboard)["time"] < stopped["NFTSM"] + 8.0:
        assert time.monotonic() < end
        page.wait_for_timeout(200)
    expect(words).to_have_count(3)
    dashboard.client.patch("/api/session", json={"speed": 1}).raise_for_status()
    simulate(dashboard, mode="continuous")
    row = page.locator(".lane[data-lane=NFTSM]")
    row.get_by_role("button", name="Reset lane").click()
    began = until(dashboard, "NFTSM", "running")["began"]
    assert began > stopped["NFTSM"] + 8.0
    assert state(dashboard)["lanes"]["RBFNN-SMC"]["status"] == "frozen"
    while not any(at >= began for at, _ in drawn(page, "NFTSM")):
        assert time.monotonic() < end, "the curve did not go on"
        page.wait_for_timeout(100)
    slack = 0.05  # Points of a thinned curve lie within its pieces.
    assert not [
        at for at, _ in drawn(page, "NFTSM") if stopped["NFTSM"] + slack < at < began - slack
    ]
    page.locator("[data-view=response]").click()
    simulate(dashboard, mode="sampled")
    expect(page.locator(".response .textpoint text").filter(has_text="frozen")).to_have_count(3)
    expect(page.locator(".response .xtick text").last).to_have_text("10")


def test_one_click_lets_a_sampled_experiment_work_and_one_undo_takes_it_back(
    page: Page, dashboard: Dashboard
) -> None:
    page.goto(dashboard.url)
    expect(page.locator(".gains-head h2")).to_be_visible()
    simulate(dashboard, mode="sampled")
    for lane in LANES:
        until(dashboard, lane, "frozen")
    before = dashboard.client.get("/api/experiment").json()["experiment"]
    offer = page.locator(".lanes").get_by_role("button", name="Use the sampled arm")
    expect(offer).to_have_attribute("title", re.compile("inertials = datasheet.*\nNFTSM: ", re.S))
    offer.click()
    for lane in LANES:
        until(dashboard, lane, "running")
    dashboard.client.patch("/api/session", json={"speed": 10}).raise_for_status()
    end = time.monotonic() + 60.0
    while (session := state(dashboard))["time"] < 3.0:
        assert time.monotonic() < end
        time.sleep(0.05)
    assert {lane["status"] for lane in session["lanes"].values()} == {"running"}
    expect(page.get_by_role("button", name="Use the sampled arm")).to_have_count(0)
    assert dashboard.client.get("/api/experiment").json()["experiment"]["robot"]["torque_limit"]
    page.keyboard.press("Control+z")
    end = time.monotonic() + 60.0
    while dashboard.client.get("/api/experiment").json()["experiment"] != before:
        assert time.monotonic() < end, "one undo did not bring everything back"
        time.sleep(0.05)


def test_stops_come_into_sight_when_the_last_lane_that_runs_is_removed(
    page: Page, dashboard: Dashboard
) -> None:
    page.goto(dashboard.url)
    expect(page.locator("#plots path.js-line").nth(8)).to_be_attached()
    simulate(dashboard, mode="sampled")
    for lane in LANES:
        until(dashboard, lane, "frozen")
    simulate(dashboard, mode="continuous")
    page.locator(".lane[data-lane=NFTSM]").get_by_role("button", name="Reset lane").click()
    until(dashboard, "NFTSM", "running")
    dashboard.client.patch("/api/session", json={"speed": 10}).raise_for_status()
    words = page.locator("#plots .textpoint text").filter(has_text="frozen")
    expect(words).to_have_count(0, timeout=60_000)
    dashboard.client.patch("/api/session", json={"speed": 1}).raise_for_status()
    dashboard.client.patch("/api/experiment", json={"lanes": {"NFTSM": None}}).raise_for_status()
    expect(words.nth(1)).to_be_visible()
