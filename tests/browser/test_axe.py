"""axe-core looks at every view of the screen, in light and in dark, and finds nothing serious.

What a viewer sees is looked at in ``test_watch_only.py``, on the page that is open there anyway.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Complaints, Dashboard
from tests.browser.inspector import Inspector


@pytest.fixture
def inspector(page: Page, dashboard: Dashboard) -> Iterator[Inspector]:
    """An inspector that fails the test for what it has found at the end."""
    # Curves that stand still cost nothing, and are as legible.
    dashboard.client.post("/api/session/pause").raise_for_status()
    inspector = Inspector(page)
    yield inspector
    assert not inspector.found, "\n\n".join(inspector.found)


def tabs(page: Page, inspector: Inspector, view: str) -> None:
    """Look at every tab of a view of the right column."""
    for theme in inspector.themes():
        for tab in page.locator("#plots .right-view:visible").get_by_role("tab").all():
            tab.click()
            inspector.look_once(f"{view}, {tab.inner_text()}", "#plots", theme)


def opened(page: Page, dashboard: Dashboard, inspector: Inspector) -> None:
    """Open a preset whose lanes have something of everything, with runs of one second."""
    dashboard.client.post("/api/presets/realistic/load").raise_for_status()
    patch = {"simulation": {"horizon": 1.0}}
    dashboard.client.patch("/api/experiment", json=patch).raise_for_status()
    page.goto(dashboard.url)
    inspector.start()
    expect(page.locator(".lane")).to_have_count(4)


def test_every_control_and_every_live_plot(
    page: Page, dashboard: Dashboard, inspector: Inspector
) -> None:
    opened(page, dashboard, inspector)
    page.locator("#tune").evaluate(
        "part => part.querySelectorAll('details').forEach((one) => { one.open = true; })"
    )
    page.locator("#tune").evaluate(
        "part => part.querySelectorAll('.disclosure').forEach((one) => one.click())"
    )
    page.get_by_role("button", name="Which knob next?").click()
    expect(page.locator(".tornado-progress")).to_be_hidden(timeout=60_000)
    dashboard.client.post("/api/session/step", json={"count": 500}).raise_for_status()
    expect(page.locator("#plots .scatterlayer path.js-line").first).to_be_visible()
    inspector.look("everything open")
    tabs(page, inspector, "Live")


def test_every_response_and_every_lens(
    page: Page, dashboard: Dashboard, inspector: Inspector
) -> None:
    opened(page, dashboard, inspector)
    page.get_by_role("tab", name="Response", exact=True).click()
    expect(page.locator(".response-status")).to_have_attribute(
        "data-estimated", "true", timeout=60_000
    )
    tabs(page, inspector, "Response")
    page.get_by_role("tab", name="Lenses", exact=True).click()
    expect(page.locator(".lens-status")).to_contain_text("whole response", timeout=60_000)
    expect(page.locator(".lenses.is-busy")).to_have_count(0)
    tabs(page, inspector, "Lenses")


def test_every_kind_of_study(page: Page, dashboard: Dashboard, inspector: Inspector) -> None:
    dashboard.client.post("/api/presets/paper/load").raise_for_status()
    patch = {
        "simulation": {"horizon": 0.3},
        "goals": {"near": {"kind": "figure", "figure": "mae", "bound": 0.01, "priority": "hard"}},
        "uncertainty": {"payload": [0.0, 3.0]},
    }
    dashboard.client.patch("/api/experiment", json=patch).raise_for_status()
    axes = [{"field": "nu", "low": 1.0, "high": 9.0, "count": 2}]
    axes.append({"field": "mu", "low": 0.1, "high": 0.9, "count": 2})
    kinds = {
        "robustness": {"draws": 4},
        "worst": {"trials": 4},
        "sweep": {"axes": axes},
        "tune": {"trials": 4},
    }
    for kind, wanted in kinds.items():
        body = {"kind": kind, "wanted": {"lane": "NFTSM", **wanted}}
        dashboard.client.post("/api/studies", json=body).raise_for_status()
    page.goto(dashboard.url)
    inspector.start()
    page.get_by_role("tab", name="Studies", exact=True).click()
    back = page.get_by_role("button", name="All studies")
    state = page.locator(".study-head .study-state")
    expect(page.locator(".study-open:visible, .study-item:visible").first).to_be_visible()
    # One that is under way is opened by itself.
    if back.is_visible():
        back.click()
    for kind in ("Auto-tune", "Robustness", "Worst case", "Sweep"):
        page.locator(".study-kinds").get_by_text(kind, exact=True).click()
        inspector.look(f"new study, {kind}", "#plots")
    for place in range(len(kinds)):
        page.locator(".study-item").nth(place).click()
        expect(state).to_have_text("done", timeout=120_000)
        inspector.look(f"study {place}", "#plots")
        back.click()


def test_all_that_opens(
    page: Page, dashboard: Dashboard, inspector: Inspector, complaints: Complaints
) -> None:
    complaints.allow("422")
    page.goto(dashboard.url)
    inspector.start()
    expect(page.locator(".lane")).to_have_count(3)
    page.locator(".preset-button").click()
    inspector.look("presets", "[popover]:popover-open")
    page.keyboard.press("Escape")
    page.locator(".lane [aria-haspopup=menu]").first.click()
    inspector.look("menu of a lane", "[popover]:popover-open")
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Edits", exact=True).click()
    inspector.look("edits", "[popover]:popover-open")
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Save", exact=True).click()
    inspector.look("saving", "dialog[open]")
    page.get_by_role("button", name="Close").click()
    page.locator(".arm-button").click()
    inspector.look("arms", "dialog[open]")
    page.get_by_role("button", name="Close").click()
    page.keyboard.press("?")
    inspector.look("keys", "dialog[open]")
    page.get_by_role("button", name="Close").click()
    wrong = {"name": "wrong.yaml", "mimeType": "text/yaml", "buffer": b"lanes: 3"}
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Import", exact=True).click()
    chooser.value.set_files(wrong)  # type: ignore[arg-type]
    inspector.look("a refused import", "dialog[open]")
    page.get_by_role("button", name="Close").click()
    page.keyboard.press("l")
    expect(page.locator(".lesson-row").first).to_be_visible()
    inspector.look("lessons")
    page.locator("[data-lesson=chattering]").click()
    expect(page.locator(".lesson-title small")).to_contain_text("Step 1 of")
    expect(page.locator(".lesson[data-waiting]")).to_have_count(0)
    inspector.look("a lesson")


def test_a_phone_and_the_documentation(
    page: Page, dashboard: Dashboard, inspector: Inspector
) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(dashboard.url)
    inspector.start()
    expect(page.locator(".lane")).to_have_count(3)
    for tab in page.locator("#tabs").get_by_role("tab").all():
        tab.click()
        inspector.look(f"phone, {tab.inner_text()}")
    page.get_by_role("button", name="More", exact=True).click()
    inspector.look("phone, menu", "[popover]:popover-open")
    page.goto(f"{dashboard.url}docs/live")
    expect(page.locator(".message")).to_have_count(18)
    inspector.start()
    inspector.look("documentation of the WebSocket")
    page.goto(f"{dashboard.url}docs")
    expect(page.locator("#swagger-ui")).to_contain_text("/api/experiment")
    inspector.start()
    inspector.look("documentation of HTTP")
