"""The page of a viewer, beside the owner's, in a real Chromium."""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import LOGS, Dashboard, StartDashboard, running
from tests.browser.inspector import Inspector

WATCHED = re.compile(r"To watch only: (http://\S+)")
CHANGES = ("Save", "Import", "Undo", "Redo", "Learn")


def viewers_address(dashboard: Dashboard) -> str:
    found = WATCHED.search(dashboard.log.read_text(encoding="utf-8"))
    assert found is not None
    return found[1]


def owner(dashboard: Dashboard) -> httpx.Client:
    """Return a client that speaks as the owner, whose address ends in the token."""
    address = httpx.URL(dashboard.url)
    bearer = {"authorization": f"Bearer {address.params['token']}"}
    return httpx.Client(base_url=address.join("/"), headers=bearer, trust_env=False, timeout=30)


@pytest.fixture(scope="module")
def shared_guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Dashboard]:
    """A dashboard that asks for a token; `guarded` puts it back to its beginning."""
    with running(("--token",), tmp_path_factory.mktemp("guarded") / "dashboard.txt") as dashboard:
        yield dashboard


@pytest.fixture
def guarded(shared_guarded: Dashboard, request: pytest.FixtureRequest) -> Dashboard:
    """A dashboard that asks for a token, with the paper's experiment."""
    request.node.stash.setdefault(LOGS, []).append(shared_guarded.log)
    with owner(shared_guarded) as hand:
        hand.post("/api/presets/paper/load").raise_for_status()
    return shared_guarded


def open_as_viewer(page: Page, dashboard: Dashboard) -> list[str]:
    """Open the viewers' address; return what the page sends from then on that isn't a GET."""
    asked: list[str] = []
    page.on("request", lambda r: asked.append(r.url) if r.method != "GET" else None)
    page.on("websocket", lambda s: s.on("framesent", lambda frame: asked.append(str(frame))))
    page.goto(viewers_address(dashboard))
    expect(page.locator("#header")).to_contain_text("Watching")
    expect(page.locator("[data-path='lanes.RBFNN-NFTSM.c'] .slider").first).to_be_visible()
    return asked


def test_a_viewer_sees_it_live_and_can_move_nothing(page: Page, guarded: Dashboard) -> None:
    asked = open_as_viewer(page, guarded)
    assert "token" not in page.url
    expect(page.locator("#header")).to_contain_text("live")
    expect(page.locator("#plots .scatterlayer path.js-line").first).to_be_visible()
    for selector in (".gains input", ".sections input", "#transport button", ".scene-bar input"):
        controls = page.locator(selector)
        assert controls.count() > 0
        assert controls.evaluate_all("all => all.every((one) => one.disabled)"), selector
    for name in CHANGES:
        expect(page.locator("#header").get_by_role("button", name=name, exact=True)).to_be_hidden()
    expect(page.locator(".lane-add")).to_be_hidden()
    expect(page.locator(".preset-button")).to_be_disabled()
    page.get_by_role("button", name="Export").click()
    expect(page.get_by_role("menuitem", name="Report (HTML)")).to_be_disabled()
    expect(page.get_by_role("menuitem", name="Experiment (YAML)")).to_be_enabled()
    page.keyboard.press("Escape")
    inspector = Inspector(page)
    inspector.start()
    inspector.look("watching")
    assert not inspector.found, "\n\n".join(inspector.found)
    assert asked == []


def test_a_viewers_keys_and_pastes_change_nothing(page: Page, guarded: Dashboard) -> None:
    asked = open_as_viewer(page, guarded)
    with owner(guarded) as hand:
        before = hand.get("/api/session").json()
    for key in ("Space", "ArrowRight", "Backspace", "k", "l", "Control+z", "Control+y"):
        page.keyboard.press(key)
    expect(page.locator(".lesson-row")).to_have_count(0)
    page.keyboard.press("?")
    expect(page.locator("dialog[open]")).to_contain_text("Keys")
    page.keyboard.press("Escape")
    expect(page.locator("dialog[open]")).to_have_count(0)
    page.evaluate(
        "text => { const data = new DataTransfer(); data.setData('text/plain', text);"
        "document.body.dispatchEvent("
        "new ClipboardEvent('paste', {clipboardData: data, bubbles: true})); }",
        "lanes:\n  A:\n    law: nftsm\n",
    )
    expect(page.locator("dialog[open]")).to_contain_text("You are watching")
    with owner(guarded) as hand:
        after = hand.get("/api/session").json()
    assert asked == []
    assert [after[key] for key in ("playing", "epoch", "revision")] == [
        before[key] for key in ("playing", "epoch", "revision")
    ]


def test_a_viewer_follows_the_owner_and_looks_at_another_lane(
    page: Page, guarded: Dashboard
) -> None:
    asked = open_as_viewer(page, guarded)
    box = page.locator("[data-path='lanes.RBFNN-NFTSM.c'] .number-box").first
    change = {"lanes": {"RBFNN-NFTSM": {"c": 12.5}}}
    hand = owner(guarded)
    hand.patch("/api/experiment", json=change).raise_for_status()
    expect(box).to_have_value("12.5")
    page.locator(".lane[data-lane='NFTSM'] .lane-pick").click()
    nu = page.locator("[data-path='lanes.NFTSM.nu'] .number-box").first
    expect(nu).to_be_visible()
    expect(nu).to_be_disabled()
    added = {"lanes": {"Fifth": {"law": "smc"}}}
    hand.patch("/api/experiment", json=added).raise_for_status()
    hand.close()
    expect(page.locator(".lane[data-lane='Fifth']")).to_be_visible()
    expect(nu).to_be_disabled()
    assert asked == []


def test_a_viewer_sees_the_owners_last_response_and_looks(
    page: Page, start_dashboard: StartDashboard
) -> None:
    dashboard = start_dashboard("--token")
    asked = open_as_viewer(page, dashboard)
    hand = owner(dashboard)
    hand.timeout = httpx.Timeout(120.0)
    short = {"simulation": {"horizon": 1.0}}
    hand.patch("/api/experiment", json=short).raise_for_status()

    page.get_by_role("tab", name="Response").click()
    response = page.locator(".response")
    expect(response).to_contain_text("No response yet")
    hand.post("/api/preview", json={}).raise_for_status()
    expect(response.locator(".scatterlayer path.js-line").first).to_be_visible()
    status = response.locator(".response-status")
    expect(status).to_have_text("the owner’s last response, rev 2")
    expect(response.locator(".response-pin")).to_be_hidden()
    expect(response.locator(".response-switches")).to_be_hidden()

    page.get_by_role("tab", name="Lenses").click()
    lenses = page.locator(".lenses")
    expect(lenses).to_contain_text("The owner has not opened this lens for RBFNN-NFTSM yet")
    look = {"lane": "RBFNN-NFTSM", "lenses": ["sliding", "chattering"]}
    hand.post("/api/lens", json=look).raise_for_status()
    seen = lenses.locator(".lens-status")
    expect(seen).to_have_text("the owner’s last look, rev 2")
    expect(lenses.locator(".js-line").first).to_be_visible()

    hand.patch("/api/experiment", json={"lanes": {"RBFNN-NFTSM": {"nu": 3}}}).raise_for_status()
    expect(seen).to_have_text(
        "the owner’s last look, rev 2; out of date, the experiment is at rev 3"
    )
    lenses.get_by_role("tab", name="Chattering").click()
    expect(lenses).to_contain_text("total variation")
    expect(lenses).to_contain_text("Only the owner’s page can start runs")
    expect(lenses.get_by_role("button", name="Compare the three")).to_be_hidden()
    hand.post("/api/lens", json=look).raise_for_status()
    expect(seen).to_have_text("the owner’s last look, rev 3")
    page.get_by_role("tab", name="Response").click()
    expect(status).to_contain_text("rev 2; out of date, the experiment is at rev 3")
    # Behind it stands what was before the last change where that is known, and nothing else.
    faint = response.locator(".trace[class*=tracebefore] path.js-line")
    for revision, gain, known in ((4, "c", 0), (5, "mu", 3)):
        change = {"lanes": {"RBFNN-NFTSM": {gain: 5}}}
        hand.patch("/api/experiment", json=change).raise_for_status()
        hand.post("/api/preview", json={}).raise_for_status()
        expect(status).to_have_text(f"the owner’s last response, rev {revision}")
        expect(faint).to_have_count(known)
    hand.close()
    assert asked == []


@pytest.mark.scene
def test_the_scene_of_a_viewer_is_drawn(page: Page, guarded: Dashboard) -> None:
    with page.expect_console_message(lambda message: message.text.startswith("Connected!")):
        open_as_viewer(page, guarded)
    expect(page.frame_locator(".scene-frame").locator("canvas").first).to_be_visible()


def test_on_a_phone_a_viewer_begins_with_the_plots(page: Page, guarded: Dashboard) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    asked: list[str] = []
    page.on("request", lambda r: asked.append(r.url) if r.method != "GET" else None)
    page.goto(viewers_address(guarded))
    expect(page.locator("#plots .scatterlayer path.js-line").first).to_be_visible()
    expect(page.locator("[data-path='lanes.RBFNN-NFTSM.c']").first).to_be_hidden()
    page.get_by_role("tab", name="Metrics").click()
    expect(page.locator("#metrics table").first).to_be_visible()
    # Nor does it ask for runs to be seen above the controls.
    page.get_by_role("tab", name="Tune").click()
    expect(page.locator("[data-path='lanes.RBFNN-NFTSM.c']").first).to_be_visible()
    expect(page.locator(".strip")).to_be_hidden()
    assert asked == []
