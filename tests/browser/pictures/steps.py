"""What is done in the page before each picture, as the documentation tells it."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

from playwright.sync_api import Locator, Page, expect

from tests.browser.conftest import Dashboard

SECONDS = 14
"""For so long the live session runs before it is photographed, with the scene in software."""
LANE = "RBFNN-NFTSM"
GOALS = {
    "settled": {"kind": "response", "channel": "e", "start": 1, "bound": 0.003},
    "calm": {"kind": "figure", "figure": "peak_torque", "bound": 110, "priority": "hard"},
}
"""Those of the tutorial."""
UNCERTAINTY = {"payload": [0, 3], "inertia": [0.9, 1.1], "input_delay": [0, 0.002]}


class Step(NamedTuple):
    """One picture."""

    name: str
    scheme: Literal["light", "dark"]
    take: Callable[[Page, Dashboard], bytes]


def _load(dashboard: Dashboard, preset: str, *patches: dict[str, Any]) -> None:
    client = dashboard.client
    client.post(f"/api/presets/{preset}/load").raise_for_status()
    for patch in patches:
        client.patch("/api/experiment", json=patch).raise_for_status()
    client.post("/api/session/play").raise_for_status()


def _open(page: Page, dashboard: Dashboard, view: str) -> Locator:
    page.goto(dashboard.url)
    page.locator(f"[data-view={view}]").click()
    return page.locator("#plots")


def _responded(page: Page) -> None:
    expect(page.locator(".response-status")).to_have_attribute("data-estimated", "true")
    page.wait_for_timeout(1500)


def _dashboard(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "paper")
    page.goto(dashboard.url)
    page.wait_for_timeout(6_000)
    # Viser says that WebGL runs in software, which is true of this script alone.
    scene = page.frame_locator("#scene iframe")
    note = scene.locator("text=Software WebGL").locator("xpath=ancestor::*[@role='alert'][1]")
    if note.count():
        note.locator("button").first.click()
    dashboard.client.post("/api/session/reset", json={}).raise_for_status()
    page.wait_for_timeout(SECONDS * 1000)
    # A machine that is busy with something else is no part of the picture.
    expect(page.locator("#header")).not_to_contain_text("slower than")
    return page.screenshot()


def _response(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "paper")
    plots = _open(page, dashboard, "response")
    _responded(page)
    box = page.locator(f"[data-path='lanes.{LANE}.nu'] input[type=text]").first
    box.fill("30")
    box.press("Enter")
    _responded(page)
    return plots.screenshot()


def _strip(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "paper")
    _open(page, dashboard, "response")
    _responded(page)
    field = page.locator(f"[data-path='lanes.{LANE}.nu']").first
    field.get_by_role("slider", name="Error gain slider").hover()
    page.wait_for_timeout(6_000)
    return page.locator("#tune").screenshot()


def _prediction(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "chattering-sign", {"robot": {"lag": 0.004, "lag_order": "second"}})
    plots = _open(page, dashboard, "lenses")
    page.get_by_role("tab", name="Prediction").click()
    expect(page.locator(".lens-status")).to_contain_text("whole response")
    expect(page.locator(".lenses.is-busy")).to_have_count(0)
    page.wait_for_timeout(2_000)
    return plots.screenshot()


def _goals(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "realistic", {"goals": GOALS})
    plots = _open(page, dashboard, "response")
    _responded(page)
    return plots.screenshot()


def _study(dashboard: Dashboard, kind: str, **wanted: Any) -> int:
    body = {"kind": kind, "wanted": {"lane": "NFTSM", **wanted}}
    answer = dashboard.client.post("/api/studies", json=body).raise_for_status()
    number = int(answer.json()["id"])
    end = time.monotonic() + 600
    while time.monotonic() < end:
        found = dashboard.client.get(f"/api/studies/{number}").raise_for_status().json()
        if found["state"] not in ("waiting", "running"):
            return number
        time.sleep(0.5)
    raise TimeoutError(f"the study {number} does not end")


def _studied(page: Page, dashboard: Dashboard, number: int) -> Locator:
    plots = _open(page, dashboard, "studies")
    page.locator(f'.studies [data-study="{number}"] button').click()
    expect(page.locator(".study-head .study-state")).to_have_text("done")
    page.wait_for_timeout(3_000)
    return plots


def _search(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "realistic", {"goals": GOALS, "simulation": {"horizon": 5}})
    dashboard.client.post("/api/session/pause")
    gains = {
        "nu": {"low": 1, "high": 100},
        "k1": {"low": 8, "high": 800},
        "epsilon": {"low": 0.005, "high": 0.5},
    }
    number = _study(dashboard, "tune", gains=gains, trials=120, draws=0, seed=1)
    return _studied(page, dashboard, number).screenshot()


def _robustness(page: Page, dashboard: Dashboard) -> bytes:
    change = {"goals": GOALS, "uncertainty": UNCERTAINTY, "simulation": {"horizon": 5}}
    _load(dashboard, "realistic", change)
    dashboard.client.post("/api/session/pause")
    number = _study(dashboard, "robustness", draws=60)
    return _studied(page, dashboard, number).screenshot()


def _hand_over(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "realistic")
    _open(page, dashboard, "response")
    _responded(page)
    page.locator(".lane [aria-haspopup=menu]").nth(2).click()
    page.locator("[popover]:popover-open .menu-item", has_text="Hand over").click()
    dialog = page.get_by_role("dialog", name=re.compile("^Hand over"))
    expect(dialog).to_be_visible()
    page.wait_for_timeout(500)
    return dialog.screenshot()


def _lesson(page: Page, dashboard: Dashboard) -> bytes:
    _load(dashboard, "paper")
    page.goto(dashboard.url)
    page.locator("#plots").wait_for()
    page.keyboard.press("l")
    page.wait_for_timeout(2_000)
    return page.locator(".lessons, .lesson").first.screenshot()


STEPS = (
    Step("dashboard-light", "light", _dashboard),
    Step("dashboard-dark", "dark", _dashboard),
    Step("response", "light", _response),
    Step("strip", "light", _strip),
    Step("prediction", "light", _prediction),
    Step("goals", "light", _goals),
    Step("search", "light", _search),
    Step("robustness", "light", _robustness),
    Step("hand-over", "light", _hand_over),
    Step("lesson", "light", _lesson),
)
"""Every picture of the documentation, in the order in which the pages show them."""
