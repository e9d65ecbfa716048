"""The main job, as its user does it: look, tune, refuse, switch, export, import, come back."""

from __future__ import annotations

import io
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, Route, expect

from slidetune.robot.experiment.preset_yaml import experiment_from_yaml
from slidetune.robot.experiment.presets import load_preset
from tests.browser.conftest import Complaints, Dashboard, StartDashboard, stop


def open_page(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    expect(slider(page, "lanes.RBFNN-NFTSM.c")).to_be_visible()


def control(page: Page, path: str) -> Locator:
    return page.locator(f"[data-path='{path}']")


def slider(page: Page, path: str) -> Locator:
    return control(page, path).locator(".slider").first


def box(page: Page, path: str) -> Locator:
    return control(page, path).locator(".number-box").first


def experiment(dashboard: Dashboard) -> dict[str, Any]:
    document: dict[str, Any] = dashboard.client.get("/api/experiment").json()["experiment"]
    return document


def until_document(dashboard: Dashboard, wanted: dict[str, Any]) -> None:
    end = time.monotonic() + 60.0
    while experiment(dashboard) != wanted:
        assert time.monotonic() < end, "the experiment did not arrive"
        time.sleep(0.05)


def until_experiment(dashboard: Dashboard, lane: str, gain: str, value: float) -> None:
    end = time.monotonic() + 60.0
    while (now := experiment(dashboard)["lanes"][lane][gain]) != value:
        assert time.monotonic() < end, f"{lane}.{gain} stayed {now}"
        time.sleep(0.05)


def colours(page: Page, selector: str) -> int:
    """Return how many colours a screenshot of an element holds."""
    picture = Image.open(io.BytesIO(page.locator(selector).screenshot()))
    return len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0))


def curves(page: Page) -> str:
    """Return the paths of all curves on the screen."""
    found = page.locator("#plots .scatterlayer path.js-line").all()
    return "\n".join(curve.get_attribute("d") or "" for curve in found)


@pytest.mark.scene
def test_the_page_shows_lanes_plots_figures_and_the_arm(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)
    for lane in ("RBFNN-NFTSM", "RBFNN-SMC", "NFTSM"):
        expect(page.locator("#tune")).to_contain_text(lane)
        expect(page.locator("#metrics")).to_contain_text(lane)
    canvas = page.frame_locator("#scene iframe").locator("canvas").first
    expect(canvas).to_be_visible()
    end = time.monotonic() + 60.0
    while page.locator("#plots .scatterlayer path.js-line").count() < 9:
        assert time.monotonic() < end, "there are curves missing"
        page.wait_for_timeout(200)
    while colours(page, "#scene") < 500:
        assert time.monotonic() < end, "the 3D scene stayed blank"
        page.wait_for_timeout(500)
    mae = page.locator("#metrics tbody tr").first
    expect(mae).to_contain_text(re.compile(r"\d"))


def test_a_slider_move_changes_the_experiment_the_plots_and_the_revision(
    page: Page, dashboard: Dashboard
) -> None:
    open_page(page, dashboard)
    marker = page.locator("#header [data-revision]")
    before, revision = curves(page), marker.get_attribute("data-revision")
    # The remark on c/ν comes with the first figures and moves what is below it.
    expect(control(page, "lanes.RBFNN-NFTSM.nu")).to_contain_text("Try ν")
    track = slider(page, "lanes.RBFNN-NFTSM.c").bounding_box()
    assert track is not None
    middle = track["y"] + track["height"] / 2
    page.mouse.move(track["x"] + track["width"] * 0.7, middle)
    page.mouse.down()
    for share in (0.6, 0.5, 0.4, 0.3):
        page.mouse.move(track["x"] + track["width"] * share, middle)
        page.wait_for_timeout(50)
    page.mouse.up()
    expect(marker).not_to_have_attribute("data-revision", revision or "")
    value = experiment(dashboard)["lanes"]["RBFNN-NFTSM"]["c"]
    assert value < 3.0
    expect(box(page, "lanes.RBFNN-NFTSM.c")).to_have_value(re.compile(rf"^{value:.3g}"[:4]))
    end = time.monotonic() + 60.0
    while curves(page) == before:
        assert time.monotonic() < end, "the plots stood still"
        page.wait_for_timeout(100)
    page.keyboard.press("Control+z")
    until_experiment(dashboard, "RBFNN-NFTSM", "c", 10.0)
    page.keyboard.press("Control+Shift+z")
    until_experiment(dashboard, "RBFNN-NFTSM", "c", value)


def test_a_typed_value_is_taken_and_a_bad_one_refused_in_words(
    page: Page, dashboard: Dashboard
) -> None:
    open_page(page, dashboard)
    nu, typed = control(page, "lanes.RBFNN-NFTSM.nu"), box(page, "lanes.RBFNN-NFTSM.nu")
    typed.fill("30")
    typed.press("Enter")
    until_experiment(dashboard, "RBFNN-NFTSM", "nu", 30.0)
    typed.fill("-3")
    typed.press("Enter")
    expect(nu.get_by_role("alert").first).to_contain_text("0.01")
    expect(typed).to_have_value("30")
    assert experiment(dashboard)["lanes"]["RBFNN-NFTSM"]["nu"] == 30.0
    nu.locator(".control-dot").first.click()
    until_experiment(dashboard, "RBFNN-NFTSM", "nu", 0.3)


def test_a_disturbance_and_a_width_are_tuned_live(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)
    width = box(page, "lanes.RBFNN-NFTSM.width")
    width.fill("0.2")
    width.press("Enter")
    until_experiment(dashboard, "RBFNN-NFTSM", "width", 0.2)
    heading = page.locator("summary", has_text="Disturbance")
    section = page.locator("details", has=heading).last
    if section.get_attribute("open") is None:
        section.locator("summary").first.click()
    amplitude = box(page, "disturbance.sine.amplitude")
    amplitude.fill("20")
    amplitude.press("Enter")
    end = time.monotonic() + 60.0
    while experiment(dashboard)["disturbance"]["sine"]["amplitude"] != 20.0:
        assert time.monotonic() < end
        time.sleep(0.05)


def test_presets_are_switched_from_the_menu(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)
    page.locator(".preset-button").click()
    page.locator(".preset-load", has_text="chattering-sign").click()
    wanted = load_preset("chattering-sign")
    for lane in wanted.lanes:
        expect(page.locator("#tune")).to_contain_text(lane)
    until_document(dashboard, wanted.document())


def test_what_undoes_a_preset_brings_the_initial_state_back(
    page: Page, dashboard: Dashboard
) -> None:
    patch = {"simulation": {"initial_error": 0.1}}
    dashboard.client.patch("/api/experiment", json=patch).raise_for_status()
    page.goto(dashboard.url)
    page.locator(".preset-button").click()
    page.locator(".preset-load", has_text="A realistic arm").click()
    expect(page.locator(".preset-name")).to_have_text("realistic")
    page.keyboard.press("Control+z")
    expect(page.locator(".preset-name")).to_have_text("paper")

    def greatest() -> list[float]:
        lane = dashboard.client.get("/api/metrics").json()["lanes"].get("NFTSM", {})
        return (lane.get("total") or {"max_error": [0.0]})["max_error"]

    end = time.monotonic() + 60.0
    while not greatest()[0] > 0.099 and time.monotonic() < end:
        page.wait_for_timeout(50)
    assert greatest() == pytest.approx([0.1] * 6, abs=0.01)


def test_an_undo_waits_for_the_edit_that_is_on_its_way(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)
    before, held = experiment(dashboard), list[Route]()
    page.route("**/api/presets/realistic/load", lambda route: held.append(route))
    page.locator(".preset-button").click()
    page.locator(".preset-load", has_text="A realistic arm").click()
    end = time.monotonic() + 60.0
    while not held and time.monotonic() < end:
        page.wait_for_timeout(20)
    # Asked for before the server has even heard of it.
    page.keyboard.press("Control+z")
    with page.expect_response("**/api/presets/realistic/load"):
        held[0].continue_()
    until_document(dashboard, before)
    expect(page.locator(".preset-name")).to_have_text("paper")


def test_a_name_is_refused_by_the_rule_and_a_good_one_saved(
    page: Page, dashboard: Dashboard
) -> None:
    open_page(page, dashboard)
    page.get_by_role("button", name="Save", exact=True).click()
    dialog = page.locator("dialog[open]")
    fields = dashboard.client.get("/api/schema").json()["properties"]
    for text in ("title", "description"):
        most = str(fields[text]["maxLength"])
        expect(dialog.locator(f"[name={text}]")).to_have_attribute("maxlength", most)
    name, alert = dialog.locator("[name=name]"), dialog.locator(".dialog-alert")
    for wrong in ("my_gains", "../evil", "My gains"):
        name.fill(wrong)
        dialog.locator("[type=submit]").click()
        expect(alert).to_have_text(re.compile(rf"a-z, 0-9 and -, .* got {re.escape(wrong)}"))
    name.fill("my-gains")
    dialog.locator("[type=submit]").click()
    expect(page.locator(".preset-name")).to_have_text("my-gains")
    expect(page.locator(".preset-button")).not_to_have_class(re.compile("is-changed"))


def test_an_export_comes_back_by_import(page: Page, dashboard: Dashboard, tmp_path: Path) -> None:
    open_page(page, dashboard)
    nu = box(page, "lanes.RBFNN-NFTSM.nu")
    nu.fill("12.5")
    nu.press("Enter")
    until_experiment(dashboard, "RBFNN-NFTSM", "nu", 12.5)
    wanted = experiment(dashboard)
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as saved:
        page.get_by_role("menuitem", name="Experiment (YAML)").click()
    path = tmp_path / saved.value.suggested_filename
    saved.value.save_as(path)
    assert (path.suffix, experiment_from_yaml(path.read_bytes()).document()) == (".yaml", wanted)
    dashboard.client.post("/api/presets/realistic/load")
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Import").click()
    chooser.value.set_files(path)
    until_document(dashboard, wanted)
    # What offers to undo it goes when it would undo something else.
    undo = page.locator(".notice").get_by_role("button", name="Undo")
    undo.hover()  # It stays as long as somebody looks at it.
    nu.fill("11")
    nu.press("Enter")
    expect(undo).to_have_count(0)


def test_a_file_larger_than_the_server_takes_is_not_sent(
    page: Page, dashboard: Dashboard, tmp_path: Path
) -> None:
    open_page(page, dashboard)
    most = dashboard.client.get("/api/health").json()["limits"]["body_bytes"]
    large = tmp_path / "large.yaml"
    large.write_text("#" * (most + 1))
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Import").click()
    chooser.value.set_files(large)
    told = f"large.yaml was not imported: it is larger than {most // 1024} KiB."
    expect(page.locator(".notice")).to_contain_text(told)


def test_a_bad_import_is_refused_with_line_and_field(
    page: Page, dashboard: Dashboard, complaints: Complaints, tmp_path: Path
) -> None:
    complaints.allow("422")
    open_page(page, dashboard)
    before = experiment(dashboard)
    bad = tmp_path / "bad.yaml"
    bad.write_text("slidetune: 1\nlanes:\n  A:\n    law: nftsm\n    nu: -3\n")
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Import").click()
    chooser.value.set_files(bad)
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("line 5")
    expect(dialog).to_contain_text("nu must be in [0.01, 100] 1/s, got -3")
    assert experiment(dashboard) == before


def test_the_keyboard_plays_steps_resets_and_helps(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)

    def session() -> dict[str, Any]:
        state: dict[str, Any] = dashboard.client.get("/api/session").json()
        return state

    def until(key: str, value: object) -> None:
        end = time.monotonic() + 60.0
        while session()[key] != value:
            assert time.monotonic() < end, session()
            time.sleep(0.05)

    page.keyboard.press("Space")
    until("playing", False)
    page.keyboard.press("Backspace")
    until("time", 0.0)
    page.keyboard.press("ArrowRight")
    until("time", 0.001)
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_contain_text("Backspace")
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    box(page, "lanes.RBFNN-NFTSM.nu").focus()
    page.keyboard.type("0.5 ")
    until("playing", False)
    page.keyboard.press("Escape")
    page.locator("#header").click(position={"x": 700, "y": 20})
    page.keyboard.press("Space")
    until("playing", True)


def test_lanes_are_added_and_removed(page: Page, dashboard: Dashboard) -> None:
    open_page(page, dashboard)
    duplicated = {"lanes": {"NFTSM": None}}
    dashboard.client.patch("/api/experiment", json=duplicated).raise_for_status()
    expect(page.locator("#metrics tbody tr")).to_have_count(2)
    gains = {"lanes": {"PD": {"law": "computed_torque"}}}
    dashboard.client.patch("/api/experiment", json=gains).raise_for_status()
    expect(page.locator("#metrics tbody tr")).to_have_count(3)
    expect(page.locator("#tune")).to_contain_text("PD")


@pytest.mark.fresh
def test_the_page_comes_back_when_the_server_does(
    page: Page, start_dashboard: StartDashboard, complaints: Complaints
) -> None:
    complaints.allow("ERR_CONNECTION_REFUSED|WebSocket|ERR_|closed before|connection")
    first = start_dashboard()
    open_page(page, first)
    port = stop(first)
    expect(page.locator("#banner")).to_contain_text(re.compile("connection|lost|reconnect", re.I))
    second = start_dashboard("--port", port, "--preset", "realistic")
    assert second.url == first.url
    expect(page.locator("#banner")).to_be_hidden(timeout=60_000)
    expect(page.locator("#tune")).to_contain_text("Computed torque")


@pytest.mark.fresh
def test_a_frozen_page_comes_back_when_it_is_looked_at_again(
    page: Page, start_dashboard: StartDashboard, complaints: Complaints
) -> None:
    # What the browser itself says of a line that breaks.
    complaints.allow("ERR_CONNECTION_|WebSocket connection to|ERR_EMPTY_RESPONSE|ERR_NETWORK")
    first = start_dashboard()
    open_page(page, first)
    lifecycle = page.context.new_cdp_session(page)
    lifecycle.send("Page.setWebLifecycleState", {"state": "frozen"})
    port = stop(first)
    start_dashboard("--port", port, "--preset", "realistic")
    lifecycle.send("Page.setWebLifecycleState", {"state": "active"})
    expect(page.locator("#tune")).to_contain_text("Computed torque", timeout=60_000)
    expect(page.locator("#banner .banner")).to_be_hidden()
    expect(page.locator("#header")).to_contain_text("live")
    clock = page.locator("#header .status-time")
    expect(clock).not_to_have_text(clock.inner_text())


@pytest.mark.fresh
def test_a_hidden_page_tries_again_as_soon_as_it_is_seen(
    page: Page, start_dashboard: StartDashboard, complaints: Complaints
) -> None:
    complaints.allow("ERR_CONNECTION_|WebSocket connection to|ERR_EMPTY_RESPONSE|ERR_NETWORK")
    # A browser out of sight lets a timer of a second or more wait for long.
    page.add_init_script(
        """const wait = window.setTimeout;
        let hidden = false;
        Object.defineProperty(document, 'hidden', {get: () => hidden});
        window.setTimeout = (act, time) => wait(act, hidden && time > 300 ? 1e8 : time);
        window.hide = (now) => {
          hidden = now;
          document.dispatchEvent(new Event('visibilitychange'));
        };"""
    )
    first = start_dashboard()
    open_page(page, first)
    page.evaluate("hide(true)")
    port = stop(first)
    expect(page.locator("#banner")).to_contain_text("The connection to the server is lost.")
    start_dashboard("--port", port, "--preset", "realistic")
    expect(page.locator("#banner .banner")).to_be_visible()
    page.evaluate("hide(false)")
    expect(page.locator("#banner .banner")).to_be_hidden(timeout=60_000)
    expect(page.locator("#tune")).to_contain_text("Computed torque")


def test_dark_and_narrow_screens_show_the_same_parts(page: Page, dashboard: Dashboard) -> None:
    page.emulate_media(color_scheme="dark")
    page.set_viewport_size({"width": 390, "height": 844})
    page.goto(dashboard.url)
    for tab in page.locator("#tabs [role=tab]").all():
        tab.click()
        expect(tab).to_have_attribute("aria-selected", "true")
    width = page.evaluate("document.documentElement.scrollWidth")
    assert width <= 390
    background = page.evaluate("getComputedStyle(document.body).backgroundColor")
    red, green, blue = (int(part) for part in re.findall(r"\d+", background)[:3])
    assert max(red, green, blue) < 80
