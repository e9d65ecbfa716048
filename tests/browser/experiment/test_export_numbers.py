"""Numbers of the live session and of a whole run, taken away from the page."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from playwright.sync_api import Locator, Page, expect

from slidetune.robot.experiment.presets import load_preset
from slidetune.robot.loop.simulate import simulate
from slidetune.robot.recordings.mcap_file import McapFile
from tests.browser.conftest import Dashboard

SHORT = {"simulation": {"horizon": 0.3}}


def opened(page: Page) -> Locator:
    page.get_by_role("button", name="Export", exact=True).click()
    page.locator("[popover]:popover-open .menu-item", has_text="Numbers (").click()
    return page.get_by_role("dialog", name="Export numbers")


def downloaded(page: Page, dialog: Locator, path: Path) -> str:
    with page.expect_download(timeout=120_000) as saved:
        dialog.get_by_role("button", name="Download").click()
    expect(dialog).to_have_count(0)
    saved.value.save_as(path)
    return saved.value.suggested_filename


def test_what_is_seen_and_what_is_run_come_as_files(
    page: Page, dashboard: Dashboard, tmp_path: Path
) -> None:
    dashboard.client.patch("/api/experiment", json=SHORT).raise_for_status()
    dashboard.client.post("/api/session/step", json={"count": 200}).raise_for_status()
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("paused")
    dialog = opened(page)
    expect(dialog.get_by_label("What")).to_be_focused()
    seconds = dialog.get_by_label("Seconds")
    seconds.fill("61")
    dialog.get_by_role("button", name="Download").click()
    expect(dialog.get_by_role("alert")).to_have_text(
        "Seconds must be a number above 0, up to 60; got 61."
    )
    seconds.fill("0.05")
    name = downloaded(page, dialog, tmp_path / "window.csv")
    assert name.endswith("-window.csv")
    table = pd.read_csv(tmp_path / "window.csv")
    assert len(table) == 51
    dialog = opened(page)
    dialog.get_by_label("Seconds").fill("")
    dialog.get_by_label("What").select_option("run")
    expect(dialog.get_by_label("Seconds")).to_be_hidden()
    dialog.get_by_label("Format").select_option("parquet")
    downloaded(page, dialog, tmp_path / "run.parquet")
    run = simulate(load_preset("paper").patched(SHORT), estimate=False)
    table = pd.read_parquet(tmp_path / "run.parquet")
    assert (table["NFTSM/tau3 [N·m]"].to_numpy() == run.lanes["NFTSM"].tau[:, 2]).all()
    dialog = opened(page)
    dialog.get_by_label("Format").select_option("mcap")
    downloaded(page, dialog, tmp_path / "window.mcap")
    assert len(McapFile(tmp_path / "window.mcap", "/nftsm/joint_states").names) == 19


def test_who_cancels_gets_no_file(page: Page, dashboard: Dashboard) -> None:
    page.goto(dashboard.url)
    expect(page.locator("#header")).to_contain_text("live")
    saved: list[str] = []
    page.on("download", lambda download: saved.append(download.suggested_filename))
    page.route("**/api/exports/window", lambda route: None)  # an answer that never comes
    dialog = opened(page)
    dialog.get_by_role("button", name="Download").click()
    expect(dialog.get_by_role("button", name="Being written …")).to_be_visible()
    dialog.get_by_label("Seconds").fill("5")
    expect(dialog.get_by_role("button", name="Being written …")).to_be_visible()
    with page.expect_event("requestfailed") as failed:
        dialog.get_by_role("button", name="Cancel").click()
    assert failed.value.url.endswith("/api/exports/window")
    assert failed.value.failure == "net::ERR_ABORTED"
    expect(dialog).to_have_count(0)
    assert not saved
