"""Another arm in a real Chromium: chosen, brought, drawn, tuned, left again."""

from __future__ import annotations

import base64
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from slidetune.robot.arm.teaching import TWO_LINKS
from slidetune.robot.experiment.preset_yaml import experiment_to_yaml
from slidetune.robot.experiment.presets import load_preset
from slidetune.server.compute.arm_kernels import load_kernels
from tests.browser.conftest import Complaints, Dashboard
from tests.server.scene.viser_client import until

DROP = """([name, text]) => {
  const transfer = new DataTransfer();
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  transfer.items.add(new File([bytes], name));
  const drop = (type) => document.querySelector('.drop-veil, body').dispatchEvent(
    new DragEvent(type, {dataTransfer: transfer, bubbles: true, cancelable: true}));
  drop('dragenter');
  drop('drop');
}"""


@pytest.fixture(scope="module", autouse=True)
def compiled() -> None:
    """Have the kernels compiled before a page waits for them."""
    load_kernels("pendulum")
    load_kernels("two_links")


@pytest.fixture
def opened(dashboard: Dashboard, page: Page) -> Page:
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    return page


def drop(page: Page, name: str, content: bytes) -> None:
    page.evaluate(DROP, [name, base64.b64encode(content).decode()])


def live(dashboard: Dashboard) -> dict[str, Any]:
    experiment: dict[str, Any] = dashboard.client.get("/api/experiment").json()["experiment"]
    return experiment


def choose(page: Page, title: str) -> None:
    page.locator(".arm-button").click()
    page.locator("dialog .arm-choice", has_text=title).click()
    expect(page.locator(".arm-name")).to_have_text(title)
    expect(page.locator("#header")).to_contain_text("live")


def test_everything_follows_the_joints_of_the_arm(opened: Page, dashboard: Dashboard) -> None:
    page = opened
    choose(page, "Two links")
    assert live(dashboard)["robot"]["model"] == "two_links"
    expect(page.locator("#plots .plots-joints").first.locator("button")).to_have_count(2)
    expect(page.locator("#metrics thead")).to_contain_text("MAE J2")
    expect(page.locator("#metrics thead")).not_to_contain_text("MAE J3")
    gains = page.locator(".gains")
    gains.get_by_role("button", name="Proportional reaching gain: each joint").click()
    rows = gains.locator(".joint-list:not([hidden]) .joint-row")
    expect(rows.filter(visible=True)).to_have_count(2)
    box = rows.filter(visible=True).nth(1).locator(".number-box")
    box.fill("4")
    box.press("Enter")
    until(lambda: live(dashboard)["lanes"]["RBFNN-NFTSM"]["k1"][1] == 4)
    page.locator("[data-view=response]").click()
    expect(page.locator(".response-table tbody tr")).to_have_count(3)
    expect(page.locator(".response-table thead")).not_to_contain_text("MAE J3")


def test_the_way_back_brings_the_former_experiment_with_its_preset(
    opened: Page, dashboard: Dashboard
) -> None:
    page, before = opened, live(dashboard)
    page.locator(".arm-button").click()
    page.locator("dialog .arm-choice", has_text="Pendulum").click()
    page.get_by_role("button", name="Back to JAKA Zu 5").click()
    expect(page.locator(".arm-name")).to_have_text("JAKA Zu 5")
    expect(page.locator(".preset-name")).to_have_text("paper")
    assert live(dashboard) == before


def test_an_import_for_another_arm_offers_the_way_back(opened: Page, dashboard: Dashboard) -> None:
    page = opened
    dashboard.client.patch("/api/experiment", json={"lanes": {"NFTSM": {"nu": 31}}})
    expect(page.locator(".preset-button.is-changed")).to_have_count(1)
    before = live(dashboard)
    drop(page, "mine.yaml", experiment_to_yaml(load_preset("two-links")).encode())
    expect(page.locator(".arm-name")).to_have_text("Two links")
    page.get_by_role("button", name="Back to JAKA Zu 5").click()
    expect(page.locator(".arm-name")).to_have_text("JAKA Zu 5")
    until(lambda: live(dashboard) == before)


def test_a_new_lane_has_gains_of_the_size_of_the_arm(opened: Page, dashboard: Dashboard) -> None:
    page = opened
    choose(page, "Two links")
    page.get_by_role("button", name="Add lane").click()
    page.get_by_role("menuitem", name="Super-twisting").click()
    expect(page.locator(".lane", has_text="Super-twisting")).to_be_visible()
    wanted = dashboard.client.get("/api/arms/lane?law=super_twisting").json()["lane"]
    lane = live(dashboard)["lanes"]["Super-twisting"]
    assert {key: lane[key] for key in wanted} == wanted
    assert len(wanted["k1"]) == 2


def test_a_study_of_another_arm_is_said_to_be_one(opened: Page, dashboard: Dashboard) -> None:
    page = opened
    goal = {"kind": "figure", "figure": "mae", "bound": 0.01}
    dashboard.client.patch("/api/experiment", json={"goals": {"close": goal}}).raise_for_status()
    wanted = {"lane": "NFTSM", "trials": 2}
    study = dashboard.client.post("/api/studies", json={"kind": "tune", "wanted": wanted}).json()
    address = f"/api/studies/{study['id']}"
    until(lambda: dashboard.client.get(address).json()["state"] == "done")
    choose(page, "Two links")
    page.locator("[data-view=studies]").click()
    page.locator(".study-list button").first.click()
    said = page.locator(".study-other")
    expect(said).to_contain_text("It is of another arm, jaka_zu5")
    expect(page.get_by_role("button", name="Use these gains")).to_be_hidden()
    said.get_by_role("button", name="Load its experiment").click()
    expect(page.locator(".arm-name")).to_have_text("JAKA Zu 5")
    expect(page.get_by_role("button", name="Use these gains")).to_be_visible()
    expect(page.locator(".study-other")).to_be_hidden()


def test_an_arm_that_is_dropped_is_examined_kept_and_begun_with(
    opened: Page, dashboard: Dashboard
) -> None:
    page = opened
    text = TWO_LINKS.read_bytes().replace(b'name="two_links"', b'name="mine"')
    drop(page, "mine.urdf", text.replace(b'value="1.5"', b'value="1.6"'))
    report = page.get_by_role("dialog", name="mine can be used")
    expect(report).to_contain_text("Joints: shoulder, elbow")
    report.get_by_role("button", name="Begin with this arm").click()
    expect(page.locator(".arm-name")).to_have_text("mine")
    assert live(dashboard)["robot"]["model"].startswith("mine-")
    expect(page.locator("#plots .plots-joints").first.locator("button")).to_have_count(2)
    page.locator(".arm-button").click()
    expect(page.locator("dialog .arm-choice[aria-current]")).to_contain_text("mine")


def test_a_joint_that_slides_has_its_units_in_every_lens(
    opened: Page, dashboard: Dashboard
) -> None:
    page = opened
    turning = b'<joint name="elbow" type="revolute">'
    assert turning in TWO_LINKS.read_bytes()
    text = TWO_LINKS.read_bytes().replace(turning, b'<joint name="elbow" type="prismatic">')
    drop(page, "sliding.urdf", text)
    page.get_by_role("button", name="Begin with this arm").click()
    expect(page.locator("#header")).to_contain_text("first experiment")
    page.locator("[data-view=lenses]").click()
    lenses = page.locator(".lenses")
    for joint, angle, torque in ((1, "rad", "N·m"), (2, "m", "N")):
        lenses.get_by_role("button", name=f"Joint {joint}", exact=True).click()
        for lens, units in (
            ("Sliding mode", (f"e [{angle}]", f"de [{angle}/s]")),
            ("Network", (f"W [{torque}]", f"torque [{torque}]")),
            ("Chattering", (f"{torque}/√Hz",)),
            ("Prediction", (f"Re [{angle}/s]",)),
        ):
            lenses.get_by_role("tab", name=lens).click()
            for unit in units:
                title = lenses.locator(".g-xtitle, .g-ytitle, .g-y2title").filter(visible=True)
                expect(title.get_by_text(unit, exact=True)).to_be_visible()


def test_what_the_doctor_refuses_is_told_with_its_lines_and_changes_nothing(
    opened: Page, dashboard: Dashboard, complaints: Complaints
) -> None:
    complaints.allow("422")
    page, before = opened, live(dashboard)
    drop(page, "bad.urdf", TWO_LINKS.read_bytes().replace(b'value="1.5"', b'value="-1.5"'))
    report = page.get_by_role("dialog", name="two_links is refused")
    expect(report.locator("[data-kind=refused] li").first).to_contain_text("link upper_rod, line")
    expect(report.get_by_role("button", name="Begin with this arm")).to_have_count(0)
    page.keyboard.press("Escape")
    drop(page, "notes.zip", b"no archive")
    expect(page.locator(".notice.is-error")).to_contain_text("no ZIP that can be read")
    assert live(dashboard) == before
    assert len(dashboard.client.get("/api/arms").json()["arms"]) == 3


@pytest.mark.parametrize("width", [1440, 390])
def test_whoever_watches_comes_along_to_another_arm(
    opened: Page, dashboard: Dashboard, width: int
) -> None:
    page = opened
    page.set_viewport_size({"width": width, "height": 844})
    dashboard.client.post("/api/arms/pendulum/begin").raise_for_status()
    expect(page.locator(".arm-name")).to_have_text("Pendulum")
    expect(page.locator("#header")).to_contain_text("live")


def test_an_arm_of_one_joint_has_one_slider_a_gain(opened: Page, dashboard: Dashboard) -> None:
    page = opened
    dashboard.client.post("/api/presets/pendulum/load").raise_for_status()
    expect(page.locator(".arm-name")).to_have_text("Pendulum")
    page.locator("details[data-group=trajectory] summary").first.click()
    pose = page.get_by_role("spinbutton", name="Pose")
    expect(pose).to_have_value("0.8")
    pose.fill("0.9")
    pose.press("Enter")
    expect(page.locator("#header")).to_contain_text("rev")
    until(lambda: live(dashboard)["trajectory"]["position"] == [0.9])
    expect(page.get_by_role("button", name="Set all equal").filter(visible=True)).to_have_count(0)
    expect(page.get_by_role("button", name="each joint").filter(visible=True)).to_have_count(0)
