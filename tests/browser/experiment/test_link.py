"""Links in a real Chromium: made of what is there, opened elsewhere, refused without a loss."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from slidetune.robot.experiment.presets import link_to, load_preset
from tests.browser.conftest import Complaints, Dashboard
from tests.server.scene.viser_client import until

CHANGED = {"lanes": {"RBFNN-NFTSM": {"nu": 30, "k1": 200}, "NFTSM": {"mu": 0.7}}}


def live(dashboard: Dashboard) -> object:
    return dashboard.client.get("/api/experiment").json()["experiment"]


@pytest.fixture
def opened(dashboard: Dashboard, page: Page) -> Page:
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    return page


def test_a_link_brings_the_experiment_and_what_was_looked_at(
    opened: Page, dashboard: Dashboard
) -> None:
    page = opened
    dashboard.client.patch("/api/experiment", json=CHANGED).raise_for_status()
    experiment = live(dashboard)
    page.locator(".lane", has_text="RBFNN-SMC").locator(".lane-pick").click()
    page.locator("[data-view=response]").click()
    page.locator(".response").get_by_role("tab", name="Torque").click()
    page.get_by_role("button", name="Link", exact=True).click()
    box = page.get_by_role("textbox", name="Link")
    address = box.input_value()
    assert address.startswith(f"{dashboard.url.rstrip('/')}/#x=1.paper.")
    assert len(address) < 300
    expect(page.locator("dialog [role=status]")).to_contain_text(str(len(address)))
    page.keyboard.press("Escape")

    page.locator("[data-view=live]").click()
    dashboard.client.post("/api/presets/realistic/load").raise_for_status()
    expect(page.locator(".preset-name")).to_have_text("realistic")
    page.goto("about:blank")
    page.goto(address)
    expect(page.locator(".notice")).to_contain_text("Opened the experiment of the link.")
    assert live(dashboard) == experiment
    assert "#" not in page.url
    expect(page.locator(".preset-name")).to_have_text("paper")
    expect(page.locator(".preset-button.is-changed")).to_have_count(1)
    expect(page.locator("[data-view=response]")).to_have_attribute("aria-selected", "true")
    torque = page.locator(".response").get_by_role("tab", name="Torque")
    expect(torque).to_have_attribute("aria-selected", "true")
    expect(page.locator(".lane", has_text="RBFNN-SMC").locator("input")).to_be_checked()

    page.locator(".notice").get_by_role("button", name="Undo").click()
    expect(page.locator(".preset-name")).to_have_text("realistic")
    assert live(dashboard) == load_preset("realistic").document()
    page.reload()
    expect(page.locator("#header")).to_contain_text("live")
    assert live(dashboard) == load_preset("realistic").document()


def test_a_pasted_link_is_opened_and_a_damaged_one_refused(
    opened: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("422")
    page = opened
    wanted = load_preset("paper").patched(CHANGED)
    link = link_to(wanted)
    paste = """(text) => {
      const clipboardData = new DataTransfer();
      clipboardData.setData('text/plain', text);
      document.body.dispatchEvent(new ClipboardEvent('paste', {clipboardData, bubbles: true}));
    }"""
    before = live(dashboard)
    head, _, check = link.rpartition(".")
    page.evaluate(paste, f"{head}.{'00000000' if check != '00000000' else '11111111'}")
    expect(page.get_by_role("dialog", name="Not opened")).to_contain_text("was cut off or changed")
    page.keyboard.press("Escape")
    assert live(dashboard) == before
    page.evaluate(paste, f"http://localhost:9/#x={link}")
    until(lambda: live(dashboard) == wanted.document())
