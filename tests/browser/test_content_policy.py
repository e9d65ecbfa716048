"""The page keeps to its own content policy, whatever of it is opened."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Complaints, Dashboard

# Runs in every frame before its own scripts. The violations of a frame of our origin are handed
# to the page, because a frame may be loaded anew.
LISTEN = """
top.violations ??= [];
addEventListener('securitypolicyviolation', (event) => top.violations.push(
  `${event.violatedDirective} ${event.blockedURI} in ${location.pathname}`));
"""
# Every tab of the view that is shown, long enough for each to be drawn.
OPEN_ALL = """async () => {
  for (const tab of document.querySelectorAll('#plots .right-view:not([hidden]) [role=tab]')) {
    tab.click();
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  }
}"""


def violations(page: Page) -> list[str]:
    found: list[str] = page.evaluate("top.violations")
    return found


@pytest.mark.scene
def test_the_scene_keeps_to_the_content_policy(page: Page, dashboard: Dashboard) -> None:
    page.add_init_script(LISTEN)
    with page.expect_console_message(lambda message: message.text.startswith("Connected!")):
        page.goto(dashboard.url)
    expect(page.frame_locator(".scene-frame").locator("canvas").first).to_be_visible()
    assert violations(page) == []


@pytest.mark.fresh
def test_nothing_on_the_page_breaks_the_content_policy(page: Page, dashboard: Dashboard) -> None:
    page.add_init_script(LISTEN)
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    expect(page.locator("#plots .scatterlayer path.js-line").first).to_be_visible()
    for view in ("Response", "Lenses", "Live"):
        page.get_by_role("tab", name=view, exact=True).click()
        drawn = (
            page.locator("#plots .right-view:visible")
            .locator("svg, canvas")
            .locator("visible=true")
        )
        expect(drawn.first).to_be_visible()
        page.evaluate(OPEN_ALL)
        if view != "Lenses":  # the last of these has words alone for a loop that does not swing
            expect(drawn.first).to_be_visible()
    page.get_by_role("button", name="Export").click()
    with page.expect_download():
        page.get_by_role("menuitem", name="Experiment (YAML)").click()
    page.keyboard.press("?")
    expect(page.locator("dialog[open]")).to_contain_text("Keys")
    page.keyboard.press("Escape")
    page.keyboard.press("l")
    expect(page.locator(".lesson-row").first).to_be_visible()
    assert violations(page) == []


@pytest.mark.fresh
def test_the_documentation_pages_keep_to_it_too(page: Page, dashboard: Dashboard) -> None:
    page.add_init_script(LISTEN)
    page.goto(f"{dashboard.url}docs")
    expect(page.locator("#swagger-ui")).to_contain_text("/api/experiment")
    page.get_by_role("link", name="Live WebSocket").click()
    messages = page.locator(".message h3")
    expect(messages).to_have_count(18)
    assert {"patch", "kick", "hello", "telemetry, binary"} <= set(messages.all_inner_texts())
    expect(page.locator("#script")).to_contain_text(dashboard.url.replace("http", "ws", 1))
    assert violations(page) == []


@pytest.mark.fresh
def test_a_violation_would_be_noticed(
    page: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("Content Security Policy")
    page.add_init_script(LISTEN)
    page.goto(dashboard.url)
    page.evaluate(
        "() => new Promise((done) => {"
        "addEventListener('securitypolicyviolation', done);"
        "const script = document.createElement('script'); script.textContent = 'top.ran = 1';"
        "document.head.append(script); })"
    )
    assert "script-src-elem inline" in violations(page)[0]
    assert page.evaluate("top.ran") is None
